// lens_file.cpp: through OpenCV's camera model.
#include "capture/formats/lens_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/formats/storage_text.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

using glm::dvec2;

namespace {

cv::Matx33d matrix_of(const Lens& lens) {
    return {lens.focal_px.x, 0, lens.principal_px.x, 0, lens.focal_px.y, lens.principal_px.y, 0, 0, 1};
}

// Radial distortion that turns back within the picture shows its middle twice: no lens does.
void require_no_fold(const Lens& lens, const std::filesystem::path& path) {
    std::array<double, 8> d{};
    std::copy_n(lens.distortion.begin(), std::min(lens.distortion.size(), d.size()), d.begin());
    const auto distorted = [&d](double r) {
        const double s = r * r;
        return r * (1 + s * (d[0] + s * (d[1] + s * d[4]))) / (1 + s * (d[5] + s * (d[6] + s * d[7])));
    };
    double corner = 0;
    for (const double x : {0.0, lens.width - 1.0})
        for (const double y : {0.0, lens.height - 1.0})
            corner = std::max(corner, glm::length((dvec2(x, y) - lens.principal_px) / lens.focal_px));
    const double step = corner / 1000, most = 20 * corner;
    double reached = 0;
    for (double r = step; reached < corner; r += step) {
        const double next = distorted(r);
        if (!(next > reached) || r > most)
            fail(
                "{}: its distortion turns back {:.0f} pixels from the middle of the picture, of which the "
                "corners are {:.0f} pixels away; is it of this lens, and were the photographs of the "
                "calibration good to the corners?",
                path.string(), reached * lens.focal_px.x, corner * lens.focal_px.x);
        reached = next;
    }
}

Lens lens_in(const StorageNode& file, const std::filesystem::path& path) {
    const StorageMatrix camera = matrix_in(file, "camera_matrix", path.string());
    if (camera.rows != 3 || camera.columns != 3)
        fail("{}: camera_matrix is {} x {} instead of 3 x 3", path.string(), camera.rows, camera.columns);
    Lens lens;
    lens.distortion = matrix_in(file, "distortion_coefficients", path.string()).values;
    const std::size_t count = lens.distortion.size();
    if (count != 4 && count != 5 && count != 8 && count != 12 && count != 14)
        fail("{}: distortion_coefficients has {} numbers instead of 4, 5, 8, 12 or 14", path.string(), count);
    lens.width = size_in(file, "image_width", path.string());
    lens.height = size_in(file, "image_height", path.string());
    lens.focal_px = {camera.values[0], camera.values[4]};
    lens.principal_px = {camera.values[2], camera.values[5]};
    if (!(lens.focal_px.x > 0 && lens.focal_px.y > 0))
        fail("{}: the focal lengths in camera_matrix are {:g} and {:g} pixels", path.string(),
             lens.focal_px.x, lens.focal_px.y);
    if (!(lens.principal_px.x > 0 && lens.principal_px.y > 0 && lens.principal_px.x < lens.width &&
          lens.principal_px.y < lens.height))
        fail("{}: the principal point ({:.1f}, {:.1f}) in camera_matrix lies outside its pictures of {} x {}",
             path.string(), lens.principal_px.x, lens.principal_px.y, lens.width, lens.height);
    require_no_fold(lens, path);
    return lens;
}

}  // namespace

Lens read_lens(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    if (extension != ".yml" && extension != ".yaml" && extension != ".xml")
        fail("{}: a lens is read from .yml, .yaml or .xml files of OpenCV's calibration", path.string());
    if (!std::filesystem::is_regular_file(path)) fail("{}: there is no such file", path.string());
    return lens_in(parse_storage(read_text_file(path), extension == ".xml", path.string()), path);
}

Lens lens_for(const Lens& lens, int width, int height) {
    if (width == lens.width && height == lens.height) return lens;
    const double sx = static_cast<double>(width) / lens.width, sy = static_cast<double>(height) / lens.height;
    if (std::abs(sx - sy) > 1.0 / std::min(width, height))
        fail(
            "the lens was calibrated with pictures of {} x {} pixels, which are not these of {} x {}, nor "
            "reduced to "
            "them; take the calibration of this camera, turned as it was",
            lens.width, lens.height, width, height);
    Lens result = lens;  // centres of pixels are at integers
    result.width = width, result.height = height;
    result.focal_px = lens.focal_px * dvec2(sx, sy);
    result.principal_px = (lens.principal_px + 0.5) * dvec2(sx, sy) - 0.5;
    return result;
}

Image<glm::vec2> undistortion_map(const Lens& calibrated, int width, int height) {
    TP_REQUIRE(width > 0 && height > 0, "a picture has pixels");
    const Lens lens = lens_for(calibrated, width, height);
    Image<glm::vec2> map(width, height);
    cv::Mat result(height, width, CV_32FC2, map.data()), nothing;
    cv::initUndistortRectifyMap(matrix_of(lens), lens.distortion, cv::noArray(), matrix_of(lens),
                                {width, height}, CV_32FC2, result, nothing);
    TP_REQUIRE(result.data == reinterpret_cast<unsigned char*>(map.data()),
               "OpenCV fills the map it is given");
    return map;
}

Image<Rgb> through_map(const Image<Rgb>& picture, const Image<glm::vec2>& map) {
    Image<Rgb> result(map.width(), map.height());
    if (picture.empty() || map.empty()) return result;
    const cv::Mat from(picture.height(), picture.width(), CV_32FC3, const_cast<Rgb*>(picture.data()));
    const cv::Mat places(map.height(), map.width(), CV_32FC2, const_cast<glm::vec2*>(map.data()));
    cv::Mat to(map.height(), map.width(), CV_32FC3, result.data());
    cv::remap(from, to, places, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_CONSTANT);
    return result;
}

dvec2 undistorted(const Lens& lens, const dvec2& place_px) {
    std::vector<cv::Point2d> from = {{place_px.x, place_px.y}}, to;
    cv::undistortPoints(from, to, matrix_of(lens), lens.distortion, cv::noArray(), matrix_of(lens),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10));
    return {to[0].x, to[0].y};
}

// Our own, since it is called for every pixel of every photograph (OpenCV's documentation of calib3d has the
// formulas).
dvec2 distorted(const Lens& lens, const dvec2& place_px) {
    const auto k = [&](std::size_t i) { return i < lens.distortion.size() ? lens.distortion[i] : 0.0; };
    const dvec2 p = (place_px - lens.principal_px) / lens.focal_px;
    const double r2 = p.x * p.x + p.y * p.y, r4 = r2 * r2;
    const double radial =
        (1 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (1 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    dvec2 q(p.x * radial + 2 * k(2) * p.x * p.y + k(3) * (r2 + 2 * p.x * p.x) + k(8) * r2 + k(9) * r4,
            p.y * radial + k(2) * (r2 + 2 * p.y * p.y) + 2 * k(3) * p.x * p.y + k(10) * r2 + k(11) * r4);
    if (k(12) != 0 || k(13) != 0) {  // the sensor is tilted
        const double cx = std::cos(k(12)), sx = std::sin(k(12)), cy = std::cos(k(13)), sy = std::sin(k(13));
        const double z = sy * q.x - cy * sx * q.y + cy * cx;
        const dvec2 turned(cy * q.x + sy * sx * q.y - sy * cx, cx * q.y + sx);
        q = dvec2(cy * cx * turned.x + sy * cx * z, cy * cx * turned.y - sx * z) / z;
    }
    return q * lens.focal_px + lens.principal_px;
}

}  // namespace tangi
