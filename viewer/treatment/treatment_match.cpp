// treatment_match.cpp: of the treatment: recipes from the user's own paints for a colour of the painting.
#include <fmt/format.h>

#include <sstream>

#include "retouch/colour_match/paint_media.h"
#include "retouch/inpaint/recipe_json.h"
#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

namespace {

constexpr double kSample_mm = 2;  // across, of what a click samples
constexpr double kVisible = 1;    // CIEDE2000 of mixtures that count as having a colour
constexpr double kMetameric = 1;  // index from which on a match is warned of
constexpr double kVaried = 5;     // CIEDE2000 of surroundings that no single recipe matches
constexpr double kPoor = 5;       // CIEDE2000 that nobody would call a match

// A colour of the painting, and what a film of paint there would lie on.
struct Sampled {
    Rgb linear{0};
    Gloss gloss;
    double spread = 0;
    std::optional<Rgb> below;
};

Sampled sample_at(const Surface& seen, const glm::dvec2& at, double radius_px) {
    const int x0 = static_cast<int>(std::floor(at.x - radius_px)),
              x1 = static_cast<int>(std::ceil(at.x + radius_px));
    const int y0 = static_cast<int>(std::floor(at.y - radius_px)),
              y1 = static_cast<int>(std::ceil(at.y + radius_px));
    Sampled sampled;
    sampled.gloss = {0, 0, 0};
    std::vector<Rgb> colours;
    for (int y = std::max(y0, 0); y <= std::min(y1, seen.height() - 1); ++y)
        for (int x = std::max(x0, 0); x <= std::min(x1, seen.width() - 1); ++x) {
            if (glm::length(glm::dvec2(x, y) - at) > radius_px || !(seen.confidence(x, y) > 0)) continue;
            colours.push_back(seen.diffuse(x, y));
            sampled.linear += seen.diffuse(x, y);
            sampled.gloss.specular += static_cast<double>(seen.specular(x, y));
            sampled.gloss.roughness += static_cast<double>(seen.roughness(x, y));
        }
    if (colours.empty()) fail("nothing was measured there: choose another place");
    const auto count = static_cast<double>(colours.size());
    sampled.linear /= static_cast<float>(count);
    sampled.gloss.specular /= count;
    sampled.gloss.roughness /= count;
    const Lab mean = lab_from_linear(glm::dvec3(sampled.linear));
    for (const Rgb& c : colours) sampled.spread += delta_e_2000(lab_from_linear(glm::dvec3(c)), mean) / count;
    return sampled;
}

Sampled sample_round(const Surface& seen, const Mask& mask, const Mask& spoilt, double mm_per_pixel) {
    AnnulusOptions options;  // in the surface's unit, which is a pixel where the treatment gave the scale
    options.gap_mm *= seen.mm_per_pixel / mm_per_pixel;
    options.annulus_mm *= seen.mm_per_pixel / mm_per_pixel;
    const Annulus round = annulus_of(seen, mask, spoilt, options);
    Sampled sampled;
    sampled.linear = round.mode;
    sampled.spread = round.spread;
    sampled.gloss = {round.specular, round.roughness, 0};
    return sampled;
}

std::optional<Rgb> mean_within(const Surface& seen, const Mask& mask) {
    Rgb sum(0);
    float weights = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        sum += mask.pixels()[i] * seen.diffuse.pixels()[i];
        weights += mask.pixels()[i];
    }
    if (!(weights > 0)) return {};
    return sum / weights;
}

Rgb srgb_of(const Rgb& linear) {
    return Transfer{Transfer::Kind::srgb}.encode(glm::clamp(linear, 0.0f, 1.0f));
}

std::string gloss_text(const Gloss& paint, const Gloss& wanted) {
    const std::string_view remedy = name_of(remedy_for(paint, wanted));
    return fmt::format("Gloss: {}{}. Strength {:.3f}, there {:.3f}; roughness α {:.2f}, there {:.2f}",
                       remedy == "none" ? "alike" : fmt::format("needs {}", remedy),
                       can_reflect(paint, wanted) ? "" : ", but no paint or varnish reflects so much",
                       paint.specular, wanted.specular, paint.roughness, wanted.roughness);
}

ShownRecipe shown_of(const MatchedRecipe& r, const Palette& palette, const std::vector<PairWarning>& pairs,
                     const Gloss& wanted) {
    ShownRecipe shown{text_of(r.steps, palette.paints), {}, r.delta_e,
                      srgb_of(to_linear_rgb(r.look)),   {}, {}};
    for (std::size_t i = 0; i < static_cast<std::size_t>(r.mixture.count); ++i)
        shown.mix[palette.paints[static_cast<std::size_t>(r.mixture.paints[i])].name] +=
            static_cast<float>(r.mixture.volumes[i]);
    shown.gloss = gloss_text(gloss_of(r.mixture, palette.paints, xyz_of(r.look, Illuminant::d65).y), wanted);
    for (std::size_t light = 0; light < kIlluminants; ++light)
        if (r.metamerism[light] > kMetameric)
            shown.warnings.push_back(
                fmt::format("metameric: where it matches under D65, it is off by ΔE2000 {:.1f} under {}",
                            r.metamerism[light], name_of(static_cast<Illuminant>(light))));
    if (r.error > kPoor)
        shown.warnings.push_back(
            fmt::format("no match: these paints come no nearer than ΔE2000 {:.1f}", r.error));
    for (const auto& text : warnings_of(r.mixture, palette.paints, pairs)) shown.warnings.push_back(text);
    return shown;
}

// What recipes are looked for with.
struct Wanted {
    Palette palette;
    MatchOptions options;
    std::optional<double> film_mm;  // a film over what lies there; else one that hides
    std::vector<PairWarning> pairs;
};

// Recipes for a colour that was sampled; `where`: as the panel calls the place.
ShownMatch matched(Sampled sampled, const std::string& where, const Wanted& by) {
    const std::vector<Pigment>& paints = by.palette.paints;
    MatchOptions options = by.options;
    const glm::dvec3 xyz = xyz_of(reflectance_of_rgb(sampled.linear), Illuminant::d65);
    sampled.gloss.luminance = xyz.y;
    const auto likely = likely_spectrum(paints, xyz, Illuminant::d65, options, kVisible);
    const Spectrum wanted = likely ? likely->reflectance : smooth_spectrum(xyz, Illuminant::d65);
    if (by.film_mm && sampled.below)
        options.film = FilmOnGround{*by.film_mm, reflectance_of_rgb(*sampled.below)};
    const MatchResult found = match_spectrum(paints, wanted, options);
    ShownMatch shown;
    shown.of = where;
    shown.lab = lab_from_linear(glm::dvec3(sampled.linear));
    shown.srgb = srgb_of(sampled.linear);
    shown.spread = sampled.spread;
    if (sampled.spread > kVaried)
        shown.of +=
            fmt::format(": colours vary by ΔE2000 {:.0f} there, the commonest is matched", sampled.spread);
    for (const MatchedRecipe& r : found.recipes)
        shown.recipes.push_back(shown_of(r, by.palette, by.pairs, sampled.gloss));
    return shown;
}

std::vector<std::string> words_in(const std::string& text) {
    std::vector<std::string> words;
    std::stringstream stream(text);
    for (std::string word; std::getline(stream, word, ',');) {
        const auto first = word.find_first_not_of(' '), last = word.find_last_not_of(' ');
        if (first != std::string::npos) words.push_back(word.substr(first, last - first + 1));
    }
    return words;
}

constexpr const char* kPairs = "pigment_pairs.json";

}  // namespace

// The user's own list, where there is one.
void TreatmentController::read_pairs() {
    std::vector<PigmentPair> pairs = usual_pigment_pairs();
    pairs_file_ = SettingsFile(setup_.settings / kPairs);
    try {
        if (!setup_.settings.empty() && std::filesystem::exists(pairs_file_.path()))
            pairs = read_pigment_pairs(pairs_file_.path());
    } catch (const Error& error) {
        pairs_file_.cannot_be_read();
        setup_.say(error.what());  // the usual ones, then
    }
    pairs_ = std::make_shared<const std::vector<PigmentPair>>(std::move(pairs));
    state_.treatment_state.pairs = *pairs_;
}

void TreatmentController::change_pairs(const ColourMatchRequests& ask) {
    std::vector<PigmentPair> pairs = *pairs_;
    if (ask.drop_pair >= 0 && ask.drop_pair < static_cast<int>(pairs.size()))
        pairs.erase(pairs.begin() + ask.drop_pair);
    else if (ask.usual_pairs)
        pairs = usual_pigment_pairs();
    else if (ask.add_pair) {
        const TreatmentState::NewPair& pair = state_.treatment_state.new_pair;
        const auto first = words_in(pair.first), second = words_in(pair.second);
        if (first.empty() || second.empty()) {
            setup_.say("give a word at least for both: as they occur in names of paints");
            return;
        }
        pairs.push_back({first, second, pair.why, author().who});
        state_.treatment_state.new_pair = {};
    } else {
        return;
    }
    pairs_ = std::make_shared<const std::vector<PigmentPair>>(pairs);
    state_.treatment_state.pairs = std::move(pairs);
    state_.treatment_state.match.reset();  // it was warned by the list before
    if (setup_.settings.empty()) return;
    try {
        std::filesystem::create_directories(setup_.settings);
        if (const std::string told = pairs_file_.make_way(); !told.empty()) setup_.say(told);
        write_pigment_pairs(pairs_file_.path(), *pairs_);
        pairs_file_.is_written();
    } catch (const std::exception& error) {
        setup_.say(message_of(error));  // it holds until the window closes
    }
}

// Of the colour round the damage that is worked on, or at a place.
void TreatmentController::match(const std::optional<glm::dvec2>& at) {
    const TreatmentState& t = state_.treatment_state;
    MatchOptions options;
    options.max_paints = t.most_paints;
    options.illuminants = illuminants_that_count();
    if (options.illuminants.empty()) {
        setup_.say("choose a light at least under which the colour is to match");
        return;
    }
    Palette paints = setup_.palette;
    take_out_media(paints);
    const std::vector<PairWarning> pairs = pairs_to_avoid(paints.paints, *pairs_);
    if (t.avoid_pairs) options.allowed = without_pairs(paints.paints.size(), pairs);
    const std::optional<double> film_mm = t.film ? std::optional(t.retouch.thickness_mm) : std::nullopt;
    start("looking for recipes",
          [this, at, made_with = match_made_with(), list = pairs_, where = t.where, painter = painter_,
           wanted = Wanted{paints, options, film_mm, pairs}](const Progress&) -> Finish {
              const Treatment now = treatment();
              const double mm = now.mm_per_pixel();
              const Mask mask = area_of_classes(now, where).mask, spoilt = damaged(now);
              Sampled sampled;
              painter
                  ->look([&](const Surface& seen, const Canvas&) {
                      sampled = at ? sample_at(seen, *at, std::max(kSample_mm / 2 / mm, 1.0))
                                   : sample_round(seen, mask, spoilt, mm);
                      sampled.below = mean_within(seen, mask);
                  })
                  .get();
              ShownMatch shown = matched(
                  sampled, at ? fmt::format("at {:.0f}, {:.0f}", at->x, at->y) : "round the damage", wanted);
              shown.made_with = made_with;
              return [this, shown = std::move(shown)]() mutable {
                  state_.treatment_state.match = std::move(shown);
                  state_.treatment_state.forward = "Colour";
                  state_.treatment_state.in_front = true;
              };
          });
}

}  // namespace tangi
