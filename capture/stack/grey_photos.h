// grey_photos.h: photographs as grey pictures, as stored, for measuring where things are in them.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "capture/stack/photo_set.h"
#include "surface/base/progress.h"
#include "surface/image/image.h"

namespace tangi {

// All photographs of a stack, grey (mean of the channels, 0..1 as the set has them), reduced so that all fit
// into memory. Pixel (x, y) of a reduced picture is the square of reduction^2 pixels from (reduction * x,
// reduction * y) on.
struct GreyPhotos {
    int width = 0, height = 0;  // of the photographs
    int reduction = 1;
    float step = 1.0f / 255;         // what one code of the file is worth; 1e-4 for floats
    std::vector<Image<float>> mean;  // mean of each square
    std::vector<Image<float>>
        brightest;  // brightest pixel of each square; empty where reduction = 1: it is the mean

    const Image<float>& peaks(std::size_t photo) const {
        return reduction == 1 ? mean[photo] : brightest[photo];
    }
    double reduced(double pixel) const { return (pixel + 0.5) / reduction - 0.5; }
    double full(double pixel) const { return (pixel + 0.5) * reduction - 0.5; }
};

// Throws Error naming the file: not a picture, damaged, another size than the first. `most_values` bounds the
// memory: pixels of all reduced pictures together.
GreyPhotos read_grey_photos(const PhotoSet& set, const Progress& progress = {},
                            std::size_t most_values = std::size_t{40} << 20);

// A region of one photograph in full size, grey.
Image<float> read_grey_region(const PhotoSet& set, std::size_t photo, const Region& region);

// The pictures in a folder in the order of their names. Pictures whose name says `mask` are left out and
// named in `warnings`. Throws Error where there is no such folder, or no picture in it.
std::vector<std::filesystem::path> pictures_in(const std::filesystem::path& folder,
                                               std::vector<std::string>& warnings);

}  // namespace tangi
