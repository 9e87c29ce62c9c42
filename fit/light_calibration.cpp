#include "fit/light_calibration.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "fit/joint_lights.h"
#include "surface/median.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr std::array kFreedoms = {LightFreedom::none, LightFreedom::rig, LightFreedom::rig_and_gains};
constexpr int kFolds = 3;     // trials of each freedom ...
constexpr int kFoldStep = 6;  // ... with every sixth photograph left out
constexpr double kModelError = 0.03;
constexpr double kFar = 0.01;   // [1/width] nearness from which on a distance says something
constexpr double kBestDb = 60;  // a photograph predicted to a thousandth is predicted

// A stack's sample of pixels, and how it is fitted and predicted under some lighting.
class Sample {
public:
    Sample(const Stack& stack, const Survey& survey, const Transfer& transfer, const NoiseModel& noise,
           double mm_per_pixel, const WardFitOptions& ward, int wanted)
        : survey_(survey), transfer_(transfer), noise_(noise), ward_(ward) {
        width_mm_ = std::max(stack.width(), stack.height()) * mm_per_pixel;
        const int step = std::max(1, survey.sample_count() / wanted);
        for (int k = 0; k < survey.sample_count(); k += step) {
            chosen_.push_back(k);
            const glm::dvec2 centred(
                survey.positions[static_cast<std::size_t>(k)].x - (stack.width() - 1) / 2.0,
                (stack.height() - 1) / 2.0 - survey.positions[static_cast<std::size_t>(k)].y);
            points_mm_.emplace_back(Vec3(centred * mm_per_pixel, 0));
        }
    }

    int size() const { return static_cast<int>(chosen_.size()); }
    double width_mm() const { return width_mm_; }
    const Vec3& point_mm(int k) const { return points_mm_[static_cast<std::size_t>(k)]; }

    // Samples of pixel k in these photographs; the lighting has one light for each of them.
    void gather(int k, const std::vector<int>& photos, const Lighting& lighting, PixelSamples& s) const {
        illuminate(lighting, point_mm(k), survey_.channels, s);
        std::size_t at = 0;
        for (const int photo : photos) {
            const float* stored = this->stored(k, photo);
            for (int c = 0; c < survey_.channels; ++c, ++at) {
                const float value = transfer_.decode(stored[c]);
                s.value[at] = value;
                // Outside a registered photograph there is nothing, which decodes as black.
                s.sigma[at] = std::isnan(stored[c]) ? 0 : noise_.sigma(value);
            }
        }
    }

    std::vector<WardEstimate> fit(const std::vector<int>& photos, const Lighting& lighting) const {
        std::vector<WardEstimate> estimates(static_cast<std::size_t>(size()));
        oneapi::tbb::enumerable_thread_specific<WardFitter> fitters([&] { return WardFitter(ward_); });
        parallel_for(0, size(), 8, [&](int begin, int end) {
            PixelSamples samples;
            for (int k = begin; k < end; ++k) {
                gather(k, photos, lighting, samples);
                estimates[static_cast<std::size_t>(k)] = fitters.local().fit(samples);
            }
        });
        return estimates;
    }

    // [dB] PSNR of one photograph, predicted under this light; a matt white that faces it is the peak.
    double psnr_db(const std::vector<WardEstimate>& estimates, int photo, const Lighting& lighting) const {
        const double white = transfer_.encode(static_cast<float>(lighting.white_level));
        const float clipped = transfer_.encode(noise_.clipped());
        double squares = 0;
        long count = 0;
        PixelSamples s;
        for (int k = 0; k < size(); ++k) {
            const WardEstimate& e = estimates[static_cast<std::size_t>(k)];
            if (!e.valid) continue;
            illuminate(lighting, point_mm(k), survey_.channels, s);
            const double theta[kWardCommon] = {e.slope.x, e.slope.y, std::log(e.roughness), e.specular};
            const WardTerms t = ward_terms(theta, s.light[0], s.view);
            const float* stored = this->stored(k, photo);
            if (std::isnan(stored[0])) continue;  // outside a registered photograph
            for (int c = 0; c < survey_.channels; ++c, ++count) {
                const double linear = s.irradiance[static_cast<std::size_t>(c)] *
                                      (e.diffuse[c] * (t.n_l + s.ambient[0]) + e.specular * t.lobe);
                const float shown = transfer_.encode(std::min(static_cast<float>(linear), noise_.clipped()));
                squares += std::pow((shown - std::min(stored[c], clipped)) / white, 2);
            }
        }
        if (count == 0 || squares <= 0) return kBestDb;
        return std::min(-10 * std::log10(squares / static_cast<double>(count)), kBestDb);
    }

    // The joint problem of these photographs, started from estimates of the pixels. Clipped samples are left
    // out.
    JointLights joint_problem(const std::vector<int>& photos, const Lighting& lighting) const {
        JointLights joint;
        describe(lighting, joint);
        const std::vector<WardEstimate> estimates = fit(photos, lighting);
        for (int k = 0; k < size(); ++k) {
            const WardEstimate& e = estimates[static_cast<std::size_t>(k)];
            if (!e.valid) continue;
            double diffuse = 0;
            for (int c = 0; c < survey_.channels; ++c) diffuse += e.diffuse[c] / survey_.channels;
            const int pixel = static_cast<int>(joint.pixels.size());
            joint.pixels.push_back({.position = glm::dvec2(point_mm(k)) / width_mm_,
                                    .sample = k,
                                    .slope = e.slope,
                                    .ln_alpha = std::log(e.roughness),
                                    .specular = std::max(e.specular, 0.002),
                                    .diffuse = diffuse});
            samples_of(k, photos, lighting, pixel, joint);
        }
        return joint;
    }

    // The same with some photographs only, started from the solution with all of them.
    JointLights joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                              const JointLights& solved) const {
        JointLights joint;
        joint.pixels = solved.pixels;
        describe(lighting, joint);
        joint.rig = solved.rig;
        for (std::size_t i = 0; i < photos.size(); ++i)
            joint.log_gains[i] = solved.log_gains[static_cast<std::size_t>(photos[i])];
        for (std::size_t pixel = 0; pixel < joint.pixels.size(); ++pixel)
            samples_of(joint.pixels[pixel].sample, photos, lighting, static_cast<int>(pixel), joint);
        return joint;
    }

private:
    const float* stored(int k, int photo) const {
        return survey_.sample(chosen_[static_cast<std::size_t>(k)]) +
               static_cast<std::ptrdiff_t>(photo) * survey_.channels;
    }

    // What is given of the lamps and the camera.
    void describe(const Lighting& lighting, JointLights& joint) const {
        joint.lamps_known = !lighting.lights.empty() &&
                            std::all_of(lighting.lights.begin(), lighting.lights.end(),
                                        [](const Light& light) { return light.position_mm.has_value(); });
        for (const Light& light : lighting.lights) {
            joint.directions.emplace_back(light.direction);
            joint.nearer.push_back(joint.lamps_known ? width_mm_ / glm::length(*light.position_mm) : 1);
            joint.log_gains.push_back(0);
        }
        if (joint.lamps_known) joint.rig.lamp_nearness = 1;
        if (lighting.rig.camera_distance_mm) {
            joint.camera_known = true;
            joint.rig.camera_nearness = width_mm_ / *lighting.rig.camera_distance_mm;
            joint.camera_axis = glm::dvec2(lighting.rig.camera_axis_mm) / width_mm_;
        }
    }

    void samples_of(int k, const std::vector<int>& photos, const Lighting& lighting, int pixel,
                    JointLights& joint) const {
        PixelSamples s;
        gather(k, photos, lighting, s);
        for (int i = 0; i < s.photos(); ++i) {
            const Rgb& gain = lighting.lights[static_cast<std::size_t>(i)].gain;
            add_observation(s, i, lighting.white_level * glm::dvec3(gain), pixel, joint);
        }
    }

    // `white` [1]: linear value of a matt white in the origin that faces the lamp.
    static void add_observation(const PixelSamples& s, int photo, const glm::dvec3& white, int pixel,
                                JointLights& joint) {
        double value = 0, variance = 0, irradiance = 0;
        for (int c = 0; c < s.channels; ++c) {
            const auto at = static_cast<std::size_t>(photo * s.channels + c);
            if (!(s.sigma[at] > 0)) return;
            value += s.value[at] / s.channels;
            irradiance += white[c] / s.channels;
            variance += s.sigma[at] * s.sigma[at] / s.channels;  // JPEG's noise is shared by the channels
        }
        const JointLights::Pixel& p = joint.pixels[static_cast<std::size_t>(pixel)];
        const glm::dvec3& l = s.light[static_cast<std::size_t>(photo)];
        const double n_l = std::max(l.z - p.slope.x * l.x - p.slope.y * l.y, 0.0) /
                           std::sqrt(1 + glm::dot(p.slope, p.slope));
        const double model_error = kModelError * std::max(p.diffuse * n_l, value / irradiance);
        joint.observations.push_back(
            {pixel, photo, value / irradiance, std::hypot(std::sqrt(variance) / irradiance, model_error)});
    }

    const Survey& survey_;
    Transfer transfer_;
    const NoiseModel& noise_;
    WardFitOptions ward_;
    double width_mm_ = 1;
    std::vector<int> chosen_;  // of the survey's samples
    std::vector<Vec3> points_mm_;
};

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

Lighting subset(const Lighting& lighting, const std::vector<int>& photos) {
    Lighting result{{}, lighting.rig, lighting.white_level};
    for (const int i : photos) result.lights.push_back(lighting.lights[static_cast<std::size_t>(i)]);
    return result;
}

// The lighting that a solved joint problem means.
LightCalibration calibration_of(const Sample& sample, const JointLights& joint, const Lighting& given,
                                LightFreedom freedom) {
    LightCalibration result{.lighting = given, .freedom = freedom, .trials = {}};
    Rig& rig = result.lighting.rig;
    const auto distance = [&](double nearness) {
        return nearness > kFar ? std::optional(static_cast<float>(sample.width_mm() / nearness))
                               : std::nullopt;
    };
    rig.ambient = static_cast<float>(joint.rig.ambient);
    if (!joint.lamps_known) {
        rig.lamp_distance_mm = distance(joint.rig.lamp_nearness);
        rig.bend_per_mm = static_cast<float>(joint.rig.bend / sample.width_mm());
    }
    if (!joint.camera_known) rig.camera_distance_mm = distance(joint.rig.camera_nearness);
    const double middle = median(joint.log_gains);
    for (std::size_t i = 0; i < joint.log_gains.size(); ++i) {
        Light& light = result.lighting.lights[i];
        light.gain *= static_cast<float>(std::exp(joint.log_gains[i] - middle));
        if (rig.lamp_distance_mm) light.position_mm = light.direction * *rig.lamp_distance_mm;
    }
    // One lamp that was carried around is as strong elsewhere as it was given.
    if (freedom == LightFreedom::rig_and_gains && !joint.lamps_known)
        result.lamps = fit_lamp_model(result.lighting.lights);
    return result;
}

// The joint problem of all photographs, solved with one freedom; nothing where there is nothing to solve.
std::optional<JointLights> solved(const Sample& sample, const std::vector<int>& photos, const Lighting& given,
                                  LightFreedom freedom) {
    if (freedom == LightFreedom::none) return {};
    JointLights joint = sample.joint_problem(photos, given);
    if (joint.pixels.empty() || !joint.solve(freedom == LightFreedom::rig_and_gains, JointStart::far))
        return {};
    return joint;
}

// [dB] PSNR of the photographs of one fold, predicted from all others. `all` is the solution with all
// photographs: where to start, so that the fold's own solution is a few steps away.
std::vector<double> left_out_db(const Sample& sample, const Lighting& given, LightFreedom freedom,
                                const std::optional<JointLights>& all, int fold) {
    std::vector<int> used, left_out;
    for (int i = 0; i < static_cast<int>(given.lights.size()); ++i)
        (i % kFoldStep == kFoldStep / kFolds * fold ? left_out : used).push_back(i);
    LightCalibration c{.lighting = subset(given, used), .trials = {}};
    if (all) {
        JointLights joint = sample.joint_problem(used, c.lighting, *all);
        if (joint.solve(freedom == LightFreedom::rig_and_gains, JointStart::near))
            c = calibration_of(sample, joint, c.lighting, freedom);
    }
    const std::vector<WardEstimate> estimates = sample.fit(used, c.lighting);
    std::vector<double> db;
    for (const int i : left_out) {
        Lighting one = subset(given, {i});
        one.rig = c.lighting.rig;
        Light& light = one.lights.front();
        if (c.lamps)
            light.gain *= static_cast<float>(predicted_gain(*c.lamps, c.lighting.lights, light.direction));
        if (one.rig.lamp_distance_mm) light.position_mm = light.direction * *one.rig.lamp_distance_mm;
        db.push_back(sample.psnr_db(estimates, i, one));
    }
    return db;
}

using Solutions = std::array<std::optional<JointLights>, kFreedoms.size()>;

std::vector<LightCalibration::Trial> tried(const Sample& sample, const Lighting& given,
                                           const Solutions& solutions,
                                           const std::function<void()>& step_done) {
    std::array<std::array<std::vector<double>, kFolds>, kFreedoms.size()> db;
    parallel_for(0, kFolds * static_cast<int>(kFreedoms.size()), 1, [&](int begin, int end) {
        for (int task = begin; task < end; ++task) {
            const auto freedom = static_cast<std::size_t>(task / kFolds);
            const int fold = task % kFolds;
            db[freedom][static_cast<std::size_t>(fold)] =
                left_out_db(sample, given, kFreedoms[freedom], solutions[freedom], fold);
            step_done();
        }
    });
    std::vector<LightCalibration::Trial> trials;
    for (std::size_t i = 0; i < kFreedoms.size(); ++i) {
        trials.push_back({kFreedoms[i], 0, {}});
        for (const std::vector<double>& fold : db[i])
            trials.back().photos_db.insert(trials.back().photos_db.end(), fold.begin(), fold.end());
        trials.back().left_out_db = mean(trials.back().photos_db);
    }
    return trials;
}

// [dB] By how much `a` predicts the same photographs better than `b` at least, as far as that many
// photographs can tell: the median, as one photograph whose lamp moved is no reason for or against, less its
// standard error (that of a median of normal values; their spread by the median absolute deviation).
double surely_gained_db(const LightCalibration::Trial& a, const LightCalibration::Trial& b) {
    std::vector<double> gained;
    for (std::size_t i = 0; i < a.photos_db.size(); ++i) gained.push_back(a.photos_db[i] - b.photos_db[i]);
    const double middle = median(gained), count = static_cast<double>(gained.size());
    for (double& db : gained) db = std::abs(db - middle);
    return middle - 1.2533 * 1.4826 * median(std::move(gained)) / std::sqrt(count);
}

std::vector<int> all_of(const Stack& stack) {
    std::vector<int> all(stack.photos.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

}  // namespace

std::string_view name_of(LightFreedom freedom) {
    switch (freedom) {
        case LightFreedom::none:
            return "as given";
        case LightFreedom::rig:
            return "rig";
        case LightFreedom::rig_and_gains:
            break;
    }
    return "rig and gains";
}

nlohmann::json to_json(const LightCalibration& calibration) {
    using nlohmann::json;
    const Rig& rig = calibration.lighting.rig;
    const auto distance = [](const std::optional<float>& mm) { return mm ? json(*mm) : json(nullptr); };
    json trials = json::object(), gains = json::object();
    for (const LightCalibration::Trial& trial : calibration.trials)
        trials[std::string(name_of(trial.freedom))] = trial.left_out_db;
    if (calibration.lamps)
        for (const Light& light : calibration.lighting.lights) gains[light.name] = light.gain.g;
    return {{"calibrated", name_of(calibration.freedom)},
            {"left_out_db", trials},
            {"ambient", rig.ambient},
            {"lamp_distance_mm", distance(rig.lamp_distance_mm)},
            {"camera_distance_mm", distance(rig.camera_distance_mm)},
            {"bend_per_mm", rig.bend_per_mm},
            {"gains", gains}};
}

LightCalibration calibrate_lights(const Stack& stack, const Survey& survey, const Transfer& transfer,
                                  const NoiseModel& noise, const Lighting& given, double mm_per_pixel,
                                  const WardFitOptions& ward, const LightCalibrationOptions& options,
                                  const Progress& progress) {
    validate(options);
    if (static_cast<int>(stack.photos.size()) < options.fewest_photos)
        return {.lighting = given, .trials = {}};
    const Sample sample(stack, survey, transfer, noise, mm_per_pixel, ward, options.samples);
    std::mutex mutex;
    int done = 0;
    constexpr int kSteps = static_cast<int>(kFreedoms.size()) * (1 + kFolds);
    const auto step_done = [&] {
        const std::lock_guard lock(mutex);
        report(progress, "lights", ++done / static_cast<double>(kSteps));
    };
    Solutions solutions;
    parallel_for(0, static_cast<int>(kFreedoms.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto freedom = static_cast<std::size_t>(i);
            solutions[freedom] = solved(sample, all_of(stack), given, kFreedoms[freedom]);
            step_done();
        }
    });
    std::vector<LightCalibration::Trial> trials = tried(sample, given, solutions, step_done);
    std::size_t best = 0;
    for (std::size_t i = 1; i < trials.size(); ++i)
        if (surely_gained_db(trials[i], trials[best]) > options.worth_db) best = i;
    LightCalibration result{.lighting = given, .trials = {}};
    if (solutions[best]) result = calibration_of(sample, *solutions[best], given, kFreedoms[best]);
    result.trials = std::move(trials);
    return result;
}

}  // namespace tangi
