// photo_metadata.h: what a photograph's file says about how it was taken and stored.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace tangi {

struct PhotoMetadata {
    std::optional<double> exposure_s{}, f_number{}, iso{};
    std::string icc_profile{};          // its bytes; empty where there is none
    std::optional<int> exif_colour{};   // EXIF ColorSpace: 1 = sRGB, 65535 = uncalibrated
    std::optional<double> png_gamma{};  // gAMA: encoded = linear ^ png_gamma
    bool png_srgb = false;              // sRGB chunk
};

// Reads the header only. Throws Error naming the file where it is no picture.
PhotoMetadata read_photo_metadata(const std::filesystem::path& path);

// Light on the sensor: time * ISO / 100 / f-number^2 [s]; where ISO or the f-number are not told (lenses
// without contacts), 100 and 1 stand for them. Empty where the time is not told.
std::optional<double> exposure_of(const PhotoMetadata& metadata);

}  // namespace tangi
