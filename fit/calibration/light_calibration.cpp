#include "fit/calibration/light_calibration.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "fit/calibration/light_model_selection.h"

namespace tangi {

namespace {

constexpr LeftOutPhotos kHalfOfThem = {3, 6};
// Fewer photographs say nothing of a surface when one of them is left out.
constexpr int kFewestForRig = 5;
// Fewer don't tell what each light has of its own beside its strength (of 7 near lights, uneven beams made
// normals worse, 4.6 degrees instead of 3.2). Strengths are told by six: of 22 generated stacks with 6 to 11
// lights, all 10 whose lights were 1.4 to 2 times apart gained, 0.1 to 7 dB held out; the others stayed as
// they were, but for 2 that gained.
constexpr int kFewestForOwn = 12;
constexpr int kFiner = 4;              // pixels that the chosen model is solved with at last, by those before
constexpr std::size_t kMostNamed = 5;  // lights, in a warning
constexpr double kDoubtful_deg = 5;    // [deg] a correction that the user is told of
// A smooth correction is believed where lights turned by so many standard errors: less, and it takes up what
// the model leaves out (synth_canvas, whose directions are right: 2.6; leaf: 4.7).
constexpr double kSureTurns = 3;
// [dB] Likewise by strengths of their own: one unknown a light. They are looked at last, since lights of
// wrong direction seem to be of wrong strength.
constexpr double kGainsWorth_db = 0.75;
// Or so many pixels, where metal outweighs all others in a photograph (generated gold beside paint, lights
// twice apart: 0.82, 2.2 dB).
constexpr PixelWorth kGainsWorth{0.8, 1};
// [dB] Likewise by beams of their own, five unknowns a light, and then lights that no photograph had must not
// be predicted any worse (fresco lost 0.8 dB where 0.1 was let pass).
constexpr double kBeamsWorth_db = 1.5;
// Or so many pixels (generated reflectors: 0.98 to 0.99, 1.2 to 4.5 dB; fresco: 0.94, 0.7 dB).
constexpr PixelWorth kBeamsWorth{0.9, 1.5};
// Fewer photographs don't tell a light's direction from what the model leaves out: of 16 lights whose
// directions were right, some were "corrected" by 5 degrees.
constexpr std::size_t kFewestForDirections = 24;

// Root mean square over the lights of how far they turned, in standard errors.
double turns_in_sigmas(const LightCalibration& calibration) {
    double squares = 0, count = 0;
    for (const LightCalibration::Turn& turn : calibration.turns) {
        if (!(turn.sigma_deg > 0)) continue;
        squares += turn.changed_deg * turn.changed_deg / (turn.sigma_deg * turn.sigma_deg);
        ++count;
    }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

// The search for the lighting model: one freedom after the other, each tried beside the best so far.
class ModelSearch {
public:
    ModelSearch(const SurveyedStack& surveyed, const Lighting& given, const WardFitOptions& ward,
                const LightCalibrationOptions& options, const Progress& progress);

    // What all lights share, and their strengths.
    void try_lights();
    // Directions, smooth or of each light's own.
    void try_directions();
    // Smooth directions that hardly turn, and own ones that explain fewer pixels than strengths do.
    void drop_doubtful_directions();
    // Strengths where photographs do not predict each other better with them, but are explained better.
    void try_gains();
    void try_beams();
    // The best model once more, with more pixels.
    void solve_finer();
    LightCalibration found();

private:
    const TriedModel& best() const { return tried_[best_]; }
    void attempt(const std::vector<LightingModel>& models,
                 const std::optional<LightBundleAdjustment>& from = {});
    void attempt_own(const LightingModel& wanted, double explained_db, double loss_db,
                     const PixelWorth& of_pixels, const std::optional<LightBundleAdjustment>& from = {});
    void attempt_beams(const TriedModel& even);
    LightCalibration calibration_of(const TriedModel& one) const {
        return one.solution ? calibrated(sample_, *one.solution, given_, one.trial.model)
                            : LightCalibration{.lighting = given_};
    }
    int photos() const { return static_cast<int>(surveyed_.stack.photos.size()); }

    const SurveyedStack& surveyed_;
    const Lighting& given_;
    const WardFitOptions& ward_;
    const LightCalibrationOptions& options_;
    const Progress& progress_;
    // Few photographs tell what all lights share, fewer not each light's strength: one more unknown a
    // photograph.
    const bool few_, gains_;
    const bool measured_;  // directions have standard errors
    const bool refines_;   // directions, whatever validation photographs say
    const LeftOutPhotos out_;
    const LightSample sample_;
    std::mutex mutex_;
    int steps_done_ = 0;
    std::vector<TriedModel> tried_;
    std::size_t best_ = 0, listed_ = 0;  // in tried_: of all, and with directions as listed
};

ModelSearch::ModelSearch(const SurveyedStack& surveyed, const Lighting& given, const WardFitOptions& ward,
                         const LightCalibrationOptions& options, const Progress& progress)
    : surveyed_(surveyed),
      given_(given),
      ward_(ward),
      options_(options),
      progress_(progress),
      few_(photos() < std::max(kFewestForOwn, options.fewest_photos)),
      gains_(photos() >= options.fewest_photos),
      measured_(!given.direction_sigma_deg.empty()),
      refines_(!few_ && (options.refine_directions || measured_)),
      out_(few_ ? LeftOutPhotos{photos(), photos()} : kHalfOfThem),
      sample_(surveyed, ward, options.samples) {}

void ModelSearch::attempt(const std::vector<LightingModel>& models,
                          const std::optional<LightBundleAdjustment>& from) {
    const int steps = (few_ ? 3 : 8) * (1 + out_.trials);  // at most
    const auto step_done = [&] {
        const std::lock_guard lock(mutex_);
        report(progress_, "lights", ++steps_done_ / static_cast<double>(steps));
    };
    for (TriedModel& one : tried(sample_, given_, models, out_, step_done, from)) {
        tried_.push_back(std::move(one));
        if (!tried_.back().solution && tried_.size() > 1) {
            tried_.pop_back();
            continue;
        }
        const LightCalibration::Trial &now = tried_.back().trial, &best_yet = best().trial;
        // Beams have more to show than a better prediction: attempt_own().
        if (now.model.beams == best_yet.model.beams && is_better(now, best_yet, options_.min_gain_db))
            best_ = tried_.size() - 1;
    }
}

// Whether a model that gives each light more of its own is to be taken: tried where it has not been.
void ModelSearch::attempt_own(const LightingModel& wanted, double explained_db, double loss_db,
                              const PixelWorth& of_pixels, const std::optional<LightBundleAdjustment>& from) {
    const auto is_wanted = [&](const TriedModel& one) { return one.trial.model == wanted; };
    const std::size_t before = best_;
    if (std::none_of(tried_.begin(), tried_.end(), is_wanted)) attempt({wanted}, from);
    const auto found = std::find_if(tried_.begin(), tried_.end(), is_wanted);
    if (best_ == before && found != tried_.end() &&
        explains_better(found->trial, best().trial, explained_db, loss_db, of_pixels))
        best_ = static_cast<std::size_t>(found - tried_.begin());
}

void ModelSearch::attempt_beams(const TriedModel& even) {
    LightingModel uneven = even.trial.model;
    uneven.beams = true;
    attempt_own(uneven, kBeamsWorth_db, 0, kBeamsWorth, std::optional(even.solution));
}

void ModelSearch::try_lights() {
    std::vector<LightingModel> models = {{LightFreedom::none}, {LightFreedom::rig}};
    if (gains_) models.push_back({LightFreedom::rig_and_gains});
    attempt(models);
    listed_ = best_;
}

// A light that was left out has no part in directions of each light's own: with few photographs leaving some
// out says nothing of them, and it is up to the user.
void ModelSearch::try_directions() {
    const LightFreedom lights = best().trial.model.lights;
    const DirectionFreedom refined = measured_ ? DirectionFreedom::measured : DirectionFreedom::own;
    if (refines_)
        attempt({{lights, refined}});
    else if (!few_ && surveyed_.stack.photos.size() >= kFewestForDirections)
        attempt({{lights, DirectionFreedom::smooth}, {lights, DirectionFreedom::own}});
    if (refines_ && tried_.back().trial.model.directions == refined) best_ = tried_.size() - 1;
}

void ModelSearch::drop_doubtful_directions() {
    if (best().trial.model.directions == DirectionFreedom::smooth &&
        turns_in_sigmas(calibration_of(best())) < kSureTurns)
        best_ = listed_;
    // Lights of other strength seem to stand elsewhere, too: what explains more of the pixels is it.
    const auto strengths = std::find_if(tried_.begin(), tried_.end(), [](const TriedModel& one) {
        return one.trial.model == LightingModel{LightFreedom::rig_and_gains};
    });
    if (best().trial.model.directions == DirectionFreedom::own && !refines_ && strengths != tried_.end() &&
        strengths->trial.pixels.part_better_than(best().trial.pixels) > kMostPixels)
        best_ = listed_;
}

void ModelSearch::try_gains() {
    if (!gains_ || tried_[listed_].trial.model.lights == LightFreedom::rig_and_gains) return;
    LightingModel wanted = best().trial.model;
    wanted.lights = LightFreedom::rig_and_gains;
    attempt_own(wanted, kGainsWorth_db, options_.min_gain_db, kGainsWorth);
}

// Lights that are aimed otherwise seem to stand elsewhere, and the other way round: beams are also tried with
// the directions as listed.
void ModelSearch::try_beams() {
    if (few_) return;
    const TriedModel even = best(), as_listed = tried_[listed_];
    attempt_beams(even);
    if (!refines_ && even.trial.model.directions != DirectionFreedom::listed) attempt_beams(as_listed);
}

void ModelSearch::solve_finer() {
    TriedModel& chosen = tried_[best_];
    if (!chosen.solution) return;
    const LightSample fine(surveyed_, ward_, kFiner * options_.samples);
    if (fine.size() > sample_.size())
        chosen.solution = solved_finer(fine, *chosen.solution, given_, chosen.trial.model);
}

LightCalibration ModelSearch::found() {
    LightCalibration result = calibration_of(best());
    for (TriedModel& one : tried_) result.trials.push_back(std::move(one.trial));
    return result;
}

}  // namespace

std::string name_of(const LightingModel& model) {
    constexpr std::array lights = {"as given", "rig", "rig and gains"};
    constexpr std::array directions = {"", ", smooth directions", ", own directions",
                                       ", measured directions"};
    return fmt::format("{}{}{}", lights[static_cast<std::size_t>(model.lights)],
                       directions[static_cast<std::size_t>(model.directions)],
                       model.beams ? ", uneven beams" : "");
}

std::string warning_of(const LightCalibration& calibration, const std::string& folder) {
    std::vector<std::size_t> turned;  // the farthest first
    for (std::size_t i = 0; i < calibration.turns.size(); ++i)
        if (calibration.turns[i].changed_deg > kDoubtful_deg) turned.push_back(i);
    if (turned.empty()) return {};
    std::ranges::stable_sort(turned, std::greater(),
                             [&](std::size_t i) { return calibration.turns[i].changed_deg; });
    std::string names;
    for (const std::size_t i : std::span(turned).first(std::min(turned.size(), kMostNamed)))
        names += fmt::format("{}{} by {:.1f} ± {:.1f}", names.empty() ? "" : ", ",
                             calibration.lighting.lights[i].name, calibration.turns[i].changed_deg,
                             calibration.turns[i].sigma_deg);
    if (turned.size() > kMostNamed) names += fmt::format(" and {} more", turned.size() - kMostNamed);
    return fmt::format(
        "{}: the photographs contradict the listed directions of {} of {} lights by more than {} degrees: "
        "{}; corrected, --lights-as-given keeps them",
        folder, turned.size(), calibration.turns.size(), kDoubtful_deg, names);
}

Vec3 corrected_direction(const LightCalibration& calibration, const Vec3& listed) {
    if (calibration.coefficients.empty()) return listed;
    const glm::dvec3 direction(listed);
    return Vec3(turned(direction, calibration.field.turn(calibration.coefficients, direction)));
}

nlohmann::json to_json(const LightCalibration& calibration) {
    using nlohmann::json;
    const Rig& rig = calibration.lighting.rig;
    const auto distance = [](const std::optional<float>& mm) { return mm ? json(*mm) : json(nullptr); };
    json trials = json::object(), gains = json::object(), turns = json::object(), sigmas = json::object(),
         beams = json::object();
    for (std::size_t i = 0; i < calibration.gain_sigma.size(); ++i)
        sigmas[calibration.lighting.lights[i].name] = calibration.gain_sigma[i];
    // A relative error of a distance, in mm.
    const auto error = [](const std::optional<float>& mm, double relative) {
        return mm && relative > 0 ? json(*mm * relative) : json(nullptr);
    };
    for (const LightCalibration::Trial& trial : calibration.trials)
        trials[name_of(trial.model)] = trial.cv_psnr_db;
    if (calibration.light_model)
        for (const Light& light : calibration.lighting.lights) gains[light.name] = light.gain.g;
    for (std::size_t i = 0; i < calibration.turns.size(); ++i)
        turns[calibration.lighting.lights[i].name] = {{"changed_deg", calibration.turns[i].changed_deg},
                                                      {"sigma_deg", calibration.turns[i].sigma_deg}};
    for (std::size_t i = 0; i < calibration.unevenness.size(); ++i)
        beams[calibration.lighting.lights[i].name] = {{"terms", calibration.lighting.lights[i].beam.terms},
                                                      {"rms", calibration.unevenness[i].rms},
                                                      {"sigma", calibration.unevenness[i].sigma}};
    return {{"calibrated", name_of(calibration.model)},
            {"cv_psnr_db", trials},
            {"ambient", rig.ambient},
            {"light_distance_mm", distance(rig.light_distance_mm)},
            {"surface_above_mm", rig.surface_above_mm},
            {"camera_distance_mm", distance(rig.camera_distance_mm)},
            {"bend_per_mm", rig.bend_per_mm},
            {"diffuse_roughness",
             calibration.diffuse_roughness ? json(*calibration.diffuse_roughness) : json(nullptr)},
            {"sigma",
             {{"ambient",
               calibration.rig_sigma.ambient > 0 ? json(calibration.rig_sigma.ambient) : json(nullptr)},
              {"diffuse_roughness",
               calibration.diffuse_roughness ? json(calibration.rig_sigma.diffuse_roughness) : json(nullptr)},
              {"light_distance_mm", error(rig.light_distance_mm, calibration.rig_sigma.light_distance)},
              {"surface_above_mm", calibration.rig_sigma.surface_above_mm > 0
                                       ? json(calibration.rig_sigma.surface_above_mm)
                                       : json(nullptr)},
              {"camera_distance_mm", error(rig.camera_distance_mm, calibration.rig_sigma.camera_distance)},
              {"gains", sigmas}}},
            {"gains", gains},
            {"beams", beams},
            {"directions", turns}};
}

LightCalibration calibrate_lights(const SurveyedStack& surveyed, const Lighting& given,
                                  const WardFitOptions& ward, const LightCalibrationOptions& options,
                                  const Progress& progress) {
    validate(options);
    if (surveyed.stack.photos.size() < kFewestForRig) return {.lighting = given};
    ModelSearch search(surveyed, given, ward, options, progress);
    search.try_lights();
    search.try_directions();
    search.drop_doubtful_directions();
    search.try_gains();
    search.try_beams();
    search.solve_finer();
    return search.found();
}

}  // namespace tangi
