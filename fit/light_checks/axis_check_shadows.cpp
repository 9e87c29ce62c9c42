#include "fit/light_checks/axis_check_shadows.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fit/height/height.h"
#include "surface/base/loop_pieces.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"
#include "surface/render/cast_shadows.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

constexpr double kLeastShadowCertainty = 6;  // [standard errors]
constexpr double kLeastContrast = -0.1;  // ln: shadows that hide nearly all of a light take off 10 % and more
constexpr float kHighest = 0.75f;        // [1] z of lights that are looked at: below 49 degrees
constexpr float kLeastCosine = 0.1f;   // [1] n·l: beyond, small errors of the normal are large ones of light
constexpr double kDarkAsNoise = 0.02;  // [1] of the white level: noise
constexpr double kLeastLog = -2, kMostLog = 0.7;  // ln(measured / predicted) beyond tells no more
constexpr float kHidden = 0.2f, kSeen = 0.8f;     // [1] visible part of the light
constexpr int kLeastHidden = 12;                  // samples in shadow that a photograph must have
constexpr std::size_t kLeastPhotos = 4;
constexpr double kTolerance = 1e-3;  // HeightOptions::tolerance: what is left are long waves

// A sample that a light should shine on: where it is, and how much less it does. In linear light, without
// that from all around.
struct Lit {
    int x = 0, y = 0;
    Vec3 direction{};  // of the light, from there
    double measured = 0, predicted = 0;
    double log_ratio = 0;  // of both, above noise
};

// Of one photograph.
std::vector<Lit> lit_by(const Surface& s, const LitSurvey& samples, std::size_t photo) {
    const Survey& survey = samples.survey;
    const Light& light = samples.lighting.lights[photo];
    const double white_level = samples.lighting.white_level;
    std::vector<Lit> lit;
    const auto channels = static_cast<std::size_t>(survey.channels), green = channels / 2;
    const double dark = kDarkAsNoise * white_level;
    for (int k = 0; k < survey.sample_count(); ++k) {
        end_piece();
        const glm::ivec2 at = survey.positions[static_cast<std::size_t>(k)];
        const float stored = survey.sample(k)[photo * channels + green];
        if (!(s.confidence(at.x, at.y) > 0) || !std::isfinite(stored)) continue;
        const Incidence in = incidence(light, s.point_mm(at.x, at.y), s.photography.rig);
        const float cosine = glm::dot(s.normal(at.x, at.y), in.direction);
        if (cosine < kLeastCosine) continue;
        const double predicted =
            white_level * static_cast<double>(s.diffuse(at.x, at.y).g * cosine * in.irradiance.g);
        if (predicted < 3 * dark) continue;
        const double around = predicted * static_cast<double>(s.photography.rig.ambient / cosine);
        const double measured = std::max(static_cast<double>(samples.transfer.decode(stored)) - around, 0.0);
        lit.push_back({at.x, at.y, in.direction, measured, predicted,
                       std::clamp(std::log((measured + dark) / (predicted + dark)), kLeastLog, kMostLog)});
    }
    return lit;
}

using Bend = Eigen::Matrix<double, 6, 1>;

// Of a pixel: what bends are made of, with x and y from -1 to 1.
Bend bend_terms(const Image<float>& height_mm, int x, int y) {
    const double u = 2.0 * x / height_mm.width() - 1, v = 2.0 * y / height_mm.height() - 1;
    Bend terms;
    terms << 1, u, v, u * u, u * v, v * v;
    return terms;
}

// The relief without its bend as a whole (a polynomial of the second degree), which lights that are nearer,
// or lower, than they are taken for make as well: a bowl hides lights all over that a dome, with hills for
// valleys, does not.
Image<float> without_bend(const Image<float>& height_mm, const Image<float>& confidence) {
    constexpr int most = 1000000;
    const int step = 1 + static_cast<int>(std::sqrt(height_mm.size() / most));
    Eigen::Matrix<double, 6, 6> normal = 1e-9 * Eigen::Matrix<double, 6, 6>::Identity();
    Bend right = Bend::Zero();
    for (int y = 0; y < height_mm.height(); y += step)
        for (int x = 0; x < height_mm.width(); x += step) {
            if (!(confidence(x, y) > 0)) continue;
            const Bend terms = bend_terms(height_mm, x, y);
            normal += terms * terms.transpose();
            right += static_cast<double>(height_mm(x, y)) * terms;
        }
    const Bend bend = solve_symmetric(normal, right).x;
    Image<float> relief = height_mm;
    parallel_for(0, relief.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < relief.width(); ++x)
                relief(x, y) -= static_cast<float>(bend.dot(bend_terms(relief, x, y)));
    });
    return relief;
}

// By how much darker a photograph is where a height hides the light than where it does not: ln; NaN where it
// hides it from too few samples.
struct Contrast {
    double log_ratio = std::numeric_limits<double>::quiet_NaN();
    double hidden = 0;  // samples in shadow
};

// One a photograph.
std::vector<Contrast> contrasts(const Image<float>& height_mm, double mm_per_pixel, const LightTurn& turn,
                                const std::vector<std::vector<Lit>>& lit, const std::vector<Light>& lights) {
    const CastShadows shadows(height_mm, mm_per_pixel, Rig::kPointLight_deg);
    std::vector<Contrast> result(lights.size());
    parallel_for(0, static_cast<int>(lights.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            Vec3 direction = lights[i].direction;
            if (direction.z > kHighest) continue;
            const glm::dvec2 turned = turn.applied({direction.x, direction.y});
            direction = Vec3(glm::vec2(turned), direction.z);
            double hidden = 0, seen = 0;
            int in_shadow = 0, in_light = 0;
            for (const Lit& sample : lit[i]) {
                end_piece();
                const float part = shadows.visible_part(sample.x, sample.y, direction);
                if (part < kHidden) hidden += sample.log_ratio, ++in_shadow;
                if (part > kSeen) seen += sample.log_ratio, ++in_light;
            }
            if (in_shadow >= kLeastHidden && in_light >= kLeastHidden)
                result[i] = {hidden / in_shadow - seen / in_light, static_cast<double>(in_shadow)};
        }
    });
    return result;
}

void mirror(Image<float>& height_mm) {
    for (float& h : height_mm.pixels()) h = -h;
}

// The turn that undoes a turn.
LightTurn inverse(const LightTurn& turn) {
    return {turn.mirrored, turn.mirrored ? turn.turn_deg : 360 - turn.turn_deg};
}

void turn_all(const LightTurn& turn, Image<Vec3>& normal) {
    for (Vec3& n : normal.pixels()) n = Vec3(glm::vec2(turn.applied({n.x, n.y})), n.z);
}

void integrate(Surface& s, const Progress& progress) {
    HeightOptions options;
    options.tolerance = std::max(options.tolerance, kTolerance);
    integrate_normals({s.normal, s.confidence, s.mm_per_pixel}, s.height_mm, options,
                      Progress([&](std::string_view, double done) {
                          return !progress || progress("axes of the lights", done);
                      }));
    subtract(best_plane(s.height_mm, s.confidence), s.height_mm);
}

}  // namespace

bool ShadowCheck::certain() const { return certainty > kLeastShadowCertainty && contrast < kLeastContrast; }

ShadowCheck check_shadows(Surface& surface, const SignCheck& signs, const LitSurvey& samples,
                          const Progress& progress) {
    const std::vector<Light>& lights = samples.lighting.lights;
    TP_REQUIRE(samples.survey.photos.size() == lights.size(), "one light a photograph");
    const LightTurn one = signs.remedy(), other = one.opposite();
    std::vector<std::vector<Lit>> lit;
    for (std::size_t i = 0; i < lights.size(); ++i) lit.push_back(lit_by(surface, samples, i));
    if (signs.wrong()) {  // in place: maps of large pictures take much memory
        turn_all(one, surface.normal);
        integrate(surface, progress);
        turn_all(inverse(one), surface.normal);
    }
    Image<float> relief = without_bend(surface.height_mm, surface.confidence);
    const std::vector<Contrast> of_one = contrasts(relief, surface.mm_per_pixel, one, lit, lights);
    mirror(relief);
    const std::vector<Contrast> of_other = contrasts(relief, surface.mm_per_pixel, other, lit, lights);
    // Means over photographs; the more samples are in shadow, the less is a photograph's contrast noise.
    std::size_t photos = 0;
    double weights = 0, with_one = 0, with_other = 0;
    const auto weight_of = [&](std::size_t i) {
        const bool both = !std::isnan(of_one[i].log_ratio) && !std::isnan(of_other[i].log_ratio);
        return both ? 1 / (1 / of_one[i].hidden + 1 / of_other[i].hidden) : 0;
    };
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (const double weight = weight_of(i); weight > 0) {
            ++photos, weights += weight;
            with_one += weight * of_one[i].log_ratio, with_other += weight * of_other[i].log_ratio;
        }
    if (photos < kLeastPhotos) return {one, 0, 0};
    with_one /= weights, with_other /= weights;
    const double mean = with_one - with_other, n = static_cast<double>(photos);
    double squares = 0;
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (const double weight = weight_of(i); weight > 0) {
            const double off = weight * (of_one[i].log_ratio - of_other[i].log_ratio - mean);
            squares += off * off;
        }
    const double error = std::max(std::sqrt(squares * n / (n - 1)) / weights, 1e-6);
    return mean <= 0 ? ShadowCheck{one, -mean / error, with_one}
                     : ShadowCheck{other, mean / error, with_other};
}

double shadow_misfit(const Surface& surface, const LitSurvey& samples, double light_radius_deg) {
    const std::size_t photos = samples.lighting.lights.size();
    const double white_level = samples.lighting.white_level;
    TP_REQUIRE(samples.survey.photos.size() == photos, "one light a photograph");
    const CastShadows shadows(surface.height_mm, surface.mm_per_pixel, light_radius_deg);
    std::vector<double> squares(photos), counts(photos);
    parallel_for(0, static_cast<int>(photos), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            for (const Lit& sample : lit_by(surface, samples, i)) {
                end_piece();
                // Gloss is brighter than any light that is seen whole.
                const double shown = std::min(sample.measured, sample.predicted);
                const auto visible =
                    static_cast<double>(shadows.visible_part(sample.x, sample.y, sample.direction));
                const double off =
                    (shown - visible * sample.predicted) / (sample.predicted + kDarkAsNoise * white_level);
                squares[i] += off * off;
                ++counts[i];
            }
    });
    const double n = std::accumulate(counts.begin(), counts.end(), 0.0);
    return n > 0 ? std::accumulate(squares.begin(), squares.end(), 0.0) / n : 0;
}

}  // namespace tangi
