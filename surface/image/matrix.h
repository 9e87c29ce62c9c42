// matrix.h: images as matrices of OpenCV, without a copy; for sources of this module only.
#pragma once

#include <opencv2/core.hpp>

#include "surface/image.h"

namespace tangi {

// The image must outlive the matrix, and what is const must not be written to through it.
inline cv::Mat matrix_of(const Image<float>& image) {
    return cv::Mat(image.height(), image.width(), CV_32F, const_cast<float*>(image.data()));
}
inline cv::Mat matrix_of(const Image<int>& image) {
    return cv::Mat(image.height(), image.width(), CV_32S, const_cast<int*>(image.data()));
}
inline cv::Mat matrix_of(const Image<Vec3>& image) {
    return cv::Mat(image.height(), image.width(), CV_32FC3, const_cast<Vec3*>(image.data()));
}

}  // namespace tangi
