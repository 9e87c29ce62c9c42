#include "viewer/video/light_sweep.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "surface/base/error.h"

namespace tangi {

namespace {

// [degrees on the dome], of an arc on which elevation goes with azimuth; exact where one of them stays.
double length_deg(const Angles& from, const Angles& to) {
    const double middle_rad = (from.elevation_deg + to.elevation_deg) / 2 * std::numbers::pi / 180;
    return std::hypot((to.azimuth_deg - from.azimuth_deg) * std::cos(middle_rad),
                      to.elevation_deg - from.elevation_deg);
}

}  // namespace

std::vector<Angles> sweep_path(std::vector<Angles> corners, int frames) {
    TP_REQUIRE(!corners.empty() && frames > 0, "a way has a corner and pictures");
    if (corners.size() == 1) corners.push_back({corners[0].azimuth_deg + 360, corners[0].elevation_deg});
    std::vector<double> reached{0};  // [deg] at each corner
    for (std::size_t i = 1; i < corners.size(); ++i)
        reached.push_back(reached.back() + length_deg(corners[i - 1], corners[i]));
    const Angles &first = corners.front(), &last = corners.back();
    const bool closed = glm::dot(direction_of(first.azimuth_deg, first.elevation_deg),
                                 direction_of(last.azimuth_deg, last.elevation_deg)) > 1 - 1e-6f;
    const int steps = std::max(closed ? frames : frames - 1, 1);
    std::vector<Angles> path;
    for (int i = 0; i < frames; ++i) {
        const double at = reached.back() * i / steps;
        std::size_t leg = 1;
        while (leg + 1 < corners.size() && at > reached[leg]) ++leg;
        const double along = reached[leg] - reached[leg - 1];
        const double part = along > 0 ? (at - reached[leg - 1]) / along : 0;
        const Angles &from = corners[leg - 1], &to = corners[leg];
        path.push_back({std::lerp(from.azimuth_deg, to.azimuth_deg, part),
                        std::lerp(from.elevation_deg, to.elevation_deg, part)});
    }
    return path;
}

}  // namespace tangi
