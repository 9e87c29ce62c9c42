// marker_pictures.h: pictures of ArUco markers on a plane that is seen in perspective, for tests.
#pragma once

#include <opencv2/aruco.hpp>

#include "tests/support/capture/chart_pictures.h"

namespace tangi {

struct Placed {
    int id;
    glm::dvec2 middle_mm;
    double turn_deg;
};

inline constexpr double kSide_mm = 25;

// The plane of tests, y up: about 0.3 mm a pixel.
inline Homography view(double tilt) {
    const glm::dmat3 pose(std::cos(tilt), 0.03, std::sin(tilt), 0.02, -std::cos(tilt), 0.1 * std::sin(tilt),
                          0, 0, 500);
    const glm::dmat3 camera(1600, 0, 0, 0, 1600, 0, 400, 300, 1);
    return camera * pose;
}

inline Image<Rgb> picture_of(const std::vector<Placed>& placed, int dictionary, const Homography& h,
                             double noise = 0.01) {
    Image<Rgb> picture(800, 600);
    const Homography inverse = glm::inverse(h);
    std::vector<cv::Mat> bits;
    for (const Placed& p : placed) {
        cv::Mat marker;
        cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(dictionary), p.id, 200, marker);
        bits.push_back(marker);
    }
    for (int y = 0; y < 600; ++y)
        for (int x = 0; x < 800; ++x) {
            float sum = 0;
            for (int s = 0; s < 16; ++s) {
                const int column = s % 4, row = s / 4;
                const glm::dvec2 mm =
                    mapped(inverse, glm::dvec2(x + (column - 1.5) / 4, y + (row - 1.5) / 4));
                float value = 0.7f;
                for (std::size_t i = 0; i < placed.size(); ++i) {
                    const double turn = placed[i].turn_deg * std::numbers::pi / 180;
                    const glm::dvec2 d = mm - placed[i].middle_mm;
                    const glm::dvec2 p(std::cos(turn) * d.x + std::sin(turn) * d.y,
                                       -std::sin(turn) * d.x + std::cos(turn) * d.y);
                    const double u = (p.x / kSide_mm + 0.5) * 200, v = (0.5 - p.y / kSide_mm) * 200;
                    if (u >= 0 && v >= 0 && u < 200 && v < 200)
                        value = bits[i].at<unsigned char>(static_cast<int>(v), static_cast<int>(u)) ? 0.7f
                                                                                                    : 0.03f;
                }
                sum += value / 16;
            }
            picture(x, y) = Rgb(sum * (0.6f + 0.4f * static_cast<float>(x) / 800));
        }
    add_noise(picture, noise, 0.002, 3);
    return picture;
}

inline const std::vector<Placed> kFour = {
    {3, {-85, 60}, 0}, {7, {80, 55}, 90}, {11, {85, -60}, 30}, {20, {-80, -55}, -20}};

}  // namespace tangi
