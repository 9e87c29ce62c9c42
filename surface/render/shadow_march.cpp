#include "surface/render/shadow_march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/vector_targets.h"  // before Highway

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/render/shadow_march.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float kStraight = 1e-6f;  // [1] length of a direction's x and y below which nothing is in the way
constexpr float kHalfPixel = 0.5f;
constexpr float kPoint = 1e-6f;  // [pixels] radius of a point

// From pixels side by side to their lights, and how much of them is covered so far.
template <class D>
class March {
    using V = hn::Vec<D>;
    using M = hn::Mask<D>;
    using Ints = hn::RebindToSigned<D>;

public:
    // Lane i: pixel (x + i, y); the least and the greatest step of all lanes bound what they look at.
    HWY_INLINE March(const ShadowScene& scene, int x, int y, const MarchLights& lights, std::uint32_t which)
        : scene_(scene), x_(x), y_(y), first_level_(std::min(kFinestUseful, last_level())) {
        const V infinite = hn::Set(d_, std::numeric_limits<float>::infinity());
        const V lx = hn::LoadU(d_, lights.x), ly = hn::LoadU(d_, lights.y);
        const float* row = scene.height_mm + index(0, y);
        if (x + kLanes <= scene.width)
            z0_ = hn::LoadU(d_, row + x);
        else
            z0_ = hn::GatherIndex(d_, row, hn::Min(hn::Iota(Ints(), x), hn::Set(Ints(), scene.width - 1)));
        cosine_ = hn::Sqrt(hn::Add(hn::Mul(lx, lx), hn::Mul(ly, ly)));
        sine_ = hn::LoadU(d_, lights.z);
        const auto bits = hn::Shl(hn::Set(Ints(), 1), hn::Iota(Ints(), 0));
        const M asked = hn::RebindMask(d_, hn::TestBit(hn::Set(Ints(), static_cast<int>(which)), bits));
        const M there =
            hn::Lt(hn::Iota(d_, static_cast<float>(x)), hn::Set(d_, static_cast<float>(scene.width)));
        live_ = hn::And(hn::And(asked, there),
                        hn::And(hn::Ge(cosine_, hn::Set(d_, kStraight)), hn::Eq(z0_, z0_)));
        const auto least = [&](V v) HWY_ATTR {
            return hn::GetLane(hn::MinOfLanes(d_, hn::IfThenElse(live_, v, infinite)));
        };
        dx_ = hn::Div(lx, cosine_), dy_ = hn::Neg(hn::Div(ly, cosine_));
        left_ = least(dx_), right_ = -least(hn::Neg(dx_));
        top_ = least(dy_), bottom_ = -least(hn::Neg(dy_));
        if (hn::AllFalse(d_, live_)) left_ = right_ = top_ = bottom_ = 0;
        dx_ = hn::IfThenElse(live_, dx_, hn::Set(d_, left_));
        dy_ = hn::IfThenElse(live_, dy_, hn::Set(d_, top_));
        find_widths();
        is(hn::Set(d_, -1));
    }

    HWY_INLINE V run() {
        const V highest = rise_of(hn::Set(d_, scene_.highest_mm));
        int level = first_level_;
        for (float t = 1;;) {
            const M behind = hn::Ge(per_step_, hn::Zero(d_));  // so is all that is farther away
            live_ = hn::And(live_, hn::Lt(covered_, hn::Set(d_, 1)));
            live_ = hn::AndNot(hn::And(behind, hides_no_more(highest, t)), hn::And(live_, inside(t)));
            if (hn::AllFalse(d_, live_)) return covered_;
            while (level < last_level() && reach(level, t) < kSteps) ++level;
            if (const int skip = reach(level, t);
                skip >= kSteps && hn::AllTrue(d_, hn::Or(hn::Not(live_), behind))) {
                const V around = rise_of(hn::Set(d_, highest_around(level, t)));
                if (hn::AllTrue(d_, hn::Or(hn::Not(live_), hides_no_more(around, t)))) {
                    t += static_cast<float>(skip);
                    level = std::min(level + 1, last_level());
                    continue;
                }
                if (level > first_level_ && reach(level - 1, t) >= kSteps) {
                    --level;
                    continue;
                }
            }
            for (int step = 0; step < kSteps; ++step, t += 1) meet(t);
        }
    }

private:
    static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
    static constexpr int kSteps = 1 << kFinestBlock;
    static constexpr int kFinestUseful = kLanes >= 8 ? 2 : kLanes > 1 ? 1 : 0;  // level: see reach()

    int last_level() const { return static_cast<int>(scene_.levels.size()) - 1; }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(scene_.width) +
               static_cast<std::size_t>(x);
    }
    HWY_INLINE V rise_of(V height_mm) const {
        return hn::Div(hn::Sub(height_mm, z0_), hn::Set(d_, scene_.mm_per_pixel));
    }

    HWY_INLINE V column_of(float t) const {
        return hn::Add(hn::Iota(d_, static_cast<float>(x_)), hn::Mul(hn::Set(d_, t), dx_));
    }
    HWY_INLINE V row_of(float t) const {
        return hn::Add(hn::Set(d_, static_cast<float>(y_)), hn::Mul(hn::Set(d_, t), dy_));
    }
    HWY_INLINE M inside(float t) const {
        const V x = column_of(t), y = row_of(t), zero = hn::Zero(d_);
        const V right = hn::Set(d_, static_cast<float>(scene_.width - 1)),
                bottom = hn::Set(d_, static_cast<float>(scene_.height - 1));
        return hn::And(hn::And(hn::Ge(x, zero), hn::Ge(y, zero)),
                       hn::And(hn::Le(x, right), hn::Le(y, bottom)));
    }

    // [pixels] Rise over the pixels of what lies t pixels away, bilinear; of some pixel where none lies
    // there.
    HWY_INLINE V rise(float t) const {
        const float left = std::floor(t < 0 ? t * right_ : t * left_),
                    right = std::floor(t < 0 ? t * left_ : t * right_),
                    top = std::floor(t < 0 ? t * bottom_ : t * top_),
                    bottom = std::floor(t < 0 ? t * top_ : t * bottom_);
        const int x = x_ + static_cast<int>(left), y = y_ + static_cast<int>(top);
        // Lanes that go the same way look at pixels that lie side by side.
        if (left == right && top == bottom && x >= 0 && y >= 0 && x + kLanes < scene_.width &&
            y + 1 < scene_.height) {
            const float *above = scene_.height_mm + index(x, y), *below = above + scene_.width;
            const V fx = hn::Sub(hn::Mul(hn::Set(d_, t), dx_), hn::Set(d_, left)),
                    fy = hn::Sub(hn::Mul(hn::Set(d_, t), dy_), hn::Set(d_, top));
            return rise_of(between(hn::LoadU(d_, above), hn::LoadU(d_, above + 1), hn::LoadU(d_, below),
                                   hn::LoadU(d_, below + 1), fx, fy));
        }
        const V px = column_of(t), py = row_of(t);
        const auto whole = [&](V at, int pixels) HWY_ATTR {
            return hn::Min(hn::Max(hn::ConvertTo(Ints(), at), hn::Zero(Ints())), hn::Set(Ints(), pixels - 2));
        };
        const auto ix = whole(px, scene_.width), iy = whole(py, scene_.height);
        const V fx = hn::Sub(px, hn::ConvertTo(d_, ix)), fy = hn::Sub(py, hn::ConvertTo(d_, iy));
        const auto at = hn::Add(hn::Mul(iy, hn::Set(Ints(), scene_.width)), ix);
        const float *above = scene_.height_mm, *below = above + scene_.width;
        return rise_of(between(hn::GatherIndex(d_, above, at), hn::GatherIndex(d_, above + 1, at),
                               hn::GatherIndex(d_, below, at), hn::GatherIndex(d_, below + 1, at), fx, fy));
    }
    HWY_INLINE V between(V a, V b, V c, V d, V fx, V fy) const {
        const V top = hn::Add(a, hn::Mul(fx, hn::Sub(b, a))), bottom = hn::Add(c, hn::Mul(fx, hn::Sub(d, c)));
        return hn::Add(top, hn::Mul(fy, hn::Sub(bottom, top)));
    }

    // Steps of which nothing is higher than highest_around(), for all lanes: its block and the neighbours
    // reach that many pixels from the lane in the middle.
    HWY_INLINE int reach(int level, float t) const {
        const float apart = t * std::max(right_ - left_, bottom_ - top_);
        return (1 << (kFinestBlock + level)) - kLanes / 2 - static_cast<int>(std::ceil(apart));
    }
    HWY_INLINE float highest_around(int level, float t) const {
        const int x = x_ + kLanes / 2 + static_cast<int>(std::floor(t * left_)),
                  y = y_ + static_cast<int>(std::floor(t * top_)), shift = kFinestBlock + level;
        const ShadowScene::Level& blocks = scene_.levels[static_cast<std::size_t>(level)];
        const int column = std::clamp(x, 0, scene_.width - 1) >> shift,
                  row = std::clamp(y, 0, scene_.height - 1) >> shift;
        return blocks.highest_mm[static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks.width) +
                                 static_cast<std::size_t>(column)];
    }

    // [pixels] Halves of w on the pixel's side towards the light, and on the other.
    HWY_INLINE void find_widths() {
        const M ahead = inside(1), back = inside(-1);
        const V zero = hn::Zero(d_);
        before_ = hn::IfThenElseZero(ahead, half_width(rise(1)));
        behind_ = hn::IfThenElse(back, half_width(hn::Neg(rise(-1))), before_);
        behind_ = hn::IfThenElse(ahead, behind_, zero);
    }
    HWY_INLINE V half_width(V slope) const {
        const V w = hn::Sub(sine_, hn::Mul(slope, cosine_));
        return hn::IfThenElseZero(hn::Gt(w, hn::Zero(d_)), hn::Mul(w, hn::Set(d_, kHalfPixel)));  // NaN: 0
    }

    // Relief of this rise, t pixels away, hides no more than is hidden.
    HWY_INLINE M hides_no_more(V rise, float t) const {
        const V away = hn::Set(d_, t), along = hn::Add(hn::Mul(rise, sine_), hn::Mul(away, cosine_));
        return hn::And(hn::Ge(along, hn::Zero(d_)),
                       hn::Le(hn::Mul(rise, per_rise_), hn::Sub(hn::Mul(away, per_step_), lag_)));
    }

    HWY_INLINE void meet(float t) {
        const V r = rise(t), away = hn::Set(d_, t), zero = hn::Zero(d_);
        const M more = hn::AndNot(hides_no_more(r, t), hn::And(live_, inside(t)));
        if (hn::AllFalse(d_, more)) return;
        const V along = hn::Add(hn::Mul(r, sine_), hn::Mul(away, cosine_));
        const V far = hn::Mul(hn::Set(d_, scene_.tangent), hn::Max(along, zero));
        const V above = hn::Sub(hn::Mul(r, cosine_), hn::Mul(away, sine_));
        const V width = hn::IfThenElse(hn::Lt(above, zero), before_, behind_);
        const V radius = hn::Sqrt(hn::Add(hn::Mul(far, far), hn::Mul(width, width)));
        const V now = hn::Div(above, hn::Max(radius, hn::Set(d_, kPoint)));
        is(hn::IfThenElse(hn::And(more, hn::Gt(now, covered_)), now, covered_));
    }

    // p > c sqrt((q tan)^2 + (w / 2)^2) needs p > c q tan where c > 0, and p > c (q tan + w / 2) where not:
    // with p and q by rise and t, both are linear.
    HWY_INLINE void is(V covered) {
        covered_ = covered;
        const V lean = hn::Mul(covered, hn::Set(d_, scene_.tangent));
        per_rise_ = hn::Sub(cosine_, hn::Mul(lean, sine_));
        per_step_ = hn::Add(sine_, hn::Mul(lean, cosine_));
        lag_ = hn::Mul(hn::Max(hn::Neg(covered), hn::Zero(d_)), before_);
    }

    const D d_{};
    const ShadowScene& scene_;
    int x_, y_, first_level_;
    float left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  // [pixels] least and greatest dx and dy
    V dx_, dy_, z0_, cosine_, sine_, before_, behind_, covered_, per_rise_, per_step_, lag_;
    M live_;
};

void MarchLanes(const ShadowScene& scene, int x, int y, const MarchLights& lights, std::uint32_t which,
                float* covered) {
    using Floats = hn::CappedTag<float, kMarchLanes>;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(Floats()));
    for (int at = 0; at < kMarchLanes && x + at < scene.width; at += lanes) {
        std::uint32_t some = which >> at;
        if (lanes < 32) some &= (std::uint32_t{1} << lanes) - 1;
        if (some == 0) continue;
        alignas(64) float result[lanes];
        hn::Store(March<Floats>(scene, x + at, y, {lights.x + at, lights.y + at, lights.z + at}, some).run(),
                  Floats(), result);
        for (int i = 0; i < lanes; ++i)
            if ((some >> i & 1) && x + at + i < scene.width) covered[at + i] = result[i];
    }
}

float MarchOne(const ShadowScene& scene, int x, int y, float light_x, float light_y, float light_z) {
    using Floats = hn::CappedTag<float, 1>;
    return hn::GetLane(March<Floats>(scene, x, y, {&light_x, &light_y, &light_z}, 1).run());
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tangi {

HWY_EXPORT(MarchLanes);
HWY_EXPORT(MarchOne);

void march_lanes(const ShadowScene& scene, int x, int y, const MarchLights& lights, std::uint32_t which,
                 float* covered) {
    HWY_DYNAMIC_DISPATCH(MarchLanes)(scene, x, y, lights, which, covered);
}

float march_one(const ShadowScene& scene, int x, int y, float light_x, float light_y, float light_z) {
    return HWY_DYNAMIC_DISPATCH(MarchOne)(scene, x, y, light_x, light_y, light_z);
}

}  // namespace tangi
#endif
