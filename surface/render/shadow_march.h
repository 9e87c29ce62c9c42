// shadow_march.h: the march of cast_shadows.h from pixels side by side, on the lanes of vector registers.
#pragma once

#include <cstdint>
#include <vector>

namespace tangi {

constexpr int kMarchLanes = 16;  // pixels of a row that are looked at together

// A finest block has 2^kFinestBlock pixels a side: smaller ones cost as much to look at as the heights.
constexpr int kFinestBlock = 2;

// What is marched over: heights [mm], row by row, at least 2 x 2, and the highest points of blocks of them.
struct ShadowScene {
    const float* height_mm = nullptr;
    int width = 0, height = 0;
    float mm_per_pixel = 1;
    float tangent = 0;     // of the lights' angular radius
    float highest_mm = 0;  // of all
    // [k] of blocks of 2^(kFinestBlock + k) pixels a side: the highest point of each and its eight
    // neighbours.
    struct Level {
        const float* highest_mm;
        int width;
    };
    std::vector<Level> levels;
};

// Directions [unit vector] to the light of each lane.
struct MarchLights {
    const float *x, *y, *z;
};

// For those of the pixels (x, y) to (x + kMarchLanes - 1, y) whose bit of `which`, from the lowest on, is
// set, and which the picture has: how much of its light the relief covers, c of cast_shadows.h, from -1
// (nothing) on; 1 and more is all of it. Other lanes stay what they are.
void march_lanes(const ShadowScene& scene, int x, int y, const MarchLights& lights, std::uint32_t which,
                 float* covered);

// The same of one pixel.
float march_one(const ShadowScene& scene, int x, int y, float light_x, float light_y, float light_z);

}  // namespace tangi
