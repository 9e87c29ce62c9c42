// stated_transfer.h: which transfer curve a file says that it is stored with.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/photo/photo_metadata.h"
#include "surface/image/colour.h"

namespace tangi {

struct StatedTransfer {
    std::optional<Transfer> transfer;  // empty where the file states a curve that is none of ours
    std::string source;                // "ICC profile", "PNG gAMA chunk", "PNG sRGB chunk", "EXIF ColorSpace"
    // Somebody meant it: an ICC profile, or a PNG gamma other than sRGB's. Cameras and programs write "sRGB"
    // into EXIF and PNG files whatever is in them; that is only compared.
    bool binding = false;
};

// What the metadata state, the most trustworthy first; empty where they say nothing (EXIF: "uncalibrated").
std::optional<StatedTransfer> transfer_of_metadata(const PhotoMetadata& metadata);

// The curve of an ICC profile's red, green and blue (or grey) tone curves: linear, sRGB, a gamma or a smooth
// curve (as CIE L*), whichever is within 1 % of full scale everywhere. Empty where none is, where the
// channels differ, or where the profile has tables instead (ICC.1:2010, 9.2, 10.5, 10.15).
std::optional<Transfer> transfer_of_icc(std::string_view profile);

// Largest difference of what two curves make of the same stored value [1].
double difference(const Transfer& a, const Transfer& b);

}  // namespace tangi
