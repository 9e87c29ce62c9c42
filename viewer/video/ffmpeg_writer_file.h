// ffmpeg_writer_file.h: a video of pictures, through FFmpeg's libraries: H.264 in .mp4, which plays
// everywhere, or VP9 in .webm, which is free of patents.
//
// Colour is that of sRGB, and says so: luma and chroma after ITU-R BT.709-6 (table 3, 8 bits, limited range),
// primaries of BT.709, transfer of IEC 61966-2-1. Chroma has half the resolution both ways and lies at the
// left of its luma pair.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "viewer/video/video_writer.h"

namespace tangi {

// A picture as a video stores it. Both sides of it are even: an odd last column or row is there twice.
struct VideoPlanes {
    int width = 0, height = 0;                  // of luma; of chroma the half
    std::vector<std::uint8_t> luma, blue, red;  // Y', C'B, C'R
};
VideoPlanes video_planes(const Image<Rgb>& encoded_srgb);

// Throws Error where the file cannot be written, or this machine's FFmpeg has no encoder for its extension.
std::unique_ptr<Film> make_video(const std::filesystem::path& file, double frames_per_s);

}  // namespace tangi
