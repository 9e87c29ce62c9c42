// plan_file.h: a FitPlan as files: plan.json, which says in words and numbers what was found of the
// photographs, and plan.maps beside it (block_file.h), with the maps of the reduced photographs and the
// samples of the survey.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "fit/pipeline/fit_plan.h"

namespace tangi {

class AtomicFile;

std::filesystem::path maps_of_plan(const std::filesystem::path& plan);

// Fills both files, which OutputSet puts in place together. `told`: what else the plan is to say: "options",
// "provenance", "result", "warnings", "poor", …; "tile_pixels", the side of a tile. Photographs are named by
// their place in the lights file.
void write_plan(const FitPlan& plan, nlohmann::json told, AtomicFile& json, AtomicFile& maps);

// A plan as a step takes it from the files.
class PlanFile {
public:
    // Throws Error naming the file: it is missing, no plan, of another version of the program, damaged, or
    // its maps are those of another plan.
    explicit PlanFile(std::filesystem::path path);

    const std::filesystem::path& path() const { return path_; }
    const nlohmann::json& content() const { return json_; }
    const std::string& sha256() const { return sha256_; }  // of plan.json: what tiles are made of
    int width() const;
    int height() const;
    int tile_pixels() const;

    // `opened`: the photographs as the plan's options open and develop them. Throws Error where they are
    // others than those of the plan.
    FitPlan plan(Stack opened) const;

private:
    void take_photographs(Stack& stack) const;

    std::filesystem::path path_;
    nlohmann::json json_;
    std::string sha256_;
};

}  // namespace tangi
