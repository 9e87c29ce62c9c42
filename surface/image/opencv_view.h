// opencv_view.h: OpenCV's view of an image, without a copy. For sources only: headers do not need OpenCV.
#pragma once

#include <opencv2/core.hpp>

#include "surface/image/image.h"

namespace tangi {

// Of the image's own memory, which must outlive the view; writing to what a const image shows is the caller's
// mistake.
inline cv::Mat view_of(const Image<float>& image) {
    return {image.height(), image.width(), CV_32F, const_cast<float*>(image.data())};
}
inline cv::Mat view_of(const Image<int>& image) {
    return {image.height(), image.width(), CV_32S, const_cast<int*>(image.data())};
}
inline cv::Mat view_of(const Image<Vec3>& image) {
    return {image.height(), image.width(), CV_32FC3, const_cast<Vec3*>(image.data())};
}

}  // namespace tangi
