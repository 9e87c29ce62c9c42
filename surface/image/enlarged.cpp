#include "surface/image/enlarged.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

// [pixels of the picture] Rows that are enlarged at a time: always the same, counted from the top, so that a
// part has the bits that the whole has there, which depend on how far OpenCV counts.
constexpr int kBlock = 16;
constexpr int kReach = 2;  // of both kernels

template <class T>
Image<T> enlarged(const Image<T>& image, int factor, const Region& part, int interpolation) {
    TP_REQUIRE(factor >= 1 && part.x0 >= 0 && part.y0 >= 0 && image.width() * factor >= part.x1 &&
                   image.height() * factor >= part.y1,
               "enough pixels");
    Image<T> result(part.width(), part.height());
    const cv::Mat small = view_of(image);
    const int rows = kBlock * factor, first = part.y0 / rows, end = (part.y1 + rows - 1) / rows;
    parallel_for(first, end, 1, [&](int begin, int last) {
        cv::Mat large;
        for (int block = begin; block < last; ++block) {
            const int from = std::max(block * kBlock - kReach, 0),
                      to = std::min((block + 1) * kBlock + kReach, image.height());
            cv::resize(small.rowRange(from, to), large, {image.width() * factor, (to - from) * factor}, 0, 0,
                       interpolation);
            const int y0 = std::max(block * rows, part.y0), y1 = std::min((block + 1) * rows, part.y1);
            large(cv::Rect(part.x0, y0 - from * factor, part.width(), y1 - y0))
                .copyTo(view_of(result).rowRange(y0 - part.y0, y1 - part.y0));
        }
    });
    return result;
}

}  // namespace

Image<Vec3> enlarged_linearly(const Image<Vec3>& image, int factor, int width, int height) {
    return enlarged(image, factor, {0, 0, width, height}, cv::INTER_LINEAR);
}

Image<Vec3> enlarged_linearly(const Image<Vec3>& image, int factor, const Region& part) {
    return enlarged(image, factor, part, cv::INTER_LINEAR);
}

Image<float> enlarged_smoothly(const Image<float>& image, int factor, int width, int height) {
    return enlarged(image, factor, {0, 0, width, height}, cv::INTER_CUBIC);
}

}  // namespace tangi
