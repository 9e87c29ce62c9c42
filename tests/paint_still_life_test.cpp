// paint_still_life_test.cpp: the demonstration painting, small: it is a picture, and the same for any
// threads.
#include <gtest/gtest.h>

#include "paint/appearance.h"
#include "paint/session.h"
#include "paint/substrate.h"
#include "surface/painting_file.h"
#include "surface/parallel.h"
#include "tests/test_support.h"

namespace tangi {
namespace {

constexpr double kPixel = 1;  // [mm]

std::unique_ptr<Session> painted(int threads) {
    set_thread_count(threads);
    SubstrateOptions options;
    options.pixel_mm = kPixel;
    auto session = std::make_unique<Session>(
        std::make_shared<Surface>(make_substrate(SubstrateKind::linen, options)), artist_acrylics());
    replay(*session,
           read_journal(std::filesystem::path(TP_SOURCE_DIR) / "datasets/strokes/still_life.jsonl"));
    set_thread_count(0);
    return session;
}

// One that tests share.
const Session& still_life() {
    static const auto session = painted(1);
    return *session;
}

// The mean colour of 5 x 5 pixels around a place in mm.
Rgb colour_at(const Surface& s, double x_mm, double y_mm) {
    const int cx = static_cast<int>(std::lround(x_mm / kPixel + (s.width() - 1) / 2.0));
    const int cy = static_cast<int>(std::lround((s.height() - 1) / 2.0 - y_mm / kPixel));
    Rgb sum(0);
    for (int y = cy - 2; y <= cy + 2; ++y)
        for (int x = cx - 2; x <= cx + 2; ++x) sum += s.diffuse(x, y) / 25.0f;
    return sum;
}

TEST(StillLife, IsAPictureOfAJugAPearAnAppleAndALemon) {
    const Canvas& canvas = still_life().canvas();
    EXPECT_GE(still_life().totals().strokes, 200);
    EXPECT_GE(canvas.ingredients().size(), 12u);
    const Surface s = appearance(canvas);
    const Rgb jug = colour_at(s, -45, 5), shaded = colour_at(s, -14, -22), pear = colour_at(s, 28, -30),
              apple = colour_at(s, 70, -35), lemon = colour_at(s, 2, -50), table = colour_at(s, -80, -50);
    EXPECT_GT(jug.b, 1.3f * jug.r);
    EXPECT_GT(luminance(jug), 1.5f * luminance(shaded));
    EXPECT_GT(pear.g, 1.3f * pear.r);
    EXPECT_GT(pear.g, 3 * pear.b);
    EXPECT_GT(apple.r, 2.5f * apple.g);
    EXPECT_GT(lemon.r, 2.5f * lemon.b);
    EXPECT_GT(lemon.g, 0.45f * lemon.r);
    EXPECT_GT(table.r, 1.5f * table.b);
}

TEST(StillLife, IsThickHereAndBareThere) {
    const Canvas& canvas = still_life().canvas();
    std::vector<float> mm;
    for (int y = 0; y < canvas.height(); ++y)
        for (int x = 0; x < canvas.width(); ++x) {
            float sum = canvas.wet().thickness_mm(x, y);
            for (const DriedLayer& layer : canvas.dried()) sum += layer.paint.thickness_mm(x, y);
            mm.push_back(sum);
        }
    std::sort(mm.begin(), mm.end());
    EXPECT_GE(mm.front(), -1e-6f);
    EXPECT_LT(mm[mm.size() / 20], 0.01f);       // bare cloth between the strokes
    EXPECT_GT(mm[mm.size() / 2], 0.03f);        // covered
    EXPECT_GT(mm[mm.size() * 98 / 100], 0.2f);  // impasto
    EXPECT_LT(mm.back(), 8.0f);                 // but no towers
}

TEST(StillLife, IsTheSameOnAnyNumberOfThreads) {
    const Canvas& one = still_life().canvas();
    const auto session = painted(3);
    const Canvas& three = session->canvas();
    EXPECT_TRUE(identical(one.wet(), three.wet()));
    ASSERT_EQ(one.dried().size(), 1u);
    EXPECT_TRUE(identical(one.dried()[0].paint, three.dried()[0].paint));
    SubstrateOptions options;
    options.pixel_mm = kPixel;
    EXPECT_EQ(hash_of(one.dry()), hash_of(make_substrate(SubstrateKind::linen, options)));
}

}  // namespace
}  // namespace tangi
