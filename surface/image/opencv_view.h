// matrix.h: OpenCV's view of an image, without a copy. For sources only: headers do not need OpenCV.
#pragma once

#include <opencv2/core.hpp>

#include "surface/image.h"

namespace tangi {

// Of the image's own memory; writing to what a const image shows is the caller's mistake.
inline cv::Mat view_of(const Image<float>& image) {
    return {image.height(), image.width(), CV_32F, const_cast<float*>(image.data())};
}

}  // namespace tangi
