#include "capture/radiometry/full_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "capture/radiometry/transfer_estimate.h"
#include "capture/radiometry/transfer_evidence.h"

namespace tangi {

namespace {

constexpr double kTopOf16 = 65535;
constexpr int kFewestBits = 8;  // of integers in files of 16
// What sensors add to all values is up to a sixth of full scale (2048 of 13 bits and a half); without it,
// values end as far below 2^k - 1.
constexpr double kLeastOfBits = 0.8;
// Where nothing is clipped the largest value is that of a pixel or two, and another one in each photograph.
constexpr int kFewestClippedAlike = 2, kFewestAtMaximum = 8;
// Codes of 8, 10, 12, 14 and 16 bits, of which photographs use more than a quarter in their highlights.
constexpr std::array<double, 5> kTops = {255, 1023, 4095, 16383, 65535};

double largest(const Survey& survey) {
    double most = 0;
    for (const Survey::Photo& photo : survey.photos) most = std::max(most, photo.maximum);
    return most;
}

// 2^k - 1 that a largest code belongs to, where it is below the largest of 16 bits; 0 where it is none's.
double top_of_bits(double code) {
    for (int bits = kFewestBits; bits <= 16; ++bits)
        if (const double top = std::exp2(bits) - 1; code <= top) return code >= kLeastOfBits * top ? top : 0;
    return 0;
}

bool take_integers(Stack& stack, const Survey& survey) {
    const double most = largest(survey), code = std::round(most * kTopOf16);
    const double top = top_of_bits(code);
    if (!(top > 0) || most >= static_cast<double>(kClipped)) return false;
    const auto alike =
        std::count_if(survey.photos.begin(), survey.photos.end(), [&](const Survey::Photo& photo) {
            return photo.maximum == most && photo.at_maximum >= kFewestAtMaximum;
        });
    if (code != top && alike < kFewestClippedAlike) return false;
    stack.full_scale = code / kTopOf16;
    stack.warnings.push_back(fmt::format(
        "{}: the largest value of the photographs is {:.0f} of 65535, {}; it is taken for full scale, where "
        "highlights are clipped",
        stack.folder.string(), code,
        code == top
            ? fmt::format("as of {:.0f} bits that were not scaled to the 16 of the file", std::log2(top + 1))
            : "and several of them have it many times, as clipping leaves it"));
    return true;
}

// The code that is full scale of floats of this size; 0 where they are none.
double top_of_floats(double most) {
    if (most <= 1) return 1;
    for (const double top : kTops)
        if (most <= top) return most > top / 4 ? top : 0;
    return 0;
}

bool are_whole_numbers(const Survey& survey) {
    return largest(survey) > 1 && std::all_of(survey.values.begin(), survey.values.end(), [](float value) {
               return std::isnan(value) || value == std::round(value);
           });
}

bool has_several_lights(const Stack& stack) {
    return std::any_of(stack.photos.begin(), stack.photos.end(), [&](const StackPhoto& photo) {
        return photo.light.direction != stack.photos.front().light.direction;
    });
}

// The curve of codes that the photographs look like, where they contradict linear light.
std::optional<Transfer> encoding_of_floats(const Stack& stack, const Survey& survey, double top) {
    Survey scaled = survey;
    divide_by_full_scale(scaled.values, top, false);
    for (const Transfer& curve : {Transfer{Transfer::Kind::srgb}, Transfer{Transfer::Kind::gamma, 2.2}})
        if (speaks_against(Transfer{}, {curve, "", {}, {}}, stack, scaled)) return curve;
    return {};
}

bool take_floats(Stack& stack, const Survey& survey) {
    const double most = largest(survey), top = top_of_floats(most);
    if (!(top > 0) || (stack.transfer && *stack.transfer == Transfer{})) return false;
    std::string why;
    if (stack.transfer)
        why = fmt::format("that are stored as {}, as is said", stack.transfer->name());
    else if (are_whole_numbers(survey))
        why = "that are whole numbers";
    else if (const auto curve =
                 has_several_lights(stack) ? encoding_of_floats(stack, survey, top) : std::nullopt)
        why = fmt::format(
            "of which nothing says how they are stored, and which look like {} and not like linear light",
            curve->name());
    if (why.empty()) return false;
    stack.full_scale = top;
    stack.float_codes = true;
    stack.bits = 16;
    stack.warnings.push_back(
        fmt::format("{}: the photographs hold floats up to {:.4g} {}: they are taken for codes of which "
                    "{:.0f} is full scale, where "
                    "highlights are clipped; if they are linear light, say so with --transfer linear",
                    stack.folder.string(), most, why, top));
    return true;
}

}  // namespace

bool take_full_scale(Stack& stack, const Survey& survey) {
    if (stack.is_raw || stack.development || stack.full_scale != 1 || stack.float_codes) return false;
    if (stack.bits == 16) return take_integers(stack, survey);
    return stack.bits == 32 && !stack.says_linear && take_floats(stack, survey);
}

}  // namespace tangi
