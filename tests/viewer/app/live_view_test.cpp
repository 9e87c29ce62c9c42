// live_view_test.cpp: pictures that move are coarser where that is faster, and nowhere else.
#include "viewer/app/live_view.h"

#include <gtest/gtest.h>

namespace tangi {
namespace {

struct Machine {
    double sharp_s, enlarge_s;  // to draw a sharp picture, and to enlarge a coarser one
};

// What a frame takes in the end; `coarse`: how many of these frames were coarse.
double settled_s(Coarseness& coarseness, const Machine& machine, int* coarse = nullptr) {
    double frame_s = 0;
    for (int i = 0; i < 200; ++i) {
        const double scale = coarseness.scale(), draw_s = machine.sharp_s * scale * scale;
        if (coarse) *coarse += scale < 1;
        frame_s = draw_s + (scale < 1 ? machine.enlarge_s : 0);
        coarseness.took(draw_s, scale < 1 ? machine.enlarge_s : 0);
    }
    return frame_s;
}

TEST(Coarseness, WhatIsFastIsSharp) {
    Coarseness coarseness;
    int coarse = 0;
    settled_s(coarseness, {0.005, 0.001}, &coarse);
    EXPECT_EQ(coarse, 0);
}

TEST(Coarseness, SlowDevicesThatEnlargeForNothingKeepUp) {
    for (const double sharp_s : {0.017, 0.04, 0.1}) {
        Coarseness coarseness;
        EXPECT_LE(settled_s(coarseness, {sharp_s, 0.0003}), 1 / 60.0) << sharp_s;
        EXPECT_GT(coarseness.scale() * coarseness.scale() * sharp_s, 0.3 / 60)
            << "and no coarser than it must be";
        settled_s(coarseness, {0.004, 0.0003});
        EXPECT_EQ(coarseness.scale(), 1) << "sharp again where it can be";
    }
}

// llvmpipe on two cores: 1920 x 1080 pixels.
TEST(Coarseness, NothingIsCoarseThatIsNotFasterSo) {
    Coarseness coarseness;
    int coarse = 0;
    EXPECT_DOUBLE_EQ(settled_s(coarseness, {0.02, 0.012}, &coarse), 0.02);
    EXPECT_LE(coarse, 2) << "it has to be tried once";
    const double slow_s = settled_s(coarseness, {0.06, 0.01});
    EXPECT_LT(slow_s, 0.018);
    EXPECT_LT(coarseness.scale(), 0.5);
}

}  // namespace
}  // namespace tangi
