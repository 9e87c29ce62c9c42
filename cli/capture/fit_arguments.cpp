#include "cli/capture/fit_arguments.h"

#include <algorithm>
#include <optional>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace {

// Reads values of JSON over the defaults of options, but those that were typed.
class Taker {
public:
    Taker(const std::string& painting, const nlohmann::json& values, const std::vector<std::string>& typed)
        : painting_(painting), values_(values), typed_(typed) {}

    template <class T>
    void operator()(std::string_view name, T& value) const {
        std::string flag = "--" + std::string(name);
        std::ranges::replace(flag, '_', '-');
        if (std::ranges::count(typed_, flag)) return;
        const auto found = values_.find(name);
        if (found == values_.end() || found->is_null()) return;
        try {
            if constexpr (is_optional<T>::value)
                value = found->get<typename T::value_type>();
            else
                value = found->get<T>();
        } catch (const nlohmann::json::exception&) {
            fail("{}: its option {} is of another kind; give {} yourself", painting_, name, flag);
        }
    }

    template <class Options>
    void fields(Options& options) const {
        Options::fields(options, [&](const FieldInfo& info, auto& value) { (*this)(info.name, value); });
        validate(options);
    }

    // The same of what a painting has under another name, as {} where it has nothing.
    Taker below(const char* name) const {
        static const nlohmann::json none = nlohmann::json::object();
        const auto found = values_.find(name);
        return {painting_, found != values_.end() && found->is_object() ? *found : none, typed_};
    }
    bool has(const char* name) const { return values_.contains(name); }

private:
    const std::string& painting_;
    const nlohmann::json& values_;
    const std::vector<std::string>& typed_;
};

void take_photos(const Taker& take, PhotosArguments& photos) {
    take("lights_mm", photos.lights_mm);
    take("light_axes", photos.light_axes);
    take("light_rotation_deg", photos.light_rotation_deg);
    take("transfer", photos.transfer);
    take("crop", photos.crop);
    take("hold_out", photos.hold_out);
    take("register", photos.registration);
    take("raw_demosaic", photos.develop.demosaic);
    take("raw_colour", photos.develop.raw_colour);
    // Of files, those that the new folder finds by the same path.
    const auto take_file = [&](const char* name, std::string& value) {
        std::string kept = value;
        take(name, kept);
        if (kept == value || kept.empty()) return;
        const auto path = std::filesystem::path(photos.folder) / kept;
        value = std::filesystem::exists(path) ? path.string() : kept;
    };
    take_file("lights", photos.lights);
    take_file("capture", photos.capture);
    take_file("mask", photos.mask);
    take_file("dark", photos.develop.dark);
    take_file("flat", photos.develop.flat);
    take_file("ambient", photos.develop.ambient);
    take_file("brackets", photos.develop.brackets);
}

}  // namespace

void FitArguments::add_to(Flags& flags) {
    photos.add_to(flags, true);
    flags.option("--out", out,
                 "the painting to write (.exr, or .tangi, a folder, of one larger than memory)");
    flags.option("--plan", plan,
                 "fit in steps, of pictures of any size and on any number of machines: without --tiles and "
                 "--finish, write what is found of all photographs (.json, with .maps beside it)");
    flags.option(
        "--tiles", tiles,
        "fit these tiles of the --plan, those that are not there yet: all, 7, 0-15, or 3,8-11; whole "
        "rows of them read the photographs once");
    flags.flag("--finish", finish, "make the painting --out of the tiles of the --plan, once all are there");
    flags.option("--report", report, "also write a page on how the photographs were understood (.html)");
    flags.option("--like", like,
                 "fit with the options that this painting was fitted with; flags that are given count more");
    flags
        .option("--solver", solver,
                "batch: many pixels at once, checked and polished by Ceres; ceres: Ceres alone, some fifty "
                "times slower a pixel")
        .check(one_of({"batch", "ceres"}));
    flags
        .option("--shape", shape,
                "flat: the object is, as a whole, as a painting is, which tells lights apart from slopes; "
                "relief: it is round, bulges or is all slopes (a vessel, a carving, a statue), and the "
                "photographs alone say how")
        .check(one_of({"flat", "relief"}));
    flags.fields(options);
    flags.fields(options.calibration);
    flags.fields(options.ward);
    flags.fields(options.height);
    flags.flag("--residual", with_residual,
               "store what the photographs show beyond the surface, for relight; where not said, if it "
               "predicts photographs better that are left out");
    flags.fields(residual_options);
}

nlohmann::json FitArguments::as_json() const {
    nlohmann::json json = to_json(options);
    json["light_calibration"] = to_json(options.calibration);
    json["ward"] = to_json(options.ward);
    json["height"] = to_json(options.height);
    json["solver"] = solver;
    json["shape"] = shape;
    if (looks_for_residual()) json["residual"] = to_json(residual_options);
    json["photos"] = photos.as_json();
    return json;
}

void FitArguments::take_from_painting(const std::vector<std::string>& typed) {
    const nlohmann::json provenance = json_or_discarded(read_painting(like).provenance);
    const bool is_fit = provenance.is_object() && provenance.value("command", nlohmann::json()) == "fit" &&
                        provenance.contains("options") && provenance["options"].is_object();
    if (!is_fit) fail("--like {}: was not made by fit, or does not say how; give the options", like);
    take("--like " + like, provenance["options"], typed);
}

void FitArguments::take_from_plan(const nlohmann::json& values) { take(plan, values, {}); }

void FitArguments::take(const std::string& from, const nlohmann::json& values,
                        const std::vector<std::string>& typed) {
    const Taker take(from, values, typed);
    take.fields(options);
    take.below("light_calibration").fields(options.calibration);
    take.below("ward").fields(options.ward);
    take.below("height").fields(options.height);
    take("solver", solver);
    take("shape", shape);
    if (!with_residual && !take.has("residual")) with_residual = false;
    take.below("residual").fields(residual_options);
    take_photos(take.below("photos"), photos);
}

FitOptions FitArguments::options_of_fit() const {
    FitOptions wanted = options;
    wanted.solver = solver == "ceres" ? Solver::ceres : Solver::batch;
    wanted.calibration.flat = shape == "flat";
    wanted.register_photos = photos.registration != "off";
    return wanted;
}

}  // namespace tangi
