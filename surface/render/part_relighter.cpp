#include "surface/render/part_relighter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/maps/surface_part.h"
#include "surface/render/relighter.h"

namespace tangi {

namespace {

constexpr int kBeside = 2;  // [pixels] that a march looks at beside its way: neighbours, and its own slope
constexpr int kHeightsRounds = 2;  // lower relief nearby shortens the reach once it is known what is near

Region common(const Region& a, const Region& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

Region merged(const Region& a, const Region& b) {
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

// Relief that is `rise` pixels high hides no light from farther away than this [pixels] (cast_shadows.h): at
// t pixels it ends rise cos e - t sin e above the line to the light, and its lower edge, of the disc widened
// by half of what the line rises within a pixel, is t tan(radius) cos e + w / 2 below. w is at most sin e and
// what the ground falls within a pixel.
double reach_of(double rise, double across, double up, double tangent) {
    const double per_step = up - tangent * across;
    if (per_step <= 0) return INFINITY;
    const double widened = (up + rise * across) / 2;
    return (rise * (across + tangent * up) + widened) / per_step;
}

}  // namespace

PartRelighter::PartRelighter(std::shared_ptr<const PaintingReader> painting, const RelightOptions& options)
    : painting_(std::move(painting)), options_(options) {
    validate(options);
    describe(painting_->header(), numbers_);
    numbers_.height_mm = Image<float>(1, 1);
    options_.light_radius_deg = light_radius_deg(numbers_, options);
    blocks_ = painting_->blocks();
    if (!options.cast_shadows) return;
    heights_ = painting_->height_ranges();
}

HeightRange PartRelighter::heights_in(const Region& region) const {
    std::optional<HeightRange> range;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        if (common(blocks_[i], region).empty()) continue;
        if (!range) range = heights_[i];
        range->lowest = std::min(range->lowest, heights_[i].lowest);
        range->highest = std::max(range->highest, heights_[i].highest);
    }
    return range.value_or(HeightRange{});
}

Region PartRelighter::within_reach(const Region& part, const Light& light) const {
    const PaintingReader& p = *painting_;
    const Region whole = {0, 0, p.width(), p.height()};
    const HeightRange own = heights_in(part);
    const double tangent = std::tan(*options_.light_radius_deg * std::numbers::pi / 180);
    Region region = whole;
    // Of a near light the direction is another at each pixel; it is lowest, and farthest to each side, at a
    // corner, and for what is highest.
    std::vector<Vec3> directions;
    Surface point = numbers_;
    point.height_mm(0, 0) = own.highest;
    for (const int x : {part.x0, part.x1 - 1})
        for (const int y : {part.y0, part.y1 - 1}) {
            point.part_of = {x, y, static_cast<double>(p.width()), static_cast<double>(p.height())};
            directions.push_back(
                incidence(light, point.point_mm(0, 0), p.header().photography.rig).direction);
        }
    for (int round = 0; round < kHeightsRounds; ++round) {
        const double rise =
            (static_cast<double>(heights_in(region).highest) - own.lowest) / p.header().mm_per_pixel;
        double reach = 0;
        for (const Vec3& l : directions)
            reach = std::max(reach, reach_of(rise, std::hypot(l.x, l.y), l.z, tangent));
        reach = std::min(reach, static_cast<double>(whole.x1) + whole.y1);
        Region next = part;
        for (const Vec3& l : directions) {
            const double across = std::hypot(l.x, l.y);
            const double x = across > 0 ? reach * l.x / across : 0,
                         y = across > 0 ? -reach * l.y / across : 0;
            next = merged(next, {part.x0 + static_cast<int>(std::floor(std::min(x, 0.0))),
                                 part.y0 + static_cast<int>(std::floor(std::min(y, 0.0))),
                                 part.x1 + static_cast<int>(std::ceil(std::max(x, 0.0))),
                                 part.y1 + static_cast<int>(std::ceil(std::max(y, 0.0)))});
        }
        region = {std::max(next.x0 - kBeside, 0), std::max(next.y0 - kBeside, 0),
                  std::min(next.x1 + kBeside, whole.x1), std::min(next.y1 + kBeside, whole.y1)};
    }
    return region;
}

Image<Rgb> PartRelighter::draw_block(const Region& part, std::span<const Light> lights) const {
    const Surface surface = painting_->read(part);
    Image<Rgb> picture(part.width(), part.height());
    const auto ambient = static_cast<float>(options_.ambient);
    for (std::size_t i = 0; i < picture.size(); ++i)
        picture.pixels()[i] = ambient * surface.diffuse.pixels()[i];
    for (const Light& light : lights) {
        Image<float> heights;
        Region around = part;
        if (options_.cast_shadows) {
            around = within_reach(part, light);
            heights = painting_->read_heights(around, 0);
        }
        const Relighter relighter(surface, options_,
                                  Surroundings{heights, part.x0 - around.x0, part.y0 - around.y0});
        parallel_for(0, part.height(), 16, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) relighter.add_row(light, y, picture.row(y));
        });
    }
    if (finish_) finish_(surface, lights, picture);
    return picture;
}

Image<Rgb> PartRelighter::draw(const Region& part, std::span<const Light> lights) const {
    Image<Rgb> picture(part.width(), part.height());
    for (const Region& block : blocks_)
        if (const Region some = common(block, part); !some.empty()) {
            const Image<Rgb> drawn = draw_block(some, lights);
            paste(drawn, drawn.region(), picture, some.x0 - part.x0, some.y0 - part.y0);
        }
    return picture;
}

void PartRelighter::draw_bands(std::span<const Light> lights,
                               const std::function<void(Image<Rgb>&& rows, int top)>& take,
                               const Progress& progress) const {
    for (int top = 0; const Region& block : blocks_) {
        if (block.y0 < top) continue;  // beside one that is drawn
        report(progress, "relight", top / static_cast<double>(painting_->height()));
        top = block.y1;
        take(draw({0, block.y0, painting_->width(), block.y1}, lights), block.y0);
    }
    report(progress, "relight", 1);
}

Image<Rgb> PartRelighter::draw_all(std::span<const Light> lights, const Progress& progress) const {
    Image<Rgb> picture;
    draw_bands(
        lights,
        [&](Image<Rgb>&& rows, int top) {
            if (rows.height() == painting_->height()) {
                picture = std::move(rows);
                return;
            }
            if (picture.empty()) picture = Image<Rgb>(painting_->width(), painting_->height());
            paste(rows, rows.region(), picture, 0, top);
        },
        progress);
    return picture;
}

}  // namespace tangi
