// jpeg_markers.h: whether a JPEG file holds its picture to the end.
#pragma once

#include <filesystem>

namespace tangi {

// False where a JPEG file ends before its picture does: before the marker EOI that follows its scans (ITU-T
// T.81, B.1.1 and B.2.1). A decoder fills what is missing with grey and goes on. Where the file does not end
// with it, markers are followed from the first to the last, since a segment may hold a thumbnail with an end
// of its own, and behind its end a file may hold anything: the film of a motion photograph, a second picture,
// padding. True of all other files, and of those that cannot be read, which is for their reader to say.
bool is_whole_jpeg(const std::filesystem::path& path);

}  // namespace tangi
