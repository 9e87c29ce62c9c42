#include "surface/maps/mean_material.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// Of the covariance of slopes: its trace, the difference of its diagonal, and what is beside it.
void stretch_half_vector(float trace, float difference, float beside, Material& mean) {
    const float off = std::sqrt(difference * difference / 4 + beside * beside);
    const float root2 = std::max(trace * trace / 4 - off * off, 0.0f);  // the determinant
    mean.roughness = std::sqrt(std::max(2 * std::sqrt(root2), 1e-12f));
    const float s = std::min(std::asinh(2 * off / (mean.roughness * mean.roughness)) / 2,
                             static_cast<float>(kMostStretch));
    // What is anisotropic further than can be told is no narrower for it.
    mean.roughness = std::sqrt(std::max(trace, 1e-12f) / std::cosh(2 * s));
    if (off > 0) mean.stretch = s / off * Stretch(difference / 2, beside);
}

void set(Surface& surface, int x, int y, const Material& m) {
    surface.normal(x, y) = m.normal;
    surface.diffuse(x, y) = m.diffuse;
    surface.specular(x, y) = m.specular;
    surface.roughness(x, y) = m.roughness;
    surface.height_mm(x, y) = m.height_mm;
    surface.confidence(x, y) = m.confidence;
    if (!surface.specular_colour.empty()) surface.specular_colour(x, y) = m.specular_colour;
    if (!surface.lobe_axes.empty()) surface.lobe_axes(x, y) = axes_of(m.stretch, m.roughness);
}

Material mean_of_block(const Surface& surface, int x0, int y0, int factor) {
    const int x1 = std::min(x0 + factor, surface.width()), y1 = std::min(y0 + factor, surface.height());
    MeanMaterial measured(!surface.lobe_axes.empty()), all(!surface.lobe_axes.empty());
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const Material material = material_at(surface, x, y);
            all.add(material);
            if (material.confidence > 0) measured.add(material);
        }
    return measured.empty() ? all.material() : measured.material();
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
    Material mean{glm::normalize(sum_.normal), sum_.diffuse * (length / count_),
                  sum_.specular / count_,      std::sqrt(std::max(variance, 1e-12f)),
                  sum_.height_mm / count_,     sum_.confidence / count_,
                  specular_colour_ / gloss_};
    if (anisotropic_)
        stretch_half_vector(variance, differ_ / gloss_ - x * x + y * y, cross_ / gloss_ - x * y, mean);
    return mean;
}

Surface reduced(const Surface& surface, int factor) {
    require_consistent(surface);
    TP_REQUIRE(factor >= 1, "a whole number of pixels a block");
    const int width = (surface.width() + factor - 1) / factor;
    const int height = (surface.height() + factor - 1) / factor;
    Surface small(width, height);
    if (!surface.specular_colour.empty()) small.specular_colour = Image<Rgb>(width, height);
    if (!surface.lobe_axes.empty()) small.lobe_axes = Image<LobeAxes>(width, height);
    small.reflectance_model = surface.reflectance_model;
    small.mm_per_pixel = surface.mm_per_pixel * factor;
    small.scale_known = surface.scale_known;
    small.photography = surface.photography;
    small.provenance = surface.provenance;
    parallel_for(0, height, 4, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x)
                set(small, x, y, mean_of_block(surface, x * factor, y * factor, factor));
    });
    return small;
}

}  // namespace tangi
