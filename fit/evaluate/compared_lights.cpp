#include "fit/evaluate/compared_lights.h"

#include <algorithm>

#include "surface/base/error.h"

namespace tangi {

namespace {

// Under whose name the painting lists this light; null where under none.
const Photography::Photo* owner_of(Light light, const Photography& photography) {
    for (const Photography::Photo& photo : photography.photos) {
        light.name = photo.light.name;
        if (find_photo(photography, light)) return &photo;
    }
    return nullptr;
}

}  // namespace

std::string says_lights_are_exchanged(std::span<const StackPhoto> photos, const Photography& photography,
                                      const std::string& folder) {
    std::size_t named = 0, exchanged = 0;
    std::string example;
    for (const StackPhoto& photo : photos) {
        const bool is_named = std::ranges::any_of(photography.photos, [&](const Photography::Photo& known) {
            Light renamed = known.light;
            renamed.name = photo.light.name;
            return find_photo(photography, renamed) == &known;
        });
        named += is_named;
        if (!is_named || find_photo(photography, photo.light)) continue;
        const Photography::Photo* owner = owner_of(photo.light, photography);
        if (!owner) continue;
        if (exchanged++ == 0)
            example = fmt::format("{} has the light that {} had", photo.light.name, owner->light.name);
    }
    // By chance a light of another list is that of another photograph here and there.
    if (exchanged < 2 || 2 * exchanged <= named) return {};
    return fmt::format(
        "{}: {} of {} photographs have lights that others of them had when the painting was fitted ({}): one "
        "of the two lists is shifted, or runs the other way; compare with the list that is right, and fit "
        "again if it is this one",
        folder, exchanged, named, example);
}

}  // namespace tangi
