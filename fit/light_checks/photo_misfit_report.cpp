#include <algorithm>
#include <cmath>
#include <functional>

#include "fit/light_checks/photo_misfit.h"
#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

// [sigma] What a cause explains of a photograph, from which on it is told. The fit expects surfaces to differ
// from the model by 5 % (WardFitOptions::model_error), so that this is 1.5 % of the light at least: a slope
// of 45 degrees to the light changes by 0.9 degrees where it takes that for shading, more than what fits of
// good photographs state.
constexpr double kTells = 0.3;
constexpr double kBeyondError = 5;  // [standard errors] on top of it: hundreds of terms are looked at
// [1] Of the light of the middling photograph: a light that gives less was off.
constexpr double kOff = 0.1;
// [1] Of the middling place's brightness. Slopes come out flatter by as much, and the fit takes half of it
// for light of the room: this is 1 degree of 20, the error as which kTells counts.
constexpr double kVeil = 0.1;
// [1] Times the middling photograph's misfit, and so many photographs at most: these stand out.
constexpr double kStandsOut = 3;
constexpr double kMostlyMatt = 0.5;  // [1] of what was compared
constexpr std::size_t kFew = 4;      // that are named
constexpr std::size_t kFewOff = 2;   // lights that fail in one session, at most: a guess

bool tells(const MisfitTerm& term) {
    return term.effect > kTells && std::abs(term.value) > kBeyondError * term.error;
}

bool is_off(const PhotoMisfit& photo) {
    // Where little of the painting is lit (lights at grazing angles), the strength is open.
    return photo.strength < kOff && -photo.gain.value > kBeyondError * photo.gain.error &&
           std::max(photo.gain.effect, photo.room.effect) > kTells;
}

// More than one cause may look like it: the larger effect has the say.
bool has_room_light(const PhotoMisfit& photo) {
    return tells(photo.room) && photo.room.value > 0 && photo.room.effect > photo.blur.effect;
}

bool is_blurred(const PhotoMisfit& photo) {
    return tells(photo.blur) && photo.blur.effect >= photo.room.effect;
}

// The few that are most, by what `says` of each, and how many more there are.
template <class Says>
std::string list_of(std::vector<std::size_t> which, const PhotoMisfits& misfits,
                    const std::function<double(const PhotoMisfit&)>& much, const Says& says) {
    std::stable_sort(which.begin(), which.end(), [&](std::size_t a, std::size_t b) {
        return much(misfits.photos[a]) > much(misfits.photos[b]);
    });
    std::string list;
    for (std::size_t k = 0; k < std::min(which.size(), kFew); ++k)
        list += (k > 0 ? ", " : "") + says(which[k], misfits.photos[which[k]]);
    if (which.size() > kFew) list += fmt::format(" and {} more", which.size() - kFew);
    return list;
}

template <class Is>
std::vector<std::size_t> those_that(const PhotoMisfits& misfits, const Is& is) {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < misfits.photos.size(); ++i)
        if (is(misfits.photos[i])) which.push_back(i);
    return which;
}

std::string doubt_of_focus(const PhotoMisfits& misfits, const std::vector<std::string>& names) {
    const auto which = those_that(misfits, [](const PhotoMisfit& p) { return !is_off(p) && is_blurred(p); });
    if (which.empty()) return {};
    return fmt::format(
        "{} of {} photographs are softer or sharper than the others (standard deviation of the blur between "
        "them): {}. The focus or the camera moved, and slopes take that for relief: leave them out, or take "
        "them again with the focus held",
        which.size(), names.size(),
        list_of(
            which, misfits, [](const PhotoMisfit& p) { return p.blur.effect; },
            [&](std::size_t i, const PhotoMisfit& p) {
                const double width = std::sqrt(std::abs(p.blur.value));
                return fmt::format("{} {:.2f} ± {:.2f} pixels {}", names[i], width,
                                   p.blur.error / (2 * std::max(width, 1e-9)),
                                   p.blur.value > 0 ? "softer" : "sharper");
            }));
}

std::string doubt_of_room(const PhotoMisfits& misfits, const std::vector<std::string>& names) {
    const auto which =
        those_that(misfits, [](const PhotoMisfit& p) { return !is_off(p) && has_room_light(p); });
    if (which.empty()) return {};
    return fmt::format(
        "{} of {} photographs have light that is not their light's, as where the lights of the room were on "
        "(of what a white sheet would show; the others have none): {}. Leave them out, or take them again in "
        "the dark",
        which.size(), names.size(),
        list_of(
            which, misfits, [](const PhotoMisfit& p) { return p.room.effect; },
            [&](std::size_t i, const PhotoMisfit& p) {
                return fmt::format("{} {:.3f} ± {:.3f}", names[i], p.room.value, p.room.error);
            }));
}

// Where not even most photographs are explained in matt paint, or most of the painting is not matt, what is
// left of one photograph has no cause of its own.
bool tells_causes(const PhotoMisfits& misfits) {
    return !is_in_matt_paint(misfits) && misfits.matt.part >= kMostlyMatt;
}

void add_lights_off(const PhotoMisfits& misfits, const std::vector<std::string>& names,
                    std::vector<std::string>& doubts) {
    const std::vector<std::size_t> off = those_that(misfits, is_off);
    if (off.size() > kFewOff) {
        doubts.push_back(
            fmt::format("{} of {} photographs show next to none of the light that their lights should give: "
                        "{}. Look whether the lights are listed in the order of the photographs; or these "
                        "lights did not fire, and the "
                        "photographs are to be left out",
                        off.size(), names.size(),
                        list_of(
                            off, misfits, [](const PhotoMisfit& p) { return -p.strength; },
                            [&](std::size_t i, const PhotoMisfit& p) {
                                return fmt::format("{} {:.2f} ± {:.2f}", names[i], std::max(p.strength, 0.0),
                                                   p.gain.error);
                            })));
        return;
    }
    for (const std::size_t i : off) {
        const PhotoMisfit& photo = misfits.photos[i];
        doubts.push_back(fmt::format(
            "{}: shows {:.2f} ± {:.2f} of the light that its light should give{}: leave it out of the lights "
            "file, or take it again",
            names[i], std::max(photo.strength, 0.0), photo.gain.error,
            tells(photo.room)
                ? ", and light of the room: the light did not fire"
                : ", and nothing else of the painting: it is a dark frame, or the light did not "
                  "fire"));
    }
}

}  // namespace

std::vector<std::string> doubts_of(const PhotoMisfits& misfits, const std::vector<std::string>& names) {
    std::vector<std::string> doubts;
    add_lights_off(misfits, names, doubts);
    if (!tells_causes(misfits)) return doubts;
    const MisfitTerm& veil = misfits.veil;
    const bool veiled = veil.effect > kVeil && veil.value > kBeyondError * veil.error;
    // Of a veil, photographs have different parts: no light of the room that some have.
    for (std::string doubt :
         {veiled ? std::string() : doubt_of_room(misfits, names), doubt_of_focus(misfits, names)})
        if (!doubt.empty()) doubts.push_back(std::move(doubt));
    if (veiled)
        doubts.push_back(fmt::format(
            "all photographs have a veil: where no light reaches, they show {:.3f} ± {:.3f} more than is in "
            "proportion to the paint ({:.0f} % of the middling brightness). Light scattered in the lens "
            "(clean it, keep lights out of its sight), a black level that was not taken off, or a window do "
            "that; "
            "slopes come out too flat",
            veil.value, veil.error, 100 * veil.effect));
    return doubts;
}

bool is_in_matt_paint(const PhotoMisfits& misfits) { return misfits.matt.rms > 1; }

bool is_in_gloss(const PhotoMisfits& misfits) { return misfits.glossy.rms > 2 * misfits.matt.rms; }

std::string ruled_out(const PhotoMisfits& misfits) {
    if (!tells_causes(misfits)) return {};
    const bool veil = misfits.veil.error > 0;
    if (misfits.judged > 0)
        return veil ? "focus, light of the room and a veil" : "focus and light of the room";
    return veil ? "a veil" : "";
}

std::string worst_of(const PhotoMisfits& misfits, const std::vector<std::string>& names) {
    std::vector<double> all;
    for (const PhotoMisfit& photo : misfits.photos) all.push_back(photo.rms);
    const double usual = median(all);
    const auto which =
        those_that(misfits, [&](const PhotoMisfit& p) { return p.rms > std::max(kStandsOut * usual, 1.0); });
    if (which.empty() || which.size() > kFew) return {};
    return list_of(
        which, misfits, [](const PhotoMisfit& p) { return p.rms; },
        [&](std::size_t i, const PhotoMisfit& p) {
            return fmt::format("{} {:.1f} times as much as others", names[i],
                               usual > 0 ? p.rms / usual : p.rms);
        });
}

nlohmann::json to_json(const PhotoMisfits& misfits, const std::vector<std::string>& names) {
    const auto term = [](const MisfitTerm& t) {
        return nlohmann::json{{"value", t.value}, {"error", t.error}, {"effect_sigma", t.effect}};
    };
    nlohmann::json photos = nlohmann::json::array();
    for (std::size_t i = 0; i < misfits.photos.size(); ++i) {
        const PhotoMisfit& photo = misfits.photos[i];
        photos.push_back({{"name", names[i]},
                          {"rms_sigma", photo.rms},
                          {"strength", photo.strength},
                          {"gain", term(photo.gain)},
                          {"room_light", term(photo.room)},
                          {"constant", term(photo.constant)},
                          {"blur_px2", term(photo.blur)}});
    }
    const auto kind = [](const PhotoMisfits::Kind& k) {
        return nlohmann::json{{"rms_sigma", k.rms}, {"part", k.part}};
    };
    return {{"photographs", std::move(photos)},
            {"judged", misfits.judged},
            {"matt", kind(misfits.matt)},
            {"glossy", kind(misfits.glossy)},
            {"veil",
             {{"value", misfits.veil.value},
              {"error", misfits.veil.error},
              {"part_of_brightness", misfits.veil.effect}}}};
}

}  // namespace tangi
