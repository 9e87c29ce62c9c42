// white_balances.h: the colour of the light in each photograph beside that of the others: a white balance
// that the camera chose anew, lights of several colours.
//
// What matt paint sends back has, in each channel, the paint's reflectance times the light's strength times
// the camera's gain, whatever its slope: ln(red / green) and ln(blue / green) of a pixel are a number of the
// pixel plus one of the photograph. A veil of gloss adds white light: it changes these numbers the more, the
// darker and the more coloured a pixel is, and those of a neutral one not at all. Both are told apart by a
// line through what all pixels say of a photograph, taken where a veil changes nothing (colour_line.h).
// Metal, whose colour changes from photograph to photograph, has the less weight for it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/stack/survey.h"
#include "surface/image/colour.h"

namespace tangi {

struct WhiteBalance {
    glm::dvec2 log_gain{0};  // ln of red and of blue against green, beside what photographs have in common
    glm::dvec2 sigma{0};     // standard errors; 0: nothing is known
    glm::dvec2 uneven{0};    // between quarters of the picture
    glm::dvec2 uneven_sigma{0};  // how large that is without any second light
    int samples = 0;             // that tell it
    bool differs = false;        // beyond its errors, and by more than matters: to be undone
    // Told only: pixels disagree by how much, metal does as much, or lights have as many colours as there
    // are.
    bool unclear = false;

    // [1] By which the photograph's channels are to be divided to be as the others; 1 where it doesn't
    // differ.
    Rgb gain() const;
    void decide();  // whether it differs
};

struct WhiteBalances {
    std::vector<WhiteBalance>
        photos;  // empty where they cannot be told: grey, too few photographs or samples

    Rgb gain(std::size_t photo) const { return photo < photos.size() ? photos[photo].gain() : Rgb(1); }
    // Beside photographs of which these were measured before, as those of a chart, which knows the colour of
    // every light; nothing changes where both say the same of what most have in common.
    void refer_to(std::span<const std::optional<glm::dvec2>> log_gains);
    int differing() const;
    int unclear() const;
};

// Linear light of samples (pixels, patches) under each photograph's light: [sample][photo], NaN in a channel
// where it is not to be used. `part`: of each sample, 0 to 3, where in the picture it lies.
struct ColourSamples {
    std::size_t photos = 0;
    std::vector<Rgb> values;
    std::vector<int> part;
};

// By alternating medians (Tukey 1977, median polish), then robust lines. What half of the photographs or more
// have in common is 0; of equally many, what the first has; where no half agrees, lights of all colours, the
// mean. `lights`: of the photographs, which tell how strong gloss may be; from 45 degrees where empty.
WhiteBalances white_balances(const ColourSamples& samples, std::span<const Light> lights = {});

// Of a stack's photographs in colour, else nothing; highlights, shadows and what is clipped or nearly black
// do not count.
ColourSamples colour_samples(const Survey& survey, const Transfer& transfer, float clipped, int bits);
WhiteBalances white_balances(const Survey& survey, const Transfer& transfer, float clipped, int bits,
                             std::span<const Light> lights = {});

// Of one photograph beside what is expected of it: linear light of as many pixels, NaN where not to be used.
// `light`: the direction that it is lit from.
WhiteBalance white_balance_beside(std::span<const Rgb> expected, std::span<const Rgb> photographed,
                                  std::span<const int> part, const Vec3& light);

// What the user is to know; empty where nothing differs. `names`: of the photographs. `remedy`: what is
// done.
std::string warning_of(const WhiteBalances& balances, std::span<const std::string> names,
                       const std::string& where, std::string_view remedy = "this is undone");

// [{"photograph", "red", "blue", "sigma_red", "sigma_blue", "undone"}] of those that differ, or of all.
nlohmann::json to_json(const WhiteBalances& balances, std::span<const std::string> names, bool all = false);

}  // namespace tangi
