#include "surface/image_file/jpeg_segments.h"

#include <algorithm>
#include <string>

#include "surface/base/error.h"

namespace tangi {

namespace {

// Table B.1: TEM, restarts, the picture's start.
bool stands_alone(int marker) { return marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8); }

// Whether a file whose scans begin at `scans` ends with EOI, but for some zeros: then nothing is cut off.
bool ends_with_picture(const FileBytes& file, std::uint64_t scans) {
    constexpr std::uint64_t tail = 4096;
    const std::uint64_t length = std::min(file.size() - std::min(scans, file.size()), tail);
    std::string bytes = file.bytes(file.size() - length, length);
    bytes.erase(bytes.find_last_not_of('\0') + 1);
    return bytes.ends_with("\xFF\xD9");
}

bool is_whole(const FileBytes& file) {
    if (file.bytes(0, 2) != "\xFF\xD8") return true;
    bool has_scan = false, in_scan = false;
    std::uint64_t at = 2;
    while (const auto begin = next_jpeg_marker(file, at, in_scan)) {
        const auto segment = jpeg_segment_at(file, *begin);
        if (!segment) return false;
        if (segment->marker == kJpegEnd) return has_scan;
        in_scan = segment->marker == kJpegScan;
        at = segment->end;
        if (!in_scan || has_scan) continue;
        has_scan = true;
        if (ends_with_picture(file, at)) return true;  // most do, and need not be read
    }
    return false;
}

}  // namespace

std::optional<std::uint64_t> next_jpeg_marker(const FileBytes& file, std::uint64_t at, bool in_scan) {
    constexpr std::uint64_t ahead = 1u << 20;
    while (at < file.size()) {
        const std::string bytes = file.bytes(at, ahead);
        for (std::size_t i = bytes.find('\xFF'); i != std::string::npos && i + 1 < bytes.size();
             i = bytes.find('\xFF', i + 1)) {
            const int marker = static_cast<unsigned char>(bytes[i + 1]);
            const bool restarts = marker >= 0xD0 && marker <= 0xD7;
            if (marker != 0 && marker != 0xFF && !(in_scan && restarts)) return at + i;
        }
        if (bytes.size() < ahead) break;
        at += ahead - 1;  // a marker may lie across
    }
    return {};
}

std::optional<JpegSegment> jpeg_segment_at(const FileBytes& file, std::uint64_t begin) {
    const auto marker = file.number(begin + 1, 1, true);
    if (!marker) return {};
    JpegSegment segment{static_cast<int>(*marker), begin, begin + 2, begin + 2};
    if (stands_alone(segment.marker) || segment.marker == kJpegEnd) return segment;
    const auto length = file.number(begin + 2, 2, true);
    // Lengths count their own two bytes. Of one that is less, libjpeg takes these two, and goes on behind
    // them to the next marker; whoever stopped here would not see what it sees.
    if (!length || begin + 2 + std::max<std::uint64_t>(*length, 2) > file.size()) return {};
    segment.content_at = begin + 4;
    segment.end = begin + 2 + std::max<std::uint64_t>(*length, 2);
    return segment;
}

bool is_whole_jpeg(const std::filesystem::path& path) {
    try {
        return is_whole(FileBytes(path));
    } catch (const Error&) {
        return true;
    }
}

}  // namespace tangi
