// painting_file_support.h: a surface whose every value is another.
#pragma once

#include "surface/maps/surface.h"
#include "tests/support/test_support.h"

namespace tangi {

inline Surface random_surface(int width, int height, std::uint64_t seed = 1) {
    Random random(seed);
    Surface s(width, height);
    for (std::size_t i = 0; i < s.height_mm.size(); ++i) {
        s.height_mm.pixels()[i] = random.real(-2, 2);
        s.normal.pixels()[i] = random.direction(0.1);
        s.diffuse.pixels()[i] = {random.real(), random.real(), random.real()};
        s.specular.pixels()[i] = random.real(0, 0.1);
        s.roughness.pixels()[i] = random.real(0.01, 1);
        s.confidence.pixels()[i] = random.real();
    }
    return s;
}

}  // namespace tangi
