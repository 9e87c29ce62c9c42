// still_life_test.cpp: the demonstration paintings, small: they are pictures, and the same for any
// threads.
#include <gtest/gtest.h>

#include <set>

#include "paint/canvas/appearance.h"
#include "paint/session/session.h"
#include "paint/substrate/substrate.h"
#include "surface/base/parallel.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

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
    const Rgb jug = colour_at(s, -45, 5), shaded = colour_at(s, -14, -22), pear = colour_at(s, 38, -34),
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

TP_LONG TEST(StillLife, IsTheSameOnAnyNumberOfThreads) {
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

Journal landscape() {
    return read_journal(std::filesystem::path(TP_SOURCE_DIR) / "datasets/strokes/landscape.jsonl");
}

TP_LONG TEST(Landscape, IsTenMinutesWithTheBrushOnThePainting) {
    double seconds = 0, last = 0;
    std::set<std::string> shapes;
    int strokes = 0, sittings = 0, glazes = 0, tilted = 0, turned = 0;
    for (const Journal::Entry& entry : landscape().entries) {
        if (const auto* stroke = std::get_if<StrokeEvent>(&entry.event)) {
            ++strokes;
            shapes.insert(traits_of(stroke->brush.shape).name);
            glazes += stroke->finish.medium > 0.9;
            last = 0;
        } else if (const auto* point = std::get_if<PointEvent>(&entry.event)) {
            seconds += point->point.time_s - last;
            last = point->point.time_s;
            tilted += point->point.tilt_x != 0 || point->point.tilt_y != 0;
            turned += point->point.rotation_deg != 0;
        }
        sittings += std::holds_alternative<DryEvent>(entry.event);
    }
    EXPECT_GE(seconds, 600);
    EXPECT_GE(strokes, 1000);
    EXPECT_EQ(shapes, (std::set<std::string>{"filbert", "flat", "knife", "rag", "round"}));
    EXPECT_EQ(sittings, 3);
    EXPECT_GE(glazes, 20);
    EXPECT_GE(tilted, 1000);
    EXPECT_GE(turned, 500);
}

TP_LONG TEST(Landscape, IsAPictureOfSkyAndFields) {
    SubstrateOptions options;
    options.pixel_mm = 1;
    Session session(std::make_shared<Surface>(make_substrate(SubstrateKind::linen, options)),
                    artist_acrylics());
    replay(session, landscape());
    const Surface s = appearance(session.canvas());
    const auto colour = [&](double x_mm, double y_mm) {
        Rgb sum(0);
        for (int k = 0; k < 9; ++k)
            sum += s.diffuse(static_cast<int>(std::lround(x_mm + (s.width() - 1) / 2.0)) + 2 * (k % 3 - 1),
                             static_cast<int>(std::lround((s.height() - 1) / 2.0 - y_mm)) + 2 * (k / 3 - 1)) /
                   9.0f;
        return sum;
    };
    const Rgb sky = colour(70, 66), field = colour(-40, -40), cloud = colour(-50, 45);
    EXPECT_GT(sky.b, 1.5f * sky.r);
    EXPECT_GT(cloud.r, 1.5f * sky.r);
    EXPECT_GT(field.g, 2 * field.b);
    EXPECT_EQ(session.canvas().dried().size(), 3u);
}

}  // namespace
}  // namespace tangi
