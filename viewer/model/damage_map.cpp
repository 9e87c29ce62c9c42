#include "viewer/model/damage_map.h"

#include <algorithm>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr Rgb kSuggested(0.95f, 0.1f, 0.75f);

Rgb colour_of(Addition addition) {
    switch (addition) {
        case Addition::varnish:
            return {0.94f, 0.89f, 0.26f};
        case Addition::fill:
            return {0, 0.62f, 0.45f};
        case Addition::retouch:
            return {0, 0.45f, 0.7f};
        case Addition::beside:
            return {0.84f, 0.1f, 0.1f};
        case Addition::none:
            break;
    }
    return Rgb(0);
}

glm::u8vec4 bytes(const Rgb& colour, float alpha) {
    return glm::u8vec4(255.0f * glm::clamp(glm::vec4(colour, alpha), 0.0f, 1.0f) + 0.5f);
}

}  // namespace

Image<std::uint8_t> additions_of(const Canvas& canvas, const std::vector<TreatmentLayer>& layers,
                                 const Mask& belongs) {
    Image<std::uint8_t> all(canvas.width(), canvas.height());
    const auto put = [&](const PaintLayer& paint, LayerRole role) {
        for (const TileIndex at : paint.painted()) {
            const Region r = paint.region_of(at);
            Image<float> mm(r.width(), r.height());
            paint.add_thickness_mm(r, mm.data(), static_cast<std::size_t>(mm.width()));
            for (int y = 0; y < r.height(); ++y)
                for (int x = 0; x < r.width(); ++x) {
                    if (!(mm(x, y) > 0)) continue;
                    const int px = r.x0 + x, py = r.y0 + y;
                    Addition addition = Addition::varnish;
                    if (role == LayerRole::fill) addition = Addition::fill;
                    if (role == LayerRole::retouch)
                        addition = belongs(px, py) > 0 ? Addition::retouch : Addition::beside;
                    all(px, py) = std::max(all(px, py), static_cast<std::uint8_t>(addition));
                }
        }
    };
    for (const DriedLayer& layer : canvas.dried()) {
        const auto about = std::find_if(layers.begin(), layers.end(),
                                        [&](const TreatmentLayer& l) { return l.name == layer.name; });
        put(layer.paint, about == layers.end() ? LayerRole::retouch : about->role);
    }
    put(canvas.wet(), LayerRole::retouch);
    return all;
}

DamageMap::DamageMap(int width, int height) : width_(width), height_(height) {
    const int side = std::max(width, height);
    reduced_ = std::max((side + kMostPixels - 1) / kMostPixels, 1);
    picture_ = Picture((width + reduced_ - 1) / reduced_, (height + reduced_ - 1) / reduced_);
}

Region DamageMap::in_picture(const Region& r) const {
    return {r.x0 / reduced_, r.y0 / reduced_, std::min((r.x1 + reduced_ - 1) / reduced_, picture_.width()),
            std::min((r.y1 + reduced_ - 1) / reduced_, picture_.height())};
}

void DamageMap::reduce(const Mask& mask, const Region& r, Coverage& to) const {
    if (to.empty()) to = Coverage(picture_.width(), picture_.height());
    parallel_for(r.y0, r.y1, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                float most = 0;
                for (int v = y * reduced_; v < std::min((y + 1) * reduced_, height_); ++v)
                    for (int u = x * reduced_; u < std::min((x + 1) * reduced_, width_); ++u)
                        most = std::max(most, mask(u, v));
                to(x, y) = static_cast<std::uint8_t>(255 * std::clamp(most, 0.0f, 1.0f) + 0.5f);
            }
    });
}

void DamageMap::set(DamageClass damage, const Mask& mask, const Region& changed) {
    TP_REQUIRE(mask.width() == width_ && mask.height() == height_, "a mask has the painting's size");
    if (!changed.empty()) reduce(mask, in_picture(changed), classes_[static_cast<std::size_t>(damage)]);
}

void DamageMap::set_suggestion(const Mask& mask) {
    suggestion_ = Coverage();
    if (!mask.empty()) reduce(mask, picture_.region(), suggestion_);
}

void DamageMap::set_additions(const Image<std::uint8_t>& additions) {
    additions_ = Coverage(picture_.width(), picture_.height());
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            std::uint8_t& most = additions_(x / reduced_, y / reduced_);
            most = std::max(most, additions(x, y));
        }
}

// Outlines and hatches are as wide as the picture asks for, not a pixel.
float DamageMap::alpha(const Coverage& coverage, int x, int y, MapStyle style, bool falling) const {
    const float inside = static_cast<float>(coverage(x, y)) / 255;
    if (inside == 0 || style == MapStyle::filled) return inside;
    const int side = std::max(picture_.width(), picture_.height());
    if (style == MapStyle::hatched) {
        const int period = std::max(side / 120, 4), along = falling ? x - y + side : x + y;
        return inside * (along % period < (period + 1) / 3 ? 1.0f : 0.15f);
    }
    const int wide = std::max(side / 600, 1);
    for (const auto& [dx, dy] : {std::pair{wide, 0}, {-wide, 0}, {0, wide}, {0, -wide}}) {
        const int u = x + dx, v = y + dy;
        if (u < 0 || v < 0 || u >= picture_.width() || v >= picture_.height() || coverage(u, v) < 128)
            return inside;
    }
    return 0;
}

Region DamageMap::compose(const Style& style, const Region& region) {
    Region r = in_picture(region);
    if (style.style == MapStyle::outlined) {  // neighbours look at what changed
        const int wide = std::max(std::max(picture_.width(), picture_.height()) / 600, 1);
        r = {std::max(r.x0 - wide, 0), std::max(r.y0 - wide, 0), std::min(r.x1 + wide, picture_.width()),
             std::min(r.y1 + wide, picture_.height())};
    }
    parallel_for(r.y0, r.y1, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                if (style.additions) {
                    const auto kind =
                        additions_.empty() ? Addition::none : static_cast<Addition>(additions_(x, y));
                    picture_(x, y) = bytes(colour_of(kind), kind == Addition::none      ? 0.0f
                                                            : kind == Addition::varnish ? 0.4f
                                                                                        : 1.0f);
                    continue;
                }
                Rgb colour(0);
                float covered = 0;
                const auto over = [&](const Rgb& c, float a) {
                    const float both = a + covered * (1 - a);
                    if (both > 0) colour = (c * a + colour * (covered * (1 - a))) / both;
                    covered = both;
                };
                for (std::size_t i = 0; i < kDamageClasses.size(); ++i)
                    if (style.shown[i] && !classes_[i].empty())
                        over(legend_colour_srgb(kDamageClasses[i]),
                             alpha(classes_[i], x, y, style.style, i % 2 == 1));
                if (!suggestion_.empty()) over(kSuggested, static_cast<float>(suggestion_(x, y)) / 255);
                picture_(x, y) = bytes(colour, covered);
            }
    });
    return r;
}

Region DamageMap::compose(const Style& style) { return compose(style, {0, 0, width_, height_}); }

}  // namespace tangi
