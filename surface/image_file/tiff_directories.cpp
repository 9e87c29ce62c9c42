#include "surface/image_file/tiff_directories.h"

#include <algorithm>
#include <array>

namespace tangi {

namespace {

constexpr std::uint64_t kMostTiffEntries = 4096;  // libtiff knows some 300 tags
// Bytes of a value by the number of its type; BigTIFF adds 16 to 18.
constexpr std::array<std::uint64_t, 19> kTiffBytesOf = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4,
                                                        8, 4, 8, 4, 0, 0, 8, 8, 8};

std::uint64_t bytes_of_type(const TiffEntry& entry) {
    return entry.type < kTiffBytesOf.size() ? kTiffBytesOf[entry.type] : 0;
}

}  // namespace

TiffDirectories::TiffDirectories(const FileBytes& file) : file_(file) {
    const std::string head = file.bytes(0, 2);
    if (head != "II" && head != "MM") return;
    big_endian_ = head == "MM";
    constexpr std::uint64_t classic = 42, big = 43;
    const std::uint64_t version = number(2, 2);
    if (version != classic && version != big) return;
    is_big_ = version == big;
    first_ = number(is_big_ ? 8 : 4, offset_bytes());
}

std::optional<TiffDirectory> TiffDirectories::at(std::uint64_t place) const {
    const int count_bytes = is_big_ ? 8 : 2;
    const std::uint64_t count = number(place, count_bytes), entry_bytes = is_big_ ? 20 : 12;
    if (count > kMostTiffEntries) return {};
    TiffDirectory directory;
    const std::uint64_t first_entry = place + static_cast<std::uint64_t>(count_bytes);
    const auto width = static_cast<std::uint64_t>(offset_bytes());
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t entry = first_entry + i * entry_bytes, field = entry + 4 + width;
        TiffEntry e{number(entry, 2), number(entry + 2, 2), number(entry + 4, offset_bytes()), entry + 4};
        e.bytes = e.count > file_.size() ? file_.size() + 1 : bytes_of_type(e) * e.count;
        e.value_at = e.bytes <= width ? field : number(field, offset_bytes());
        directory.entries.push_back(e);
    }
    directory.next = number(first_entry + count * entry_bytes, offset_bytes());
    return directory;
}

std::vector<std::uint64_t> TiffDirectories::values(const TiffEntry& entry, std::uint64_t most) const {
    const std::uint64_t unit = bytes_of_type(entry);
    std::vector<std::uint64_t> values;
    for (std::uint64_t i = 0; unit > 0 && i < std::min(entry.count, most); ++i)
        if (const auto value = file_.number(entry.value_at + i * unit, static_cast<int>(unit), big_endian_))
            values.push_back(*value);
    return values;
}

double TiffDirectories::value(const TiffEntry& entry) const {
    const std::vector<std::uint64_t> first = values(entry, 1);
    return first.empty() ? 0 : static_cast<double>(first.front());
}

}  // namespace tangi
