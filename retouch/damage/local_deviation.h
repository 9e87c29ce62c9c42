// local_deviation.h: how far pixels are from the median of what is around them, in robust spreads; for
// sources of this module only.
#pragma once

#include <cmath>
#include <opencv2/core.hpp>

namespace tangi {

// Median and spread (1.4826 times the median absolute deviation) in a square of 2 * radius + 1 pixels around
// each; values beyond the picture count as its border. Values are taken in 254 steps between the 0.1 and 99.9
// % quantiles. CV_32F of the size of `values`.
struct LocalStatistics {
    cv::Mat median, spread;
};
LocalStatistics local_statistics(const cv::Mat& values, int radius);

// The same with a median of the deviations from `median`, which are >= 0.
cv::Mat local_spread(const cv::Mat& deviations, int radius);

// The value that `part` of all values are below.
float quantile(const cv::Mat& values, double part);

// [1] How sure what stands out makes one: 1/2 at 1, the steeper the smaller `width` is.
inline double rising(double v, double width) { return 1 / (1 + std::exp((1 - v) / width)); }

// What areas are widened or narrowed by that many pixels with.
cv::Mat disc(int radius);

}  // namespace tangi
