#include "fit/calibration/light_calibration.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "fit/calibration/light_model_selection.h"
#include "fit/calibration/light_residual.h"

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
// Fewer photographs don't tell a light's direction from what the model leaves out: of 16 generated ones, four
// with light of the room had their lights turned instead.
constexpr int kFewestForDirections = 24;
constexpr int kFiner = 4;              // pixels that the chosen model is solved with at last, by those before
constexpr std::size_t kMostNamed = 5;  // lights, in a warning
constexpr double kDoubtful_deg = 5;    // [deg] a correction that the user is told of

// [1] How many numbers the photographs of so many lights have to tell.
int unknowns(const LightingModel& model, int lights) {
    int count = 0;
    if (model.lights != LightFreedom::none) count += kJointRig;
    if (model.lights == LightFreedom::rig_and_gains) count += lights;
    if (model.directions != DirectionFreedom::listed) count += static_cast<int>(DirectionField::kPolynomials);
    if (model.directions == DirectionFreedom::own || model.directions == DirectionFreedom::measured)
        count += kJointTurn * lights;
    if (model.beams) count += kJointBeam * lights;
    return count;
}

// The search for the lighting model: one freedom after the other, each tried beside the best so far.
class ModelSearch {
public:
    ModelSearch(const SurveyedStack& surveyed, const Lighting& given, const WardFitOptions& ward,
                const LightCalibrationOptions& options, const Progress& progress);

    // What all lights share, and their strengths.
    void try_lights();
    // Directions, smooth or of each light's own, with strengths and, as either stands in for the other,
    // without.
    void try_directions();
    // Lights that are aimed otherwise seem to stand elsewhere, and the other way round: beams are tried with
    // the directions that are found and with those listed.
    void try_beams();
    // The best model once more, with more pixels.
    void solve_finer();
    LightCalibration found();

private:
    const TriedModel& best() const { return tried_[best_]; }
    // Tries these and takes the best of all so far; of those that have directions as wanted, once there are.
    void attempt(const std::vector<LightingModel>& models,
                 const std::optional<LightBundleAdjustment>& from = {});
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
    // The directions of each light's own, whatever validation photographs say.
    const std::optional<DirectionFreedom> refined_;
    const LeftOutPhotos out_;
    const LightSample sample_;
    std::mutex mutex_;
    int steps_done_ = 0;
    std::vector<TriedModel> tried_;
    // In tried_: of all, with directions as listed, and of lights that are alike besides.
    std::size_t best_ = 0, listed_ = 0, alike_ = 0;
};

// Where directions have standard errors, or the user says so.
std::optional<DirectionFreedom> refined_directions(const Lighting& given, bool asked) {
    if (!given.direction_sigma_deg.empty()) return DirectionFreedom::measured;
    return asked ? std::optional(DirectionFreedom::own) : std::nullopt;
}

ModelSearch::ModelSearch(const SurveyedStack& surveyed, const Lighting& given, const WardFitOptions& ward,
                         const LightCalibrationOptions& options, const Progress& progress)
    : surveyed_(surveyed),
      given_(given),
      ward_(ward),
      options_(options),
      progress_(progress),
      few_(photos() < std::max(kFewestForOwn, options.fewest_photos)),
      gains_(photos() >= options.fewest_photos),
      refined_(few_ ? std::nullopt : refined_directions(given, options.refine_directions)),
      out_(few_ ? LeftOutPhotos{photos(), photos()} : kHalfOfThem),
      sample_(surveyed, ward, options.samples, options.flat) {}

void ModelSearch::attempt(const std::vector<LightingModel>& models,
                          const std::optional<LightBundleAdjustment>& from) {
    const int steps = (few_ ? 3 : 9) * (1 + out_.trials);  // at most
    const auto step_done = [&] {
        const std::lock_guard lock(mutex_);
        report(progress_, "lights", ++steps_done_ / static_cast<double>(steps));
    };
    for (TriedModel& one : tried(sample_, given_, models, out_, step_done, from))
        if (one.solution || tried_.empty()) tried_.push_back(std::move(one));
    const auto model = [&](std::size_t i) -> const LightingModel& { return tried_[i].trial.model; };
    const auto unwanted = [&](std::size_t i) { return refined_ && model(i).directions != *refined_; };
    std::vector<std::size_t> order(tried_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!std::ranges::all_of(order, unwanted)) std::erase_if(order, unwanted);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return unknowns(model(i), photos()); });
    std::vector<const ValidationScores*> from_simplest;
    for (const std::size_t i : order) from_simplest.push_back(&tried_[i].trial.scores);
    best_ = order[select_model(from_simplest)];
}

void ModelSearch::try_lights() {
    attempt({{LightFreedom::none}, {LightFreedom::rig}});
    alike_ = best_;
    if (gains_) attempt({{LightFreedom::rig_and_gains}});
    listed_ = best_;
}

void ModelSearch::try_directions() {
    if (few_ || (!refined_ && photos() < kFewestForDirections)) return;
    std::vector<LightingModel> models;
    for (const std::size_t even : {alike_, listed_})
        for (const DirectionFreedom directions :
             refined_ ? std::vector{*refined_} : std::vector{DirectionFreedom::smooth, DirectionFreedom::own})
            if (even == alike_ || listed_ != alike_)
                models.push_back({tried_[even].trial.model.lights, directions});
    attempt(models);
}

void ModelSearch::try_beams() {
    if (few_) return;
    const TriedModel even = best(), as_listed = tried_[listed_];
    const auto uneven = [&](const TriedModel& one) {
        LightingModel model = one.trial.model;
        if (model.lights == LightFreedom::none) model.lights = LightFreedom::rig;
        model.beams = true;
        attempt({model}, one.solution);
    };
    uneven(even);
    if (!refined_ && even.trial.model != as_listed.trial.model) uneven(as_listed);
}

void ModelSearch::solve_finer() {
    TriedModel& chosen = tried_[best_];
    if (!chosen.solution) return;
    const LightSample fine(surveyed_, ward_, kFiner * options_.samples, options_.flat);
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
    search.try_beams();
    search.solve_finer();
    return search.found();
}

}  // namespace tangi
