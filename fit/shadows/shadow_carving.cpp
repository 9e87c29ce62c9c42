#include "fit/shadows/shadow_carving.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "fit/height/height_rows.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// What a shadow's edge is off by: a part of a pixel, and what the light's direction is. Figures hardly depend
// on either (a factor of two: 0.1 dB of held-out photographs of the generated stacks with the highest
// relief).
constexpr float kEdgePixels = 0.02f;  // [pixels] of height
constexpr float kDirection = 0.005f;  // [rad]
// [standard deviations] Pairs that are farther off count less. Walls whose slopes no pixel shows are far off
// at first: with 3, half of what coin gains is lost.
constexpr float kFarOff = 30;
constexpr int kRounds = 4;
constexpr double kGains = 0.02;  // [1] of what contradicts; less is no round worth
constexpr int kSteps = 20;       // of conjugate gradients in each
constexpr double kSmall = 1e-4;  // [1] of the residual, squared, at which they stop
constexpr float kMostLoose = 1;  // [pixels^2] variance of an edge
// [rows] Constraints of one strip write to it and to kShadowReach + 1 rows above and below: every other strip
// can be worked on at the same time.
constexpr int kStrip = 160;
static_assert(kStrip >= 2 * (kShadowReach + 1));

// Between a pixel and its neighbours to the right, below and both.
struct Place {
    int pixel;
    float right, down;  // [1] weights of those neighbours
};

// z_q - z_p is to be `want`.
struct Pair {
    int p;
    Place q;
    float want;    // [mm]
    float weight;  // as an edge's
};

using Field = Image<float>;

class Carving {
public:
    Carving(const LightVisibility& lights, const Lighting& lighting, const SlopeEdges& edges,
            Surface& surface);
    // Finds what contradicts; how many.
    long find();
    // Towards the minimum, with what was found.
    void improve(const std::function<void(double done)>& report);
    long lights() const { return sum(seen_); }

private:
    // Towards a light, as the picture has it.
    struct Ray {
        float dx, dy;  // [pixels] of one step
        float climb;   // [mm] of one step
    };
    // What a march from a pixel towards a light meets.
    struct March {
        bool leaves = false;  // the picture, where more relief may stand
        int hides = 0,
            rises = 0;      // [pixels] to what hides it most, and to what has to rise least; 0: nothing
        float top = 0;      // [mm/pixel] horizon
        float rise_mm = 0;  // by how much
        float cost = std::numeric_limits<float>::max();  // [1] of that, squared, over its variance
    };
    // `highest_mm`: of all that it may meet, and of what may stand beyond the picture where it may leave it.
    March march(int x, int y, float highest_mm, const Ray& ray, const SeenLight& light) const;
    void find_in_row(int y, const CastShadows& shadows, std::vector<Pair>& pairs, long& seen) const;
    Place place_at(float x, float y) const;
    float at(const Place& place, const Field& field) const;
    Pair pair_of(int x, int y, const Ray& ray, int distance, float off_mm) const;
    float rise_of(const Pair& pair, const Field& field) const;
    void scatter(const Pair& pair, float value, Field& field) const;
    // Calls act(pair) for all, never two at once that write to the same rows.
    template <class Act>
    void for_pairs(const Act& act) const;
    void apply(const Field& field, Field& applied) const;  // of edges alone
    void start_gradients();
    float preconditioned(int x, int y) const {
        return diagonal_(x, y) > 0 ? residual_(x, y) / diagonal_(x, y) : 0.0f;
    }
    double step(double along);
    void turn(double kept);
    double curvature() const;
    static long sum(const std::vector<long>& rows) { return std::accumulate(rows.begin(), rows.end(), 0L); }
    template <class Product>
    double sum_over(const Product& product) const;

    const LightVisibility& lights_;
    const Lighting& lighting_;
    const SlopeEdges& edges_;
    const Surface& surface_;
    Field& z_;
    const Field before_;
    int width_, height_;
    float mm_, unit_;  // unit: [mm^2] variance of an edge of weight 1
    float highest_ = 0;
    Image<HalfError> loose_;  // [mm^2] variance of what lies between a pixel and the next
    std::vector<std::vector<Pair>> strips_;
    std::vector<long> seen_;
    Field residual_, direction_, applied_, diagonal_;
};

Carving::Carving(const LightVisibility& lights, const Lighting& lighting, const SlopeEdges& edges,
                 Surface& surface)
    : lights_(lights),
      lighting_(lighting),
      edges_(edges),
      surface_(surface),
      z_(surface.height_mm),
      before_(surface.height_mm),
      width_(surface.width()),
      height_(surface.height()),
      mm_(static_cast<float>(surface.mm_per_pixel)),
      unit_(2 * kSharpest * kSharpest * mm_ * mm_),
      loose_(width_, height_),
      strips_(static_cast<std::size_t>((height_ + kStrip - 1) / kStrip)),
      seen_(static_cast<std::size_t>(height_)),
      residual_(width_, height_),
      direction_(width_, height_),
      applied_(width_, height_),
      diagonal_(width_, height_) {
    parallel_for(0, height_, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < width_; ++x) {
                const float right = edges_.right(std::min(x, width_ - 2), y),
                            down = edges_.down(x, std::min(y, height_ - 2));
                const float variance = unit_ * (1 / right + 1 / down) / 2;
                loose_(x, y) = std::min(variance, kMostLoose * mm_ * mm_);
            }
    });
}

Place Carving::place_at(float x, float y) const {
    const int x0 = std::min(static_cast<int>(x), width_ - 2), y0 = std::min(static_cast<int>(y), height_ - 2);
    return {y0 * width_ + x0, x - static_cast<float>(x0), y - static_cast<float>(y0)};
}

float Carving::at(const Place& place, const Field& field) const {
    const float *above = &field.pixels()[static_cast<std::size_t>(place.pixel)], *below = above + width_;
    const float a = above[0] + place.right * (above[1] - above[0]),
                b = below[0] + place.right * (below[1] - below[0]);
    return a + place.down * (b - a);
}

Carving::March Carving::march(int x, int y, float highest_mm, const Ray& ray, const SeenLight& light) const {
    const auto [dx, dy, climb] = ray;
    March found;
    const float z0 = z_(x, y), most = highest_mm - z0;
    float loose = loose_(x, y);
    found.top = std::numeric_limits<float>::lowest();
    for (int distance = 1; distance <= kShadowReach; ++distance) {
        const auto t = static_cast<float>(distance);
        const float px = static_cast<float>(x) + t * dx, py = static_cast<float>(y) + t * dy;
        if (!(px >= 0 && py >= 0 && px <= static_cast<float>(width_ - 1) &&
              py <= static_cast<float>(height_ - 1))) {
            found.leaves = true;
            break;
        }
        const float short_of = climb * t - most;  // [mm] at least, from here on
        if (short_of > 0 && (light.lit || short_of * short_of > 4 * found.cost * loose)) break;
        const float rise = at(place_at(px, py), z_) - z0;
        if (rise > found.top * t) found.top = rise / t, found.hides = distance;
        const float off = climb * t - rise;
        if (light.lit) continue;
        if (off <= 0) return found;  // it is hidden
        loose += loose_(static_cast<int>(px + 0.5f), static_cast<int>(py + 0.5f));
        if (distance > light.run && off * off < found.cost * loose) {
            found.cost = off * off / loose;
            found.rises = distance;
            found.rise_mm = off;
        }
    }
    return found;
}

Pair Carving::pair_of(int x, int y, const Ray& ray, int distance, float off_mm) const {
    const auto [dx, dy, climb] = ray;
    const auto t = static_cast<float>(distance);
    const float slope = climb / mm_;
    const float turned = kDirection * (1 + slope * slope) * t;
    const float variance = mm_ * mm_ * (kEdgePixels * kEdgePixels + turned * turned);
    const float far_off = off_mm * off_mm / (kFarOff * kFarOff * variance);
    return {y * width_ + x, place_at(static_cast<float>(x) + t * dx, static_cast<float>(y) + t * dy),
            climb * t, unit_ / (variance * (1 + far_off))};
}

void Carving::find_in_row(int y, const CastShadows& shadows, std::vector<Pair>& pairs, long& seen) const {
    const bool inside = y >= kShadowReach && y < height_ - kShadowReach;
    for (const SeenLight& light : lights_.row(y)) {
        const auto x = static_cast<int>(light.x);
        const bool leaves_none = inside && x >= kShadowReach && x < width_ - kShadowReach;
        const float highest_mm = leaves_none ? shadows.highest_within(x, y, kShadowReach) : highest_;
        const Vec3 l =
            incidence(lighting_.lights[light.photo], surface_.point_mm(x, y), lighting_.rig).direction;
        const float across = std::hypot(l.x, l.y);
        if (!(across > 0.1f)) continue;
        const Ray ray{l.x / across, -l.y / across, l.z / across * mm_};
        const March met = march(x, y, highest_mm, ray, light);
        ++seen;
        const bool hidden = met.hides > 0 && met.top > ray.climb;
        if (hidden != light.lit) continue;
        const int distance = light.lit ? met.hides : met.rises;
        if (distance == 0) continue;
        if (!light.lit && (met.leaves || shadows.visible_part(x, y, l) < 0.5f)) continue;
        const float off = light.lit ? (met.top - ray.climb) * static_cast<float>(distance) : met.rise_mm;
        pairs.push_back(pair_of(x, y, ray, distance, off));
    }
}

long Carving::find() {
    highest_ = *std::max_element(z_.pixels().begin(), z_.pixels().end());
    const CastShadows shadows(z_, surface_.mm_per_pixel, 0);
    parallel_for(0, static_cast<int>(strips_.size()), 1, [&](int begin, int end) {
        for (int strip = begin; strip < end; ++strip) {
            std::vector<Pair>& pairs = strips_[static_cast<std::size_t>(strip)];
            pairs.clear();
            for (int y = strip * kStrip; y < std::min((strip + 1) * kStrip, height_); ++y) {
                long& seen = seen_[static_cast<std::size_t>(y)];
                seen = 0;
                find_in_row(y, shadows, pairs, seen);
            }
        }
    });
    long contradicted = 0;
    for (const std::vector<Pair>& pairs : strips_) contradicted += static_cast<long>(pairs.size());
    return contradicted;
}

float Carving::rise_of(const Pair& pair, const Field& field) const {
    return at(pair.q, field) - field.pixels()[static_cast<std::size_t>(pair.p)];
}

void Carving::scatter(const Pair& pair, float value, Field& field) const {
    float *above = &field.pixels()[static_cast<std::size_t>(pair.q.pixel)], *below = above + width_;
    const float lower = value * pair.q.down, upper = value - lower;
    above[0] += upper * (1 - pair.q.right);
    above[1] += upper * pair.q.right;
    below[0] += lower * (1 - pair.q.right);
    below[1] += lower * pair.q.right;
    field.pixels()[static_cast<std::size_t>(pair.p)] -= value;
}

template <class Act>
void Carving::for_pairs(const Act& act) const {
    const auto strips = static_cast<int>(strips_.size());
    for (int odd = 0; odd < 2; ++odd)
        parallel_for(0, (strips + 1 - odd) / 2, 1, [&](int begin, int end) {
            for (int strip = begin; strip < end; ++strip)
                for (const Pair& pair : strips_[static_cast<std::size_t>(2 * strip + odd)]) act(pair);
        });
}

void Carving::apply(const Field& field, Field& applied) const {
    parallel_for(0, height_, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            apply_row(height_row(field, y, edges_.right, edges_.down), applied.row(y).data());
    });
}

// In the same order whatever the number of threads.
template <class Product>
double Carving::sum_over(const Product& product) const {
    std::vector<double> rows(static_cast<std::size_t>(height_));
    parallel_for(0, height_, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) rows[static_cast<std::size_t>(y)] = product(y);
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0);
}

// Residual and diagonal of the equations at the height as it is: the edges' and the pairs'.
void Carving::start_gradients() {
    const auto square = [](float v) { return v * v; };
    parallel_for(0, height_, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < width_; ++x) {
                direction_(x, y) = z_(x, y) - before_(x, y);
                float weights = 0;
                if (x > 0) weights += edges_.right(x - 1, y);
                if (x + 1 < width_) weights += edges_.right(x, y);
                if (y > 0) weights += edges_.down(x, y - 1);
                if (y + 1 < height_) weights += edges_.down(x, y);
                diagonal_(x, y) = weights;
            }
    });
    apply(direction_, residual_);
    for (float& r : residual_.pixels()) r = -r;
    for_pairs([&](const Pair& pair) {
        scatter(pair, pair.weight * (pair.want - rise_of(pair, z_)), residual_);
        float *above = &diagonal_.pixels()[static_cast<std::size_t>(pair.q.pixel)], *below = above + width_;
        above[0] += pair.weight * square((1 - pair.q.right) * (1 - pair.q.down));
        above[1] += pair.weight * square(pair.q.right * (1 - pair.q.down));
        below[0] += pair.weight * square((1 - pair.q.right) * pair.q.down);
        below[1] += pair.weight * square(pair.q.right * pair.q.down);
        diagonal_.pixels()[static_cast<std::size_t>(pair.p)] += pair.weight;
    });
}

// Goes along the direction; returns the square of the new residual.
double Carving::step(double along) {
    return sum_over([&](int y) {
        double sum = 0;
        for (int x = 0; x < width_; ++x) {
            z_(x, y) += static_cast<float>(along) * direction_(x, y);
            residual_(x, y) -= static_cast<float>(along) * applied_(x, y);
            sum += static_cast<double>(residual_(x, y) * preconditioned(x, y));
        }
        return sum;
    });
}

// The next direction: that of the residual, and so much of the one before.
void Carving::turn(double kept) {
    parallel_for(0, height_, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < width_; ++x)
                direction_(x, y) =
                    preconditioned(x, y) + static_cast<float>(kept) * (kept == 0 ? 0.0f : direction_(x, y));
    });
}

// Along the direction, to which the equations are applied.
double Carving::curvature() const {
    return sum_over([&](int y) {
        double sum = 0;
        for (int x = 0; x < width_; ++x) sum += static_cast<double>(direction_(x, y) * applied_(x, y));
        return sum;
    });
}

// Conjugate gradients (Hestenes & Stiefel 1952), preconditioned by the diagonal.
void Carving::improve(const std::function<void(double done)>& report) {
    start_gradients();
    double left = step(0);
    const double first = left;
    turn(0);
    for (int i = 0; i < kSteps && left > kSmall * first && left > 0; ++i) {
        report(i / double{kSteps});
        apply(direction_, applied_);
        for_pairs(
            [&](const Pair& pair) { scatter(pair, pair.weight * rise_of(pair, direction_), applied_); });
        const double curved = curvature();
        if (!(curved > 0)) break;
        const double now = step(left / curved);
        turn(now / left);
        left = now;
    }
}

}  // namespace

CarveReport carve_shadows(const LightVisibility& lights, const Lighting& lighting, const SlopeEdges& edges,
                          Surface& surface, const Progress& progress) {
    TP_REQUIRE(lights.height() == surface.height() && edges.right.region() == surface.height_mm.region(),
               "one size");
    CarveReport result;
    if (surface.width() < 2 || surface.height() < 2 || lights.empty()) return result;
    Carving carving(lights, lighting, edges, surface);
    result.contradicted = result.left = carving.find();
    result.lights = carving.lights();
    for (int round = 0; round < kRounds && result.left > 0; ++round) {
        const long before = result.left;
        carving.improve(
            [&](double done) { report(progress, "cast shadows", (round + done) / double{kRounds}); });
        result.left = carving.find();
        if (static_cast<double>(before - result.left) < kGains * static_cast<double>(before)) break;
    }
    report(progress, "cast shadows", 1);
    return result;
}

}  // namespace tangi
