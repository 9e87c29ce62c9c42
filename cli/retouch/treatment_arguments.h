// treatment_arguments.h: what commands that work on a treatment share.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "retouch/treatment/treatment_steps.h"

namespace tangi {

// Who does it, for the log.
struct AuthorArguments {
    std::string by;

    void add_to(Flags& flags);
    Author author() const;
};

// An area: the union of classes of damage, mask files and polygons; what is not given counts for nothing.
struct AreaArguments {
    std::vector<std::string> classes, masks, polygons;

    void add_to(Flags& flags, const std::string& what);
    bool empty() const { return classes.empty() && masks.empty() && polygons.empty(); }
    Mask area(const Treatment& treatment) const;
    // The mask files, for the log.
    std::vector<std::filesystem::path> inputs() const { return {masks.begin(), masks.end()}; }
    nlohmann::json as_json() const;
    StepArea step_area(const Treatment& treatment) const;
};

// Throws UsageError naming `flag` where the word is none of the names.
DamageClass damage_class_of(const std::string& word, const std::string& flag);

// "10,20;30,20;30,40" [mm] from the centre of the picture, y up, as corners [pixels]. Throws UsageError.
Polygon parse_polygon(const std::string& text, const Treatment& treatment);

// Opens it and prints its warnings.
Treatment open_treatment(const std::string& folder);
// For steps that change the painting: throws Error where strokes lie on it that were not saved in the window,
// since they could not be recovered on another painting.
void refuse_over_unsaved(const Treatment& treatment);
// Throws UsageError where a scale is typed that is not the one that the treatment began with.
void require_its_scale(const Treatment& treatment, const std::optional<double>& mm_per_pixel);

}  // namespace tangi
