#include "cli/retouch/treatment_arguments.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "cli/arguments.h"
#include "cli/command.h"
#include "surface/base/error.h"
#include "surface/file/version.h"
#include "viewer/model/crash_recovery.h"

namespace tangi {

void AuthorArguments::add_to(Flags& flags) {
    flags.option("--by", by, "who does it, for the log; the user's name without");
}

Author AuthorArguments::author() const {
    const char* user = std::getenv("USER");
    return {!by.empty() ? by : user && *user ? user : "unknown", program_name()};
}

void AreaArguments::add_to(Flags& flags, const std::string& what) {
    flags.option("--class", classes, "class of damage " + what + "; again for more").one_value();
    flags.option("--mask", masks, "picture of the painting's size, white " + what + "; again for more")
        .one_value();
    flags
        .option("--polygon", polygons,
                "X,Y;X,Y;X,Y in mm from the centre of the picture, y up, " + what + "; again for more")
        .one_value();
}

Mask AreaArguments::area(const Treatment& treatment) const {
    Mask area(treatment.width(), treatment.height());
    for (const std::string& word : classes) {
        const DamageClass damage = damage_class_of(word, "--class");
        if (!treatment.has_mask(damage))
            fail("--class {}: {} has no such damage; suggest or draw it first: tangipaint damage", word,
                 treatment.folder().string());
        area = united(area, treatment.mask(damage));
    }
    for (const std::string& file : masks) {
        const Mask mask = read_mask(file, treatment.width(), treatment.height());
        const float most = *std::max_element(mask.pixels().begin(), mask.pixels().end());
        if (most > 0 && most <= 0.5f)
            fail(
                "{}: has nothing lighter than {:.0f} % grey, and white is inside: make what belongs to it "
                "white",
                file, 100 * most);
        area = united(area, mask);
    }
    for (const std::string& text : polygons)
        area = united(
            area, mask_of_polygons({parse_polygon(text, treatment)}, treatment.width(), treatment.height()));
    return area;
}

StepArea AreaArguments::step_area(const Treatment& treatment) const {
    return {area(treatment), as_json(), inputs()};
}

nlohmann::json AreaArguments::as_json() const {
    return {{"classes", classes}, {"masks", masks}, {"polygons_mm", polygons}};
}

DamageClass damage_class_of(const std::string& word, const std::string& flag) {
    const auto damage = damage_class_named(word);
    if (damage) return *damage;
    std::vector<std::string_view> names;
    for (const DamageClass known : kDamageClasses) names.push_back(name_of(known));
    throw UsageError(fmt::format("{} {}: is not one of {}", flag, word, fmt::join(names, ", ")));
}

Polygon parse_polygon(const std::string& text, const Treatment& treatment) {
    Polygon polygon;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t end = std::min(text.find(';', from), text.size());
        const auto xy = numbers_in(text.substr(from, end - from), "--polygon", "X,Y;X,Y;X,Y");
        if (xy.size() != 2)
            throw UsageError(
                fmt::format("--polygon {}: give two numbers for each corner: X,Y;X,Y;X,Y", text));
        const double mm = treatment.mm_per_pixel();
        polygon.push_back({xy[0] / mm + treatment.width() / 2.0, treatment.height() / 2.0 - xy[1] / mm});
        from = end + 1;
    }
    return polygon;
}

Treatment open_treatment(const std::string& folder) {
    Treatment treatment = Treatment::open(folder);
    for (const std::string& warning : treatment.log().warnings()) warn(warning);
    return treatment;
}

void refuse_over_unsaved(const Treatment& treatment) {
    const RecoveryFiles files = recovery_files(treatment.painting());
    bool waits = false;
    try {
        waits = left_over(files).has_value();
    } catch (const Error&) {  // nothing in it can be recovered on any painting
    }
    if (waits)
        fail(
            "{}: strokes that were painted in the window are not saved, and go on from the painting as it is "
            "now; save them there first, or open {} and recover them or put them aside",
            files.unsaved.string(), treatment.folder().string());
}

void require_its_scale(const Treatment& treatment, const std::optional<double>& mm_per_pixel) {
    if (!mm_per_pixel) return;
    const bool same = std::abs(*mm_per_pixel / treatment.mm_per_pixel() - 1) < 1e-6;
    if (same && treatment.scale_known()) return;
    throw UsageError(fmt::format(
        "--mm-per-pixel {}: {} began with {}, and keeps that, so that its log stays true; begin another "
        "treatment with the right scale",
        *mm_per_pixel, treatment.folder().string(),
        treatment.scale_known() ? fmt::format("{:.6g} mm a pixel", treatment.mm_per_pixel()) : "no scale"));
}

}  // namespace tangi
