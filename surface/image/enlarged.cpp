#include "surface/image/enlarged.h"

#include <opencv2/imgproc.hpp>

#include "surface/base/error.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

template <class T>
Image<T> enlarged(const Image<T>& image, int factor, int width, int height, int interpolation) {
    TP_REQUIRE(image.width() * factor >= width && image.height() * factor >= height, "enough pixels");
    cv::Mat whole;
    cv::resize(view_of(image), whole, {image.width() * factor, image.height() * factor}, 0, 0, interpolation);
    Image<T> result(width, height);
    whole(cv::Rect(0, 0, width, height)).copyTo(view_of(result));
    return result;
}

}  // namespace

Image<Vec3> enlarged_linearly(const Image<Vec3>& image, int factor, int width, int height) {
    return enlarged(image, factor, width, height, cv::INTER_LINEAR);
}

Image<float> enlarged_smoothly(const Image<float>& image, int factor, int width, int height) {
    return enlarged(image, factor, width, height, cv::INTER_CUBIC);
}

}  // namespace tangi
