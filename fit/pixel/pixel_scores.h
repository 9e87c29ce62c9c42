// pixel_scores.h: how well each pixel of a sample is predicted in photographs that were left out.
//
// What is true of lights, or of all of a painting, explains its pixels alike. What only takes up how some of
// them differ from the model (metal, in most cases, whose errors outweigh all others) worsens the rest: a
// mean over the picture cannot tell, the part of the pixels that are better off can.
#pragma once

#include <vector>

namespace tangi {

inline constexpr double kMostPixels = 0.5;  // [1] part that is most of them, to be exceeded

class PixelScores {
public:
    // One more photograph: squared errors [1], NaN where there is none; `noise` [1] is the square that is to
    // be expected of stored values, and part of every error. Of pixels that are marked, or all. All
    // photographs have the same pixels.
    void add(const std::vector<double>& squared_errors, double noise, const std::vector<bool>& marked = {});
    void add(const PixelScores& other);

    // [1] Part of the pixels, of those that both know, whose mean over photographs of the error in dB is less
    // here; 0 where there are none.
    double part_better_than(const PixelScores& other) const;
    // [dB] By how much the median pixel's is less; 0 likewise.
    double median_gain_db(const PixelScores& other) const;

private:
    std::vector<double> gains_db(const PixelScores& other) const;

    std::vector<double> sum_db_;
    std::vector<int> photos_;
};

}  // namespace tangi
