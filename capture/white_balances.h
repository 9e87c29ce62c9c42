// white_balances.h: the colour of the light in each photograph beside that of the others: a white balance
// that the camera chose anew, lamps of several colours.
//
// What matt paint sends back has, in each channel, the paint's reflectance times the lamp's light times the
// camera's gain, whatever its slope: ln(red / green) and ln(blue / green) of a pixel are a number of the
// pixel plus one of the photograph. A veil of gloss or of light from all around moves colours towards white
// instead, the more the farther from it they are: so does metal, pixel by pixel. Both are told apart by a
// line through what pixels of different colours say of a photograph, taken at white.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/survey.h"
#include "surface/colour.h"

namespace tangi {

struct WhiteBalance {
    glm::dvec2 log_gain{0};  // ln of red and of blue against green, beside what photographs have in common
    glm::dvec2 sigma{0};     // standard errors; 0: nothing is known
    glm::dvec2 scatter{0};   // between parts of the picture and pixels of different colours
    int samples = 0;         // that tell it
    bool differs = false;    // beyond its errors, and by more than matters, alike in pixels of all colours
    bool unclear = false;    // it differs, but by how much depends on the pixel: no gain of a photograph

    // [1] By which the photograph's channels are to be divided to be as the others; 1 where it doesn't
    // differ.
    Rgb gain() const;
    void decide();  // whether it differs
};

struct WhiteBalances {
    std::vector<WhiteBalance>
        photos;  // empty where they cannot be told: grey, too few photographs or samples

    Rgb gain(std::size_t photo) const { return photo < photos.size() ? photos[photo].gain() : Rgb(1); }
    // Beside photographs of which these were measured before, as those of a chart; nothing changes where both
    // say the same of what most have in common.
    void refer_to(std::span<const std::optional<glm::dvec2>> log_gains);
    // Where more than half differ there is no balance that the others were to have, but lamps of many
    // colours: told, and not undone. Held-out photographs of the dome stack `door`, whose lamps are such, are
    // predicted worse by 1.8 dB where it is.
    void leave_lamps_of_many_colours();
    int differing() const;
    int unclear() const;
};

// Linear light of samples (pixels, patches) under each photograph's lamp: [sample][photo], NaN in a channel
// where it is not to be used. `part`: of each sample, 0 to 3, where in the picture it lies.
struct ColourSamples {
    std::size_t photos = 0;
    std::vector<Rgb> values;
    std::vector<int> part;
};

// By alternating medians (Tukey 1977, median polish), then robust lines. What half of the photographs or more
// have in common is 0; of equally many, what the first has; where no half agrees, the mean. Errors are by how
// much parts of the picture, and pixels of different colours, disagree.
WhiteBalances white_balances(const ColourSamples& samples);

// Of a stack's photographs; highlights, shadows and what is clipped or nearly black do not count.
WhiteBalances white_balances(const Survey& survey, const Transfer& transfer, float clipped, int bits);

// Of one photograph beside what is expected of it: linear light of as many pixels, NaN where not to be used.
WhiteBalance white_balance_beside(std::span<const Rgb> expected, std::span<const Rgb> photographed,
                                  std::span<const int> part);

// What the user is to know; empty where nothing differs. `names`: of the photographs. `remedy`: what is
// done.
std::string warning_of(const WhiteBalances& balances, std::span<const std::string> names,
                       const std::string& where, std::string_view remedy = "this is undone");

// [{"photograph", "red", "blue", "sigma_red", "sigma_blue", "undone"}] of those that differ, or of all.
nlohmann::json to_json(const WhiteBalances& balances, std::span<const std::string> names, bool all = false);

}  // namespace tangi
