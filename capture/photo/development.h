// development.h: how the files of a stack become linear light where reading them is not enough: camera raw,
// dark frames, flat fields, ambient light, exposure brackets.
//
// A developed photograph is, for each pixel and channel, with f(.) the transfer curve undone,
//     value = colour * ((merge_k((f(photo_k) - dark) / exposure_k) - ambient) / flat)
//     ambient = (f(ambient photo) - dark) / its exposure,    flat = (f(flat photo) - dark) / its mean over
//     the picture
// in units of the reference exposure, so that 1 is full scale of a photograph taken with it. (EMVA 1288
// release 4.0, 2021, section 2, for the linear model of a sensor.)
#pragma once

#include <filesystem>
#include <glm/mat3x3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surface/file/scratch_file.h"
#include "surface/image/colour.h"

namespace tangi {

enum class RawColour {
    rec709,  // by the camera's white balance for the first photograph, and its matrix in LibRaw
    camera,  // the camera's own primaries, unbalanced: for a matrix from a colour chart, later
};

// What is asked for. Frames are a picture each, or a folder of pictures that are averaged, of the size of the
// photographs, stored as they are.
struct DevelopOptions {
    std::optional<std::filesystem::path> dark{};     // lens covered, same ISO and exposure time
    std::optional<std::filesystem::path> flat{};     // an even white surface, not clipped
    std::optional<std::filesystem::path> ambient{};  // the painting with the light off, as the photographs
    std::optional<std::string> brackets{};           // "auto", or a file (brackets.h)
    std::string demosaic = "AHD";                    // demosaic_methods()
    RawColour raw_colour = RawColour::rec709;
};

// One photograph of a bracket, or the only one.
struct Exposure {
    std::filesystem::path path;
    double relative = 1;  // [1] light that reaches the sensor, in units of the stack's reference exposure
};

// Rows of numbers on disk: width * channels values a row, row y at y.
template <class T>
class ScratchRows {
public:
    ScratchRows(int pictures, int height, std::size_t row, const std::string& what)
        : height_(height),
          row_(row),
          file_(static_cast<std::uint64_t>(pictures) * static_cast<std::uint64_t>(height) * row * sizeof(T),
                what) {}

    void write(int picture, int y0, std::span<const T> values) {
        file_.write(offset(picture, y0), std::as_bytes(values));
    }
    void read(int picture, int y0, std::span<T> values) const {
        file_.read(offset(picture, y0), std::as_writable_bytes(values));
    }
    std::uint64_t bytes() const { return file_.size(); }

private:
    std::uint64_t offset(int picture, int y) const {
        return (static_cast<std::uint64_t>(picture) * static_cast<std::uint64_t>(height_) +
                static_cast<std::uint64_t>(y)) *
               row_ * sizeof(T);
    }
    int height_;
    std::size_t row_;
    ScratchFile file_;
};
using Frame = ScratchRows<float>;
using DevelopedRaws = ScratchRows<std::uint16_t>;

// All that reading a developed stack needs; made by develop_stack(), shared by copies of the stack, not
// changed any more.
struct Development {
    Transfer encoding;            // of the files
    std::string encoding_source;  // in words
    int bits = 16;                // of the files, as PhotoHeader::bits
    std::string demosaic;
    std::vector<float> table{};  // linear light of each stored code; empty for files of floats
    std::shared_ptr<const Frame> dark{}, ambient{},
        gain{};  // gain = 1 / flat; NaN where the flat tells nothing
    std::shared_ptr<const DevelopedRaws> raws{};
    std::map<std::filesystem::path, int> raw_index{};  // pictures in `raws`
    std::optional<glm::mat3> colour{};
    // Linear value of samples that are clipped in all exposures; others are smaller. Infinite for files of
    // floats.
    float clipped = 1;
    float sensor_clipped = 1;  // the same before `colour`

    float decode(float stored) const;
};

}  // namespace tangi
