// fit_output.h: what `fit` makes of its arguments before the work, and of a fit after it; the same for a fit
// in one go and in steps.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "capture/radiometry/develop_stack.h"
#include "cli/capture/fit_arguments.h"
#include "fit/pipeline/fit_plan.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_output.h"

namespace tangi {

// Photographs as they are read.
struct FitInput {
    UsableStack opened;
    DevelopReport development;
    nlohmann::json provenance;
    std::size_t told_before = 0;  // warnings
};

// Opens and develops the photographs. Throws Error where the output would replace one of them.
FitInput open_for_fit(FitArguments& arguments, const std::filesystem::path& output, const Progress& progress);

// What the command writes, put in place together.
struct FitFiles {
    explicit FitFiles(const FitArguments& arguments);
    PaintingOutput painting;
    std::optional<AtomicFile> page;
};

void require_sound(const FitArguments& arguments);

// Looks for the residual, judges the fit, writes it. Returns the result. `stack`: the photographs as they
// were opened; `doubts`: what makes it poor that a plan knew.
nlohmann::json write_fit(const FitArguments& arguments, FitInput& input, FitResult& fit,
                         const std::vector<std::string>& doubts, FitFiles& files, const Progress& progress);

}  // namespace tangi
