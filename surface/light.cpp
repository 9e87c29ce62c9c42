#include "surface/light.h"

#include "surface/error.h"

namespace tangi {

Light distant_light(const Vec3& direction, std::string name) {
    const float length = glm::length(direction);
    TP_REQUIRE(length > 0, "a light needs a direction");
    return {.name = std::move(name), .direction = direction / length};
}

Light near_light(const Vec3& position_mm, std::string name) {
    Light light = distant_light(position_mm, std::move(name));
    light.position_mm = position_mm;
    return light;
}

}  // namespace tangi
