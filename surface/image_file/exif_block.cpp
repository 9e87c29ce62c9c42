#include "surface/image_file/exif_block.h"

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "surface/file/file_bytes.h"

namespace tangi {

namespace {

constexpr std::uint64_t kExifPointer = 0x8769, kPlacesPointer = 0x8825, kExchangePointer = 0xA005,
                        kMakerNote = 0x927C;
constexpr std::uint64_t kExifEntryBytes = 12;
// [bytes] JPEG files hold 64 KiB at most; OpenImageIO puts arrays of fractions on the stack.
constexpr std::size_t kLongestBlock = 1u << 20;
constexpr std::uint64_t kLongestValue =
    4096;  // [bytes] kept of a block that is not sound; texts, no pictures
constexpr std::size_t kMostExifKept = 28'000;  // [bytes] of a directory, of which two fit into a JPEG segment
constexpr std::size_t kMostExifDirectories = 16;  // there are four: the picture, EXIF, places, exchange

// Bytes of a value by the number of its type (TIFF 6.0, section 2); 0 of types that there are not.
constexpr std::array<std::uint64_t, 13> kExifBytesOf = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8};
// Those that are numbers and texts: BYTE, ASCII, SHORT, LONG, RATIONAL, SLONG, SRATIONAL.
const std::set<std::uint64_t> kPlainTypes = {1, 2, 3, 4, 5, 9, 10};

struct ExifEntry {
    std::uint64_t tag = 0, type = 0, count = 0;
    std::string_view field;  // 4 bytes: the value, or where it lies
};

struct ExifReader {
    std::string_view block;
    bool big_endian = false;

    std::uint64_t number(std::uint64_t at, std::uint64_t length) const {
        return number_in(block.substr(at, length), big_endian);
    }
    // The entries of a directory; nothing where they do not lie in the block.
    std::optional<std::vector<ExifEntry>> directory(std::uint64_t at) const {
        if (at + 2 > block.size()) return {};
        const std::uint64_t count = number(at, 2);
        if (at + 2 + count * kExifEntryBytes > block.size()) return {};
        std::vector<ExifEntry> entries;
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::uint64_t entry = at + 2 + i * kExifEntryBytes;
            entries.push_back(
                {number(entry, 2), number(entry + 2, 2), number(entry + 4, 4), block.substr(entry + 8, 4)});
        }
        return entries;
    }
    // Empty where it does not lie in the block.
    std::string_view value(const ExifEntry& entry) const {
        const std::uint64_t unit = entry.type < kExifBytesOf.size() ? kExifBytesOf[entry.type] : 0;
        const std::uint64_t size = unit * entry.count, at = number_in(entry.field, big_endian);
        if (size <= entry.field.size()) return entry.field.substr(0, size);
        return at + size <= block.size() ? block.substr(at, size) : std::string_view();
    }
    std::uint64_t place(const ExifEntry& entry) const { return number_in(entry.field, big_endian); }
};

std::optional<ExifReader> exif_reader(std::string_view block) {
    if (block.size() < 8 || block.size() > kLongestBlock) return {};
    const bool big_endian = block.starts_with("MM");
    if (!big_endian && !block.starts_with("II")) return {};
    return ExifReader{block, big_endian};
}

bool leads_on(const ExifEntry& entry) {
    return entry.tag == kExifPointer || entry.tag == kPlacesPointer || entry.tag == kExchangePointer;
}

bool is_sound_directory(const ExifReader& in, std::uint64_t at, std::size_t& seen) {
    if (++seen > kMostExifDirectories) return false;
    const auto entries = in.directory(at);
    if (!entries) return false;
    for (const ExifEntry& entry : *entries) {
        if (leads_on(entry) && !is_sound_directory(in, in.place(entry), seen)) return false;
        if (entry.tag != kMakerNote) continue;
        // Of those that are directories, as Canon's is.
        const auto note = in.directory(in.place(entry));
        for (const ExifEntry& own : note.value_or(std::vector<ExifEntry>()))
            if (leads_on(own) || own.tag == kMakerNote) return false;
    }
    return true;
}

// A directory as it is written: entries, and values behind them.
class DirectoryWriter {
public:
    DirectoryWriter(bool big_endian, std::uint64_t at) : big_endian_(big_endian), at_(at) {}

    void add(const ExifEntry& entry, std::string_view value) {
        bytes_ += kExifEntryBytes + value.size() + 1;
        if (bytes_ <= kMostExifKept) entries_.emplace_back(entry, value);
    }
    // The directory of EXIF follows this one.
    void lead_on() { leads_on_ = true; }
    bool empty() const { return entries_.empty() && !leads_on_; }

    std::string text() const {
        std::string entries = number(entries_.size() + (leads_on_ ? 1 : 0), 2), values;
        const std::uint64_t values_at =
            at_ + 2 + kExifEntryBytes * (entries_.size() + (leads_on_ ? 1 : 0)) + 4;
        for (const auto& [entry, value] : entries_) {
            entries += number(entry.tag, 2) + number(entry.type, 2) + number(entry.count, 4);
            std::string field(value);
            if (value.size() > 4) {
                field = number(values_at + values.size(), 4);
                values += value;
                if (values.size() % 2 == 1) values += '\0';
            }
            field.resize(4, '\0');
            entries += field;
        }
        const std::uint64_t next = values_at + values.size();
        if (leads_on_) entries += number(kExifPointer, 2) + number(4, 2) + number(1, 4) + number(next, 4);
        return entries + number(0, 4) + values;
    }

private:
    std::string number(std::uint64_t value, int length) const {
        std::string bytes;
        for (int i = 0; i < length; ++i)
            bytes += static_cast<char>(value >> 8 * (big_endian_ ? length - 1 - i : i) & 255);
        return bytes;
    }

    bool big_endian_;
    std::uint64_t at_;
    bool leads_on_ = false;
    std::size_t bytes_ = 0;
    std::vector<std::pair<ExifEntry, std::string_view>> entries_;
};

void keep_plain(const ExifReader& in, const std::vector<ExifEntry>& entries, DirectoryWriter& out) {
    for (const ExifEntry& entry : entries) {
        const std::string_view value = in.value(entry);
        if (!leads_on(entry) && entry.tag != kMakerNote && kPlainTypes.contains(entry.type) &&
            !value.empty() && value.size() <= kLongestValue)
            out.add(entry, value);
    }
}

}  // namespace

bool is_sound_exif(std::string_view block) {
    const auto in = exif_reader(block);
    std::size_t seen = 0;
    return in && is_sound_directory(*in, in->number(4, 4), seen);
}

std::string sound_part_of_exif(std::string_view block) {
    const auto in = exif_reader(block);
    const auto first = in ? in->directory(in->number(4, 4)) : std::nullopt;
    if (!first) return {};
    constexpr std::uint64_t header = 8;
    DirectoryWriter picture(in->big_endian, header);
    keep_plain(*in, *first, picture);
    std::optional<std::vector<ExifEntry>> exif;
    for (const ExifEntry& entry : *first)
        if (entry.tag == kExifPointer && !exif) exif = in->directory(in->place(entry));
    if (exif) picture.lead_on();
    if (picture.empty()) return {};
    std::string text(in->big_endian ? "MM\0*\0\0\0\x08" : "II*\0\x08\0\0\0", header);
    text += picture.text();
    if (!exif) return text;
    DirectoryWriter photograph(in->big_endian, text.size());
    keep_plain(*in, *exif, photograph);
    return text + photograph.text();
}

}  // namespace tangi
