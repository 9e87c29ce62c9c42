// jpeg_bytes.h: 8-bit numbers as a JPEG picture in memory, and back, through OpenImageIO.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tangi {

// Row-major; one channel or three, as they are: no colour space is said or undone.
struct Samples8 {
    int width = 0, height = 0, channels = 1;
    std::vector<std::uint8_t> values;
};

// Baseline, all channels of full size (4:4:4). `quality` 1..100. Throws Error where it cannot be made.
std::string jpeg_bytes(const Samples8& samples, int quality);

// What any decoder makes of it, to a step of rounding. Throws Error where it is no such picture.
Samples8 samples_of_jpeg(std::string_view bytes);

}  // namespace tangi
