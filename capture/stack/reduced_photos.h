// reduced_photos.h: the photographs of a large stack, reduced, in memory: for what needs no single pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "capture/stack/survey.h"

namespace tangi {

// Filled in with bands as they are read for another purpose. A pixel is the mean of `reduction` x `reduction`
// stored values; the highest of them where one is clipped; NaN where one is. The mean is taken before the
// transfer curve is known: where values within it differ by 10 % (rms), an sRGB value is off by 0.3 %.
class ReducedPhotos {
public:
    // The reduction by which a picture has at most a megapixel; 1: it has no more.
    static int reduction_for(int width, int height);

    ReducedPhotos() = default;  // of no stack
    // Takes its number of photographs, channels, size, and from where values are clipped.
    ReducedPhotos(const Stack& stack, int reduction);

    // A band of these photographs, as stored (Transfer{}). Bands must cover the stack, ascending.
    void add(const Band& band);
    // Forgets the photographs that are not kept, in their order.
    void keep(const std::vector<bool>& kept);

    bool empty() const { return photos_.empty(); }
    int reduction() const { return reduction_; }
    int width() const { return width_; }
    int height() const { return height_; }
    // As StackReader::read(), of the reduced photographs.
    Band read(int y0, int y1, const Transfer& transfer) const;

private:
    struct Photo {
        // [channel][row][column] Values as stored. Half floats keep 11 bits at any magnitude.
        std::vector<std::uint16_t> values;
        std::vector<float> sum, highest;  // [channel][column of the stack] of the rows of one that is filled
    };
    void finish_row(Photo& photo, int row) const;

    int channels_ = 0, full_width_ = 0, full_height_ = 0, width_ = 0, height_ = 0, reduction_ = 1;
    float clipped_ = 0;  // [1] stored
    bool developed_ = false;
    std::vector<Photo> photos_;
};

// Whether a pixel of a reduced mask has any of the mask's; empty where that is.
Image<unsigned char> reduced_mask(const Image<unsigned char>& mask, int reduction);

// The samples, at pixels of the reduced picture.
Survey at_reduced_positions(Survey survey, int reduction);

}  // namespace tangi
