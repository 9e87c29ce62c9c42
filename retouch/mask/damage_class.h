// damage_class.h: classes of damage, their names in files and flags, and their colours on the map.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "surface/image/colour.h"

namespace tangi {

// Classes of damage; terms as in EN 15898 and the condition survey of EN 16095.
enum class DamageClass {
    loss_to_ground,   // paint is gone, the ground is bare
    loss_to_support,  // ground and paint are gone
    abrasion,         // paint is worn thin
    craquelure,
    flaking,  // paint lifts off
    old_fill,
    overpaint,
    stain
};
inline constexpr std::array<DamageClass, 8> kDamageClasses = {
    DamageClass::loss_to_ground, DamageClass::loss_to_support,
    DamageClass::abrasion,       DamageClass::craquelure,
    DamageClass::flaking,        DamageClass::old_fill,
    DamageClass::overpaint,      DamageClass::stain};
std::string_view name_of(DamageClass damage);  // "loss_to_ground"
std::optional<DamageClass> damage_class_named(std::string_view name);
Rgb legend_colour_srgb(DamageClass damage);  // told apart with every colour vision (Okabe & Ito 2008)

}  // namespace tangi
