#include "retouch/mask/damage_class.h"

#include <algorithm>
#include <cstddef>

namespace tangi {

namespace {

constexpr std::array<std::string_view, 8> kDamageNames = {
    "loss_to_ground", "loss_to_support", "abrasion",  "craquelure",
    "flaking",        "old_fill",        "overpaint", "stain"};

}  // namespace

std::string_view name_of(DamageClass damage) { return kDamageNames[static_cast<std::size_t>(damage)]; }

std::optional<DamageClass> damage_class_named(std::string_view name) {
    const auto found = std::find(kDamageNames.begin(), kDamageNames.end(), name);
    if (found == kDamageNames.end()) return {};
    return static_cast<DamageClass>(found - kDamageNames.begin());
}

Rgb legend_colour_srgb(DamageClass damage) {
    constexpr std::array<std::array<int, 3>, 8> bytes = {{{230, 159, 0},
                                                          {213, 94, 0},
                                                          {240, 228, 66},
                                                          {0, 114, 178},
                                                          {204, 121, 167},
                                                          {0, 158, 115},
                                                          {86, 180, 233},
                                                          {110, 110, 110}}};
    const auto& c = bytes[static_cast<std::size_t>(damage)];
    return Rgb(c[0], c[1], c[2]) / 255.0f;
}

}  // namespace tangi
