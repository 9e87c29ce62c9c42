// motion_template.h: the edges that photographs have in common, on which find_camera_motions() lays them. For
// camera_motion.cpp alone: names of its own namespace, and OpenCV.
#pragma once

#include <glm/vec4.hpp>
#include <opencv2/core.hpp>
#include <vector>

#include "capture/registration/camera_motion.h"

namespace tangi::motion_template {

struct Directions {  // cosine and sine of twice the edge's direction, times its strength
    cv::Mat cosine, sine;
};

Directions directions_of(const Image<float>& photo, float step, double blur);

// Bilinear; the border goes on.
float sample(const cv::Mat& m, double x, double y);

// CameraMotion::to_photo() for many pixels.
class ToPhoto {
public:
    ToPhoto(const CameraMotion& drift, const glm::dvec2& centre)
        : cosine_(drift.zoom * std::cos(drift.roll_rad)),
          sine_(drift.zoom * std::sin(drift.roll_rad)),
          centre_(centre),
          target_(centre + drift.shift_px) {}

    glm::dvec2 operator()(const glm::dvec2& pixel) const {
        const glm::dvec2 d = pixel - centre_;
        return target_ + glm::dvec2(cosine_ * d.x - sine_ * d.y, sine_ * d.x + cosine_ * d.y);
    }

private:
    double cosine_, sine_;
    glm::dvec2 centre_, target_;
};

// Of photographs that are laid on each other by their drifts.
Directions mean_of(const std::vector<Directions>& all, const std::vector<CameraMotion>& drifts,
                   const glm::dvec2& centre);

// The template's clearest pixels, with the derivatives of its values by shift, roll and zoom.
struct TemplatePixel {
    float x, y, value[2];
    glm::dvec4 slope[2];
};

std::vector<TemplatePixel> template_pixels(const Directions& mean, const glm::dvec2& centre);

}  // namespace tangi::motion_template
