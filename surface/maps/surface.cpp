#include "surface/maps/surface.h"

#include <array>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// Pixels from the centre of the picture, y up.
double centred_x(int x, double width) { return x - (width - 1) / 2.0; }
double centred_y(int y, double height) { return (height - 1) / 2.0 - y; }

// Names come from file systems, where any bytes are allowed; what is not UTF-8 in them is lost in a painting
// file.
std::string as_stored(const std::string& name) { return json_line(nlohmann::json(name)); }

}  // namespace

// Memory is touched here for the first time, which takes longer than to write to it: by all threads.
Surface::Surface(int width, int height) {
    parallel_for(0, 6, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            if (i == 0) normal = Image<Vec3>(width, height, Vec3(0, 0, 1));
            if (i == 1) diffuse = Image<Rgb>(width, height, Rgb(0));
            if (i == 2) height_mm = Image<float>(width, height);
            if (i == 3) specular = Image<float>(width, height);
            if (i == 4) roughness = Image<float>(width, height, 0.3f);
            if (i == 5) confidence = Image<float>(width, height);
        }
    });
}

Vec3 Surface::point_mm(int x, int y) const {
    const PartOfPainting place =
        part_of.value_or(PartOfPainting{0, 0, static_cast<double>(width()), static_cast<double>(height())});
    return {static_cast<float>(centred_x(x + place.left, place.width) * mm_per_pixel),
            static_cast<float>(centred_y(y + place.top, place.height) * mm_per_pixel), height_mm(x, y)};
}

glm::dmat3 from_camera(const Photography& photography) {
    return photography.to_camera ? glm::inverse(*photography.to_camera) : glm::dmat3(1);
}

const Photography::Photo* find_photo(const Photography& photography, const Light& light) {
    constexpr float same_light = 0.9986f;  // cosine of 3 degrees: lights files round their vectors
    for (const Photography::Photo& photo : photography.photos)
        if (std::max(glm::dot(photo.light.direction, light.direction),
                     glm::dot(photo.listed_direction.value_or(photo.light.direction), light.direction)) >=
                same_light &&
            as_stored(photo.light.name) == as_stored(light.name))
            return &photo;
    return nullptr;
}

std::vector<Light> fitted_lights(const Photography& photography) {
    std::vector<Light> lights;
    for (const Photography::Photo& photo : photography.photos)
        if (photo.fitted) lights.push_back(photo.light);
    return lights;
}

std::vector<Vec3> directions_as_listed(const Photography& photography) {
    std::vector<Vec3> directions;
    for (const Photography::Photo& photo : photography.photos)
        if (photo.fitted) directions.push_back(photo.listed_direction.value_or(photo.light.direction));
    return directions;
}

Light as_photographed(const Light& light, const Photography& photography) {
    Light result = light;
    if (const Photography::Photo* photo = find_photo(photography, light)) {
        result.gain = photo->light.gain;
        result.beam = photo->light.beam;
        if (!result.position_mm) {
            if (photo->listed_direction) result.direction = photo->light.direction;
            result.position_mm = photo->light.position_mm;
        }
        return result;
    }
    const std::vector<Light> fitted = fitted_lights(photography);
    if (photography.directions) {
        result.direction =
            predicted_direction(*photography.directions, directions_as_listed(photography), light.direction);
        if (result.position_mm) result.position_mm = result.direction * glm::length(*result.position_mm);
    }
    if (!result.position_mm) place(result, photography.rig);
    if (photography.light_model)
        result.gain = static_cast<float>(predicted_gain(*photography.light_model, fitted, result.direction)) *
                      predicted_colour(*photography.light_model, fitted, result.direction);
    if (photography.beams) result.beam = predicted_beam(*photography.beams, fitted, result.direction);
    return result;
}

void require_consistent(const Surface& s) {
    const Region region = s.height_mm.region();
    TP_REQUIRE(s.normal.region() == region && s.diffuse.region() == region && s.specular.region() == region &&
                   s.roughness.region() == region && s.confidence.region() == region &&
                   (s.specular_colour.empty() || s.specular_colour.region() == region) &&
                   (s.lobe_axes.empty() || s.lobe_axes.region() == region),
               "all maps of a surface have the same size");
}

Image<Vec3> normals_of(const Image<float>& height_mm, double mm_per_pixel) {
    const int width = height_mm.width(), height = height_mm.height();
    Image<Vec3> normal(width, height);
    for (int y = 0; y < height; ++y) {
        const int up = std::max(y - 1, 0), down = std::min(y + 1, height - 1);
        for (int x = 0; x < width; ++x) {
            const int left = std::max(x - 1, 0), right = std::min(x + 1, width - 1);
            const float dx = static_cast<float>(std::max(right - left, 1) * mm_per_pixel);
            const float dy = static_cast<float>(std::max(down - up, 1) * mm_per_pixel);
            normal(x, y) = normal_of({(height_mm(right, y) - height_mm(left, y)) / dx,
                                      (height_mm(x, up) - height_mm(x, down)) / dy});
        }
    }
    return normal;
}

Plane best_plane(const Image<float>& height_mm, const Image<float>& weight) {
    const int width = height_mm.width(), height = height_mm.height();
    glm::dmat3 a(0);
    glm::dvec3 b(0);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double w = weight.empty() ? 1.0 : weight(x, y);
            if (!(w > 0)) continue;
            const glm::dvec3 basis(centred_x(x, width), centred_y(y, height), 1);
            a += w * glm::outerProduct(basis, basis);
            b += w * height_mm(x, y) * basis;
        }
    }
    // A picture of one row or column, or of no measured pixel, determines no tilt: the mean is all there is.
    if (!(std::abs(glm::determinant(a)) > 1e-9 * a[0][0] * a[1][1] * a[2][2]))
        return {0, 0, a[2][2] > 0 ? b.z / a[2][2] : 0};
    const glm::dvec3 plane = glm::inverse(a) * b;
    return {plane.x, plane.y, plane.z};
}

void subtract(const Plane& plane, Image<float>& height_mm) {
    const int width = height_mm.width(), height = height_mm.height();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            height_mm(x, y) -=
                static_cast<float>(plane.a * centred_x(x, width) + plane.b * centred_y(y, height) + plane.c);
}

}  // namespace tangi
