// exr_bytes.h: OpenEXR files of whole lines as bytes, as painting files are ("OpenEXR File Layout", 2013):
// OpenEXR's own library is of no use where there are no files.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surface/painting_file/painting_parts.h"

namespace tangi {

struct ExrAttribute {
    std::string type, bytes;  // numbers: the lowest byte first
};

struct ExrPart {
    std::map<std::string, ExrAttribute> attributes;  // by name
    std::vector<std::uint64_t> places;               // of its blocks, from the file's beginning

    // `missing` where there is no such attribute, or a shorter one.
    template <class T>
    T get(const std::string& name, T missing) const {
        const auto found = attributes.find(name);
        if (found == attributes.end() || found->second.bytes.size() < sizeof(T)) return missing;
        T value;
        std::memcpy(&value, found->second.bytes.data(), sizeof value);
        return value;
    }
    std::string text(const std::string& name) const {
        const auto found = attributes.find(name);
        return found == attributes.end() ? std::string() : found->second.bytes;
    }
};

// Lines of a part as the file has them, packed.
struct ExrBlock {
    std::int32_t y = 0;  // the first of them
    std::string bytes;
};

// A file's bytes, wherever they are: a large file need never be in memory as a whole.
struct ByteSource {
    std::uint64_t size = 0;
    std::function<void(std::uint64_t at, std::span<char> to)> read;  // of what lies within `size`
};
ByteSource bytes_in(std::string_view memory);  // which must outlive it

// Throws Error where it is no such file, is cut short, or its sizes cannot be right.
class ExrFile {
public:
    explicit ExrFile(ByteSource bytes);

    const std::vector<ExrPart>& parts() const { return parts_; }
    const ExrPart* part(const std::string& name) const;  // null where there is none

    // As painting_parts() tells it. Throws Error where it is not as TangiPaint writes it: floats of 32 or 16
    // bits, without compression or with ZIP, every line and column.
    static PartInfo info(const ExrPart& part);
    ExrBlock block(const ExrPart& part, std::size_t number) const;
    // As read_painting_part(), of channels of 32 bits.
    using TakeRows = std::function<void(int y0, int y1, std::span<const float* const> planes)>;
    void read(const ExrPart& part, const TakeRows& take) const;

private:
    ByteSource bytes_;
    bool several_ = false;
    std::vector<ExrPart> parts_;
};

// A part of a file to be written: from floats, or the blocks of a file that is there.
struct ExrSource {
    ExrPart header;  // without what write_head() knows: channels, windows, compression, count of blocks
    PartToWrite rows;
    const ExrFile* from = nullptr;  // then `header` is that of a part of this one, with its places
};

constexpr int kExrRowsOfBlock = 16;  // of ZIP

// All before the table of the blocks' places: what follows are one number of 64 bits for each block, in the
// order of parts, and the blocks, each with its part's number, its first line and its length of 32 bits each.
std::string exr_head(const std::vector<ExrSource>& parts);
std::size_t block_count(const ExrSource& part);
// The values of a block; `sorted`: as ZIP packs them.
std::string exr_block(const ExrSource& part, std::size_t number, bool sorted);

ExrAttribute exr_text(const std::string& text);
ExrAttribute exr_number(float value);
ExrAttribute exr_number(double value);
ExrAttribute exr_number(std::int32_t value);

}  // namespace tangi
