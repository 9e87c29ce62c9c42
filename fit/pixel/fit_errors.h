// fit_errors.h: how certain each map of a fitted painting is.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>

#include "surface/image/image.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

// A float's upper half: any magnitude, to 0.4 %. Enough for a standard error, and half the memory.
class HalfError {
public:
    HalfError(float value = 0)
        : bits_(static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x8000) >> 16)) {}
    operator float() const { return std::bit_cast<float>(std::uint32_t{bits_} << 16); }

private:
    std::uint16_t bits_;
};

// Standard errors of each pixel, of the size of the surface; 0 where it was not measured. They say how far
// noise and what the model leaves out, as large as the residuals show it, may have moved a value; not what
// wrong light directions do to all pixels alike.
struct FitErrors {
    Image<HalfError> slope;      // [1] of dz/dx and dz/dy, root of the mean of both variances
    Image<HalfError> diffuse;    // [1] of rho_d, mean of the channels
    Image<HalfError> specular;   // [1] of rho_s
    Image<HalfError> roughness;  // [1] of alpha
    // [mm] Of the height less its mean over the 33 x 33 pixels around (height_error.h): what it is across
    // longer distances no error says. All 0 in files of before it was stored.
    Image<HalfError> height;

    FitErrors() = default;
    FitErrors(int columns, int rows)
        : slope(columns, rows),
          diffuse(columns, rows),
          specular(columns, rows),
          roughness(columns, rows),
          height(columns, rows) {}
};

// The part `errors` of a painting file: channels diffuse, height, roughness, slope, specular. Refers to
// `errors`, which must live until it is written.
PartToWrite part_of(const FitErrors& errors);

bool has_errors(const std::filesystem::path& painting);
// The same among the parts of a painting that is read by rectangles.
std::optional<PartInfo> errors_part(const std::vector<PartInfo>& parts);

// Throws Error: no such part, or other channels in it.
FitErrors read_errors(const std::filesystem::path& painting, const Progress& progress = {});

}  // namespace tangi
