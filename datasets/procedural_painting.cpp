#include "datasets/procedural_painting.h"

#include <glm/matrix.hpp>

#include "datasets/composition.h"
#include "datasets/damage.h"
#include "surface/base/parallel.h"
#include "surface/reflectance/anisotropy.h"

namespace tangi {

using namespace procedural;

namespace {

constexpr float kGroundMm = 0.06f;      // thickness of the ground over the threads
constexpr float kGroundFilling = 0.3f;  // part of the weave's relief that the ground levels
constexpr float kGildedFrom = 0.72f;    // [1] of the way from the centre to the border
constexpr float kLeafMm = 0.02f;        // bole and leaf, which level a part of the relief below
constexpr float kLeafFilling = 0.5f;
// [1] Colour of gold, linear Rec. 709, relative to red (from the optical constants of Johnson & Christy
// 1972).
constexpr Rgb kGold(1, 0.77f, 0.34f);

// Height of a plain weave above its mean plane [mm]. Warp thread i runs upwards at x = (i + 1/2) pitch, weft
// thread j across at y = (j + 1/2) pitch; at a crossing the warp is on top where i + j is even.
float weave_height(const PaintingOptions& options, float x_mm, float y_mm) {
    const float amplitude = static_cast<float>(options.weave_mm);
    if (amplitude <= 0) return 0;
    const float pitch = static_cast<float>(options.thread_pitch_mm);
    const float irregular = static_cast<float>(options.thread_irregularity);
    const Seed seed = hash(options.seed, 10);
    const float px = x_mm / pitch, py = y_mm / pitch;
    // Threads wander as one over many pitches, and each swells and thins along its way.
    const float u = px + irregular * 0.6f * noise(px / 14, py / 14, hash(seed, 1));
    const float v = py + irregular * 0.6f * noise(px / 14, py / 14, hash(seed, 2));
    const float i = std::floor(u), j = std::floor(v);
    const float across_warp = u - i - 0.5f, across_weft = v - j - 0.5f;  // [pitch] from the thread's middle
    const float warp_swell = 1 + irregular * 0.3f * noise(i * 7.31f, v / 6, hash(seed, 3));
    const float weft_swell = 1 + irregular * 0.3f * noise(u / 6, j * 7.31f, hash(seed, 4));
    const float pi = std::numbers::pi_v<float>;
    const float wave = 0.5f * std::sin(pi * u) * std::sin(pi * v);  // +-1/2 at the crossings
    const float warp = wave + 0.8f * warp_swell * (1 - 4 * across_warp * across_warp);
    const float weft = -wave + 0.8f * weft_swell * (1 - 4 * across_weft * across_weft);
    // A soft maximum, since fibres bridge the gap; 0.80 is the mean of the lattice.
    const float gap = std::abs(warp - weft);
    const float top = std::max(warp, weft) + (gap < 0.3f ? (0.3f - gap) * (0.3f - gap) / 1.2f : 0.0f);
    return amplitude * (top - 0.80f);
}

// How far a point lies in the gilded border: beyond it on the left or right, and above or below [mm].
struct Border {
    float beside_mm, above_mm;
    float inside_mm() const { return std::max(beside_mm, above_mm); }
};
Border border_at(const PaintingOptions& o, float x_mm, float y_mm) {
    const float width_mm = static_cast<float>(o.width * o.mm_per_pixel / 2),
                height_mm = static_cast<float>(o.height * o.mm_per_pixel / 2);
    return {std::abs(x_mm) - kGildedFrom * width_mm, std::abs(y_mm) - kGildedFrom * height_mm};
}

// Gold leaf on bole along the border. Its lobe has the colour of gold, and so has what it scatters widely.
void gild(const PaintingOptions& o, float level_mm, float x_mm, float y_mm, PaintSample& sample) {
    const float cover = smooth_step(0, 0.3f, border_at(o, x_mm, y_mm).inside_mm());
    if (cover <= 0) return;
    const Seed seed = hash(o.seed, 30);
    const float worn = 1 + 0.15f * noise(x_mm / 4, y_mm / 4, seed) + 0.05f * noise(2 * x_mm, 2 * y_mm, seed);
    sample.height_mm = mix(sample.height_mm, mix(sample.height_mm, level_mm, kLeafFilling) + kLeafMm, cover);
    sample.diffuse += cover * (worn * 0.1f * kGold - sample.diffuse);
    sample.specular = mix(sample.specular, 0.30f, cover);
    sample.roughness = mix(sample.roughness, 0.30f * worn, cover);
    sample.specular_colour += cover * (kGold - sample.specular_colour);
}

// The painting as a function of a point.
class Painter {
public:
    explicit Painter(const PaintingOptions& options) : Painter(options, compose(options, kGroundMm)) {}

    struct Point {
        PaintSample paint;
        DamageCover damage;
    };

    Point at(float x_mm, float y_mm) const {
        const float weave = weave_height(options_, x_mm, y_mm);
        const Seed seed = hash(options_.seed, 20);
        const float tone =
            1 + 0.12f * noise(3 * x_mm, 3 * y_mm, seed) + 0.10f * noise(x_mm / 5, y_mm / 5, seed);
        BareSupport bare;
        bare.canvas = {.height_mm = weave,
                       .diffuse = tone * Rgb(0.36f, 0.29f, 0.20f),
                       .specular = 0.02f,
                       .roughness = 0.6f};
        bare.ground = {.height_mm = (1 - kGroundFilling) * weave + kGroundMm +
                                    0.008f * fractal_noise(x_mm, y_mm, 3, hash(seed, 1)),
                       .diffuse = (0.7f + 0.3f * tone) * Rgb(0.66f, 0.60f, 0.49f),
                       .specular = 0.026f,
                       .roughness = 0.55f};
        Point point{.paint = bare.ground, .damage = {}};
        strokes_.apply_all(x_mm, y_mm, point.paint);
        if (options_.gilding) gild(options_, level_mm_, x_mm, y_mm, point.paint);
        point.damage = damage_.apply(x_mm, y_mm, bare, point.paint);
        return point;
    }

private:
    Painter(const PaintingOptions& options, std::vector<Stroke> strokes)
        : options_(options),
          level_mm_(strokes.empty() ? kGroundMm : strokes.back().level_mm),
          damage_(options, level_mm_, kGroundMm),
          strokes_(std::move(strokes), static_cast<float>(options.width * options.mm_per_pixel / 2),
                   static_cast<float>(options.height * options.mm_per_pixel / 2)) {}

    PaintingOptions options_;
    float level_mm_;  // mean height of the paint's surface
    Damage damage_;
    StrokeGrid strokes_;
};

// Samples the painting on a grid `supersampling` times as fine as the pixels.
class Sampler {
public:
    // Without a view, the painting as a whole, seen from straight above.
    Sampler(const PaintingOptions& options, const PaintingView* view)
        : o_(options),
          view_(view),
          n_(options.supersampling),
          width_(view ? view->width : o_.width),
          height_(view ? view->height : o_.height),
          painter_(options),
          truth_(width_, height_, view ? view->mm_per_pixel : o_.mm_per_pixel),
          fine_height_mm_(width_ * n_ + 2, height_ * n_ + 2) {
        if (view) centre_mm_ = mapped(view->to_mm, glm::dvec2(width_ - 1, height_ - 1) / 2.0);
        if (o_.gilding) truth_.specular_colour = Image<Rgb>(width_, height_);
        if (o_.gilding && o_.brushed > 0) truth_.lobe_axes = Image<LobeAxes>(width_, height_);
    }

    // Averages the samples in a row of pixels; keeps their heights.
    void sample_row(int y) {
        if (y == 0) sample_border_row(-1);
        if (y == height_ - 1) sample_border_row(height_ * n_);
        for (int j = y * n_; j < (y + 1) * n_; ++j) {
            fine(-1, j) = at(-1, j).paint.height_mm;
            fine(width_ * n_, j) = at(width_ * n_, j).paint.height_mm;
        }
        for (int x = 0; x < width_; ++x) sample_pixel(x, y);
    }

    // Mean over the pixel of the central differences of the samples, which telescope.
    void set_normals(int y) {
        const float two_pixels_mm = view_ ? 2.0f : static_cast<float>(2 * o_.mm_per_pixel);
        const int right = n_ - 1, bottom = n_ - 1;
        for (int x = 0; x < width_; ++x) {
            const int i = x * n_, j = y * n_;
            Slope sum;
            for (int k = 0; k < n_; ++k) {
                sum.x +=
                    fine(i + right + 1, j + k) + fine(i + right, j + k) - fine(i, j + k) - fine(i - 1, j + k);
                sum.y += fine(i + k, j - 1) + fine(i + k, j) - fine(i + k, j + bottom) -
                         fine(i + k, j + bottom + 1);
            }
            const float scale = 1 / (static_cast<float>(n_) * two_pixels_mm);
            const Slope slope{sum.x * scale, sum.y * scale};
            truth_.normal(x, y) = view_ ? seen_normal(slope, x, y) : normal_of(slope);
        }
    }

    // Heights, once they are no longer differenced, along the camera's axis.
    void see_heights(int y) {
        const glm::dvec3 axis = glm::transpose(view_->rotation)[2];
        for (int x = 0; x < width_; ++x) {
            const glm::dvec2 off = mapped(view_->to_mm, glm::dvec2(x, y)) - centre_mm_;
            float& z = truth_.height_mm(x, y);
            z = static_cast<float>(glm::dot(axis, glm::dvec3(off, static_cast<double>(z))));
        }
    }

    PaintingTruth& truth() { return truth_; }

private:
    glm::vec2 point_mm(int i, int j) const {
        if (view_) return glm::vec2(mapped(view_->to_mm, glm::dvec2(i + 0.5, j + 0.5) / double(n_) - 0.5));
        return {static_cast<float>(((i + 0.5) / n_ - o_.width / 2.0) * o_.mm_per_pixel),
                static_cast<float>((o_.height / 2.0 - (j + 0.5) / n_) * o_.mm_per_pixel)};
    }
    Painter::Point at(int i, int j) const {
        const glm::vec2 p = point_mm(i, j);
        return painter_.at(p.x, p.y);
    }

    // [unit vector, camera's frame] of a slope [mm a pixel] of the picture, y up: dz/dq = J^T dz/dp, with p
    // the point of the painting and J = dp/dq.
    Vec3 seen_normal(const Slope& slope, int x, int y) const {
        const auto along = [&](double dx, double dy) {
            return mapped(view_->to_mm, glm::dvec2(x + dx, y + dy)) -
                   mapped(view_->to_mm, glm::dvec2(x - dx, y - dy));
        };
        const glm::dmat2 jacobian(along(0.5, 0), along(0, -0.5));
        const glm::dvec2 gradient = glm::inverse(glm::transpose(jacobian)) * glm::dvec2(slope.x, slope.y);
        return Vec3(view_->rotation * glm::normalize(glm::dvec3(-gradient, 1)));
    }

    // Samples from (-1, -1) on: a border of one is needed for the slopes.
    float& fine(int i, int j) { return fine_height_mm_(i + 1, j + 1); }

    void sample_border_row(int j) {
        for (int i = -1; i <= width_ * n_; ++i) fine(i, j) = at(i, j).paint.height_mm;
    }

    void sample_pixel(int x, int y) {
        PaintSample sum{.height_mm = 0, .diffuse = Rgb(0), .specular = 0, .roughness = 0};
        Rgb coloured(0);  // specular in each channel
        DamageCover damage;
        for (int j = y * n_; j < (y + 1) * n_; ++j)
            for (int i = x * n_; i < (x + 1) * n_; ++i) {
                const Painter::Point point = at(i, j);
                fine(i, j) = point.paint.height_mm;
                sum.height_mm += point.paint.height_mm;
                sum.diffuse += point.paint.diffuse;
                sum.specular += point.paint.specular;
                sum.roughness += point.paint.roughness;
                coloured += point.paint.specular * point.paint.specular_colour;
                for (const auto kind : kDamageKinds) damage.*kind += point.damage.*kind;
            }
        const float part = 1 / static_cast<float>(n_ * n_);
        truth_.height_mm(x, y) = part * sum.height_mm;
        truth_.diffuse(x, y) = part * sum.diffuse;
        truth_.specular(x, y) = part * sum.specular;
        truth_.roughness(x, y) = part * sum.roughness;
        if (o_.gilding) truth_.specular_colour(x, y) = coloured / sum.specular;
        if (!truth_.lobe_axes.empty()) truth_.lobe_axes(x, y) = axes_at(x, y);
        const float loss = part * damage.loss, crack = part * damage.crack;
        truth_.loss(x, y) = loss >= 0.5f;
        truth_.craquelure(x, y) = crack >= 0.25f;
        truth_.varnish(x, y) = part * damage.varnish >= 0.5f;
        truth_.retouch(x, y) = part * damage.retouch >= 0.5f;
        truth_.abrasion(x, y) = part * damage.abrasion >= 0.5f;
        truth_.flaking(x, y) = part * damage.flaking >= 0.5f;
        truth_.stain(x, y) = part * damage.stain >= 0.5f;
        truth_.old_fill(x, y) = part * damage.old_fill >= 0.5f;
        truth_.overpaint(x, y) = part * damage.overpaint >= 0.5f;
        truth_.valid(x, y) = !(loss > 0.01f && loss < 0.99f) && crack < 0.01f;
    }

    // Grooves run along the border, so the lobe is wide across it; it is anisotropic as far as there is gold.
    LobeAxes axes_at(int x, int y) const {
        const float gold = (1 - truth_.specular_colour(x, y).b) / (1 - kGold.b);
        const glm::vec2 p = point_mm(x * n_ + n_ / 2, y * n_ + n_ / 2);
        const Border border = border_at(o_, p.x, p.y);
        const float stretch = static_cast<float>(o_.brushed) * std::clamp(gold, 0.0f, 1.0f);
        LobeAxes axes =
            axes_of({border.beside_mm > border.above_mm ? stretch : -stretch, 0}, truth_.roughness(x, y));
        if (!view_ || !(stretch > 0)) return axes;
        axes.tangent += static_cast<float>(std::atan2(view_->rotation[0].y, view_->rotation[0].x));
        return axes_of(stretch_of(axes, truth_.roughness(x, y)), truth_.roughness(x, y));
    }

    const PaintingOptions o_;
    const PaintingView* const view_;
    const int n_, width_, height_;
    const Painter painter_;
    glm::dvec2 centre_mm_{0};  // of the picture, on the painting
    PaintingTruth truth_;
    Image<float> fine_height_mm_;
};

PaintingTruth sampled(const PaintingOptions& options, const PaintingView* view, const Progress& progress) {
    validate(options);
    Sampler sampler(options, view);
    const int height = sampler.truth().height();
    constexpr int rows_at_once = 64;
    for (int y = 0; y < height; y += rows_at_once) {
        parallel_for(y, std::min(y + rows_at_once, height), 1, [&](int begin, int end) {
            for (int row = begin; row < end; ++row) sampler.sample_row(row);
        });
        report(progress, "painting", std::min(1.0, (y + rows_at_once) / static_cast<double>(height)));
    }
    parallel_for(0, height, 16, [&](int begin, int end) {
        for (int row = begin; row < end; ++row) {
            sampler.set_normals(row);
            if (view) sampler.see_heights(row);
        }
    });
    return std::move(sampler.truth());
}

}  // namespace

PaintingTruth::PaintingTruth(int width, int height, double mm)
    : height_mm(width, height),
      normal(width, height, Vec3(0, 0, 1)),
      diffuse(width, height, Rgb(1)),
      specular(width, height),
      roughness(width, height, 0.3f),
      loss(width, height),
      craquelure(width, height),
      varnish(width, height),
      retouch(width, height),
      abrasion(width, height),
      flaking(width, height),
      stain(width, height),
      old_fill(width, height),
      overpaint(width, height),
      valid(width, height, 1),
      mm_per_pixel(mm) {}

PaintingTruth procedural_painting(const PaintingOptions& options, const Progress& progress) {
    return sampled(options, nullptr, progress);
}

PaintingTruth procedural_painting(const PaintingOptions& options, const PaintingView& view,
                                  const Progress& progress) {
    return sampled(options, &view, progress);
}

Surface surface_of(const PaintingTruth& truth) {
    Surface surface;
    surface.height_mm = truth.height_mm;
    surface.normal = truth.normal;
    surface.diffuse = truth.diffuse;
    surface.specular = truth.specular;
    surface.roughness = truth.roughness;
    surface.specular_colour = truth.specular_colour;
    surface.lobe_axes = truth.lobe_axes;
    surface.confidence = Image<float>(truth.width(), truth.height());
    for (std::size_t i = 0; i < truth.valid.size(); ++i)
        surface.confidence.pixels()[i] = truth.valid.pixels()[i] ? 1.0f : 0.0f;
    surface.mm_per_pixel = truth.mm_per_pixel;
    surface.scale_known = true;
    return surface;
}

}  // namespace tangi
