// jpeg_segments.h: the markers of a JPEG file and what follows them (ITU-T T.81, annex B).
#pragma once

#include <cstdint>
#include <optional>

#include "surface/file/file_bytes.h"

namespace tangi {

constexpr int kJpegEnd = 0xD9, kJpegScan = 0xDA;  // EOI, SOS (T.81, table B.1)

struct JpegSegment {
    int marker = 0;
    std::uint64_t begin = 0, end = 0;  // the marker's first byte, and what follows the segment
    std::uint64_t content_at = 0;      // behind the length; `end` where the marker stands alone
};

// The next marker at or behind a place, as libjpeg looks for it: bytes before it do not count, nor do those
// within the packed data of a scan. Nothing where the file has none any more.
std::optional<std::uint64_t> next_jpeg_marker(const FileBytes& file, std::uint64_t at, bool in_scan);

// Nothing where the file ends before the segment does.
std::optional<JpegSegment> jpeg_segment_at(const FileBytes& file, std::uint64_t begin);

// False where a JPEG file ends before its picture does: before the marker EOI that follows its scans (T.81,
// B.1.1 and B.2.1). A decoder fills what is missing with grey and goes on. Where the file does not end with
// it, markers are followed from the first to the last, since a segment may hold a thumbnail with an end of
// its own, and behind its end a file may hold anything: the film of a motion photograph, a second picture,
// padding. True of all other files, and of those that cannot be read, which is for their reader to say.
bool is_whole_jpeg(const std::filesystem::path& path);

}  // namespace tangi
