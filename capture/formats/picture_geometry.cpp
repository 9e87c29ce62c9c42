#include "capture/formats/picture_geometry.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "surface/base/error.h"
#include "surface/maps/photography_json.h"

namespace tangi {

using glm::dvec2;
using nlohmann::json;

dvec2 PictureGeometry::place_in_photo(const dvec2& pixel) const {
    const dvec2 place = rectification ? mapped(*rectification, pixel) : pixel;
    return lens ? distorted(*lens, place) : place;
}

dvec2 PictureGeometry::place_in_picture(const dvec2& photo_px) const {
    const dvec2 place = lens ? undistorted(*lens, photo_px) : photo_px;
    return rectification ? mapped(glm::inverse(*rectification), place) : place;
}

namespace {

json pair_of(const dvec2& v) { return {v.x, v.y}; }
dvec2 pair_from(const json& j) { return {j.at(0).get<double>(), j.at(1).get<double>()}; }

int pixels_of(const json& j) {
    const int pixels = j.get<int>();
    if (pixels < 1 || pixels > 65535) fail("geometry: {} pixels is no size of a picture", pixels);
    return pixels;
}

Lens lens_from(const json& j, int width, int height) {
    Lens lens{width, height, pair_from(j.at("focal_px")), pair_from(j.at("principal_px")),
              j.at("distortion").get<std::vector<double>>()};
    if (!(lens.focal_px.x > 0 && lens.focal_px.y > 0)) fail("geometry.lens.focal_px is not positive");
    // As read_lens() takes them; pixels and coefficients of any lens are far below.
    constexpr double most = 1e7;
    const std::size_t count = lens.distortion.size();
    const auto is_large = [](double number) { return !(std::abs(number) <= most); };
    if (count != 4 && count != 5 && count != 8 && count != 12 && count != 14)
        fail("geometry.lens.distortion has {} numbers instead of 4, 5, 8, 12 or 14", count);
    if (std::ranges::any_of(lens.distortion, is_large) || is_large(lens.focal_px.x) ||
        is_large(lens.focal_px.y) || is_large(lens.principal_px.x) || is_large(lens.principal_px.y))
        fail("geometry.lens has a number beyond {}", most);
    return lens;
}

}  // namespace

json to_json(const PictureGeometry& g) {
    json lens = nullptr, camera = nullptr;
    if (g.lens)
        lens = {{"focal_px", pair_of(g.lens->focal_px)},
                {"principal_px", pair_of(g.lens->principal_px)},
                {"distortion", g.lens->distortion}};
    if (g.camera_mm) camera = {g.camera_mm->x, g.camera_mm->y, g.camera_mm->z};
    return {{"photograph_px", {g.photo_width, g.photo_height}},
            {"picture_px", {g.width, g.height}},
            {"lens", std::move(lens)},
            {"rectification", g.rectification ? to_json(*g.rectification) : json(nullptr)},
            {"mm_per_pixel", g.mm_per_pixel ? json(*g.mm_per_pixel) : json(nullptr)},
            {"turn", to_json(g.turn)},
            {"camera_mm", std::move(camera)}};
}

PictureGeometry geometry_from_json(const json& j) {
    PictureGeometry g;
    g.photo_width = pixels_of(j.at("photograph_px").at(0));
    g.photo_height = pixels_of(j.at("photograph_px").at(1));
    g.width = pixels_of(j.at("picture_px").at(0));
    g.height = pixels_of(j.at("picture_px").at(1));
    // A picture has as many pixels as the part of the photograph that shows it, not many times more.
    constexpr double most_enlarged = 16;
    if (static_cast<double>(g.width) * g.height >
        most_enlarged * static_cast<double>(g.photo_width) * g.photo_height)
        fail("geometry.picture_px = {} x {} is far more than the photographs' {} x {}", g.width, g.height,
             g.photo_width, g.photo_height);
    if (!j.at("lens").is_null()) g.lens = lens_from(j.at("lens"), g.photo_width, g.photo_height);
    if (!j.at("rectification").is_null()) {
        g.rectification = homography_from_json(j.at("rectification"));
        if (!(std::abs(glm::determinant(*g.rectification)) > 0))
            fail("geometry.rectification has no inverse");
    }
    if (!j.at("mm_per_pixel").is_null()) {
        g.mm_per_pixel = j.at("mm_per_pixel").get<double>();
        if (!(*g.mm_per_pixel >= 1e-6 && *g.mm_per_pixel <= 1e3))
            fail("geometry.mm_per_pixel = {} is not in [1e-06, 1000]", *g.mm_per_pixel);
    }
    g.turn = homography_from_json(j.at("turn"));
    const glm::dmat3 should_be_one = glm::transpose(g.turn) * g.turn;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(should_be_one[c][r] - (c == r)) < 1e-6)) fail("geometry.turn is no rotation");
    if (!j.at("camera_mm").is_null()) {
        const json& mm = j.at("camera_mm");
        g.camera_mm = {mm.at(0).get<double>(), mm.at(1).get<double>(), mm.at(2).get<double>()};
        if (!(g.camera_mm->z > 0)) fail("geometry.camera_mm is below the painting");
        constexpr double farthest_mm = 1e6;  // 1 km
        if (!(glm::length(*g.camera_mm) <= farthest_mm)) fail("geometry.camera_mm is farther away than 1 km");
    }
    return g;
}

}  // namespace tangi
