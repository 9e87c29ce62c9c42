// fit_arguments.h: what `fit` is told: its flags, as provenance keeps them, and from there again (--like).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "fit/pipeline/fit_painting.h"
#include "fit/residual/residual_fit.h"

namespace tangi {

struct FitArguments {
    PhotosArguments photos;
    std::string out, report, like, solver = "batch", shape = "flat";
    std::string plan, tiles;  // of a fit in steps (fit_steps.h)
    bool finish = false;
    FitOptions options;
    std::optional<bool> with_residual;  // where not said, if it predicts better
    ResidualOptions residual_options;

    // A preview has none, nor are its photographs there to be compared with.
    bool looks_for_residual() const { return with_residual.value_or(!options.preview); }

    void add_to(Flags& flags);
    // Paths relative to the photographs' folder.
    nlohmann::json as_json() const;
    // What the painting `like` was fitted with, but for flags that were `typed`. Throws Error naming the
    // painting: it was not fitted, or holds an option of another kind.
    void take_from_painting(const std::vector<std::string>& typed);
    // The same of a plan, of whose options none is typed. `options`: as as_json() makes them.
    void take_from_plan(const nlohmann::json& options);
    FitOptions options_of_fit() const;

private:
    void take(const std::string& from, const nlohmann::json& values, const std::vector<std::string>& typed);
};

}  // namespace tangi
