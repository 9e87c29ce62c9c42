#include "paint/canvas/layer_pictures.h"

#include <cmath>
#include <glm/common.hpp>

#include "surface/base/error.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

Image<Rgb> encoded(const Image<Rgb>& linear) {
    const Transfer srgb{Transfer::Kind::srgb};
    Image<Rgb> result(linear.width(), linear.height());
    for (std::size_t i = 0; i < result.size(); ++i)
        result.pixels()[i] = srgb.encode(glm::clamp(linear.pixels()[i], 0.0f, 1.0f));
    return result;
}

// The least alpha with which a colour in [0, 1] makes `wanted` of `below`.
float least_alpha(float below, float wanted) {
    if (wanted > below) return (wanted - below) / (1 - below);
    return below > 0 ? (below - wanted) / below : 0;
}

LayerPicture picture_of(const std::string& name, const PaintLayer& paint, const Image<Rgb>& below,
                        const Image<Rgb>& with, double covering_mm) {
    LayerPicture layer{name, Image<Rgb>(below.width(), below.height()),
                       Image<float>(below.width(), below.height()),
                       Image<float>(below.width(), below.height())};
    paint.add_thickness_mm(paint.region(), layer.thickness_mm.data(),
                           static_cast<std::size_t>(below.width()));
    for (std::size_t i = 0; i < below.size(); ++i) {
        const float mm = layer.thickness_mm.pixels()[i];
        if (!(mm > 0)) continue;
        const Rgb &b = below.pixels()[i], &w = with.pixels()[i];
        float alpha = 1 - portable::exp(-mm / static_cast<float>(covering_mm));
        for (int c = 0; c < 3; ++c) alpha = std::max(alpha, least_alpha(b[c], w[c]));
        alpha = std::min(alpha, 1.0f);
        layer.alpha.pixels()[i] = alpha;
        layer.srgb.pixels()[i] = alpha > 1e-4f ? glm::clamp((w - (1 - alpha) * b) / alpha, 0.0f, 1.0f) : w;
    }
    return layer;
}

}  // namespace

std::vector<LayerPicture> layer_pictures(const Canvas& canvas, const AppearanceOptions& options,
                                         const Progress& progress) {
    validate(options);
    std::vector<LayerPicture> layers;
    layers.push_back({"dry", encoded(canvas.dry().diffuse),
                      Image<float>(canvas.width(), canvas.height(), 1.0f), Image<float>()});
    Canvas up_to(canvas.dry_shared(), canvas.mm_per_pixel());
    for (const Pigment& paint : canvas.ingredients()) up_to.add(paint);
    Image<Rgb> below = layers.front().srgb;
    const auto add = [&](const std::string& name, const PaintLayer& paint) {
        Image<Rgb> with = encoded(appearance(up_to, options, progress).diffuse);
        layers.push_back(picture_of(name, paint, below, with, options.covering_mm));
        below = std::move(with);
    };
    for (const DriedLayer& dried : canvas.dried()) {
        up_to.writable_dried().push_back(dried);
        if (!dried.paint.empty()) add(dried.name, dried.paint);
    }
    up_to.writable_wet() = canvas.wet();
    if (!canvas.wet().empty()) add("wet", canvas.wet());
    return layers;
}

Image<float> thickness_mm_of(const PaintLayer& paint, IngredientId ingredient) {
    constexpr int size = PaintTile::kSize;
    Image<float> result(paint.width(), paint.height());
    for (const TileIndex at : paint.painted()) {
        const Region region = paint.region_of(at);
        for (const IngredientId id : {ingredient, upper_of(ingredient)}) {
            const auto plane = paint.tile(at)->plane(id);
            if (plane.empty()) continue;
            for (int y = region.y0; y < region.y1; ++y)
                for (int x = region.x0; x < region.x1; ++x)
                    result(x, y) += plane[static_cast<std::size_t>((y - region.y0) * size + x - region.x0)];
        }
    }
    return result;
}

Image<Rgb> laid_over(const std::vector<LayerPicture>& layers) {
    TP_REQUIRE(!layers.empty(), "there is the dry surface at least");
    Image<Rgb> result = layers.front().srgb;
    for (std::size_t k = 1; k < layers.size(); ++k)
        for (std::size_t i = 0; i < result.size(); ++i) {
            const float alpha = layers[k].alpha.pixels()[i];
            result.pixels()[i] += alpha * (layers[k].srgb.pixels()[i] - result.pixels()[i]);
        }
    return result;
}

}  // namespace tangi
