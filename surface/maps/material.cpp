#include "surface/maps/material.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tangi {

namespace {

constexpr float kLeastRoughness = 1e-6f;  // [1] that a painting may hold (painting_file.h)
constexpr float kLeastVariance = kLeastRoughness * kLeastRoughness;

float roughness_of(float variance) {
    return std::max(std::sqrt(std::max(variance, kLeastVariance)), kLeastRoughness);
}

// Of the covariance of slopes: its trace, the difference of its diagonal, and what is beside it.
void stretch_half_vector(float trace, float difference, float beside, Material& mean) {
    const float off = std::sqrt(difference * difference / 4 + beside * beside);
    const float root2 = std::max(trace * trace / 4 - off * off, 0.0f);  // the determinant
    mean.roughness = roughness_of(2 * std::sqrt(root2));
    const float s = std::min(std::asinh(2 * off / (mean.roughness * mean.roughness)) / 2,
                             static_cast<float>(kMostStretch));
    // What is anisotropic further than can be told is no narrower for it.
    mean.roughness = roughness_of(std::max(trace, kLeastVariance) / std::cosh(2 * s));
    if (off > 0) mean.stretch = s / off * Stretch(difference / 2, beside);
}

}  // namespace

Material material_at(const Surface& s, int x, int y) {
    return {s.normal(x, y),
            s.diffuse(x, y),
            s.specular(x, y),
            s.roughness(x, y),
            s.height_mm(x, y),
            s.confidence(x, y),
            s.specular_colour.empty() ? Rgb(1) : s.specular_colour(x, y),
            s.lobe_axes.empty() ? Stretch(0) : stretch_of(s.lobe_axes(x, y), s.roughness(x, y))};
}

void set_material(Surface& s, int x, int y, const Material& m) {
    s.normal(x, y) = m.normal;
    s.diffuse(x, y) = m.diffuse;
    s.specular(x, y) = m.specular;
    s.roughness(x, y) = m.roughness;
    s.height_mm(x, y) = m.height_mm;
    s.confidence(x, y) = m.confidence;
    if (!s.specular_colour.empty()) s.specular_colour(x, y) = m.specular_colour;
    if (s.lobe_axes.empty()) return;
    s.lobe_axes(x, y) = axes_of(m.stretch, m.roughness);
    s.lobe_axes(x, y).roughness_v = std::max(s.lobe_axes(x, y).roughness_v, kLeastRoughness);
}

void MeanMaterial::add(const Material& m) {
    const Slope slope = slope_of(m.normal);
    const float weight = m.specular + 1e-6f;
    sum_.normal += m.normal;
    sum_.diffuse += m.diffuse;
    sum_.specular += m.specular;
    specular_colour_ += weight * m.specular_colour;
    sum_.height_mm += m.height_mm;
    sum_.confidence += m.confidence;
    gloss_ += weight;
    slope_x_ += weight * slope.x;
    slope_y_ += weight * slope.y;
    spread_ += weight * (m.roughness * m.roughness + slope.x * slope.x + slope.y * slope.y);
    if (anisotropic_) {
        // alpha^2 / 2 is the variance of slopes in one direction.
        const StretchShape<float> shape = shape_of(m.stretch.x, m.stretch.y);
        const float half = weight * m.roughness * m.roughness / 2;
        differ_ += half * shape.a * 2 + weight * (slope.x * slope.x - slope.y * slope.y);
        cross_ += half * shape.b + weight * slope.x * slope.y;
        spread_ += 2 * half * (shape.c - 1);
    }
    ++count_;
}

Material MeanMaterial::material() const {
    const float length = glm::length(sum_.normal) / count_;
    const float x = slope_x_ / gloss_, y = slope_y_ / gloss_;
    const float variance = spread_ / gloss_ - x * x - y * y;
    Material mean{glm::normalize(sum_.normal), sum_.diffuse * (length / count_), sum_.specular / count_,
                  roughness_of(variance),      sum_.height_mm / count_,          sum_.confidence / count_,
                  specular_colour_ / gloss_};
    if (anisotropic_)
        stretch_half_vector(variance, differ_ / gloss_ - x * x + y * y, cross_ / gloss_ - x * y, mean);
    return mean;
}

}  // namespace tangi
