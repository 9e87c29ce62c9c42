// data_test.cpp: what is suggested and filled on the rendered impasto painting, against its truth.
#include <gtest/gtest.h>

#include <iostream>

#include "fit/pipeline/fit_painting.h"
#include "retouch/damage/damage_suggestion.h"
#include "retouch/fill/fill.h"
#include "retouch/inpaint/quality.h"
#include "retouch/inpaint/retouch_modes.h"
#include "surface/image_file/image_io.h"
#include "tests/support/retouch/damage_truth.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

void record(const std::string& name, double value) {
    testing::Test::RecordProperty(name, fmt::format("{:.3f}", value));
    std::cout << fmt::format("[  FIGURE  ] impasto_{} {:.3f}\n", name, value);
}

// [mm] rms of the fill's outermost pixels against the true height of the surroundings: its mean over the
// pixels within `reach` that lie `past` beyond the rim. Heights have an unknown zero: both are compared about
// what is around the loss.
double border_rms_mm(const Image<float>& filled, const Image<float>& truth, const Mask& loss) {
    const Image<float> inside = distance_inside_px(loss);
    constexpr int reach = 5;
    constexpr float past = 2;
    double offset = 0, count = 0;
    for (int y = 0; y < loss.height(); ++y)
        for (int x = 0; x < loss.width(); ++x)
            if (inside(x, y) < -past && inside(x, y) > -past - reach) {
                offset += static_cast<double>(filled(x, y) - truth(x, y));
                count += 1;
            }
    offset /= count;
    double square = 0, border = 0;
    for (int y = 0; y < loss.height(); ++y)
        for (int x = 0; x < loss.width(); ++x) {
            if (!(inside(x, y) > 0 && inside(x, y) < 1.5f)) continue;
            double around = 0, seen = 0;
            for (int dy = -reach; dy <= reach; ++dy)
                for (int dx = -reach; dx <= reach; ++dx) {
                    const int px = std::clamp(x + dx, 0, loss.width() - 1),
                              py = std::clamp(y + dy, 0, loss.height() - 1);
                    if (inside(px, py) > -past) continue;
                    around += static_cast<double>(truth(px, py));
                    seen += 1;
                }
            if (seen == 0) continue;
            const double step = static_cast<double>(filled(x, y)) - offset - around / seen;
            square += step * step;
            border += 1;
        }
    return std::sqrt(square / border);
}

TEST(DataRetouch, ImpastosDamageIsSuggestedAndItsLossFilled) {
    TP_DATA(folder, "impasto");
    const auto truth = [&](const char* name) { return read_mask(folder / "gt" / name, 512, 512); };
    const Surface surface =
        fit_painting(open_stack(folder / "png16"), {.white_level = 0.75, .mm_per_pixel = 0.390625}).surface;
    const double mm = surface.mm_per_pixel;

    const Mask loss = suggest_loss(surface, mm).mask;
    record("loss_iou", intersection_over_union(loss, truth("loss.png")));
    EXPECT_GE(intersection_over_union(loss, truth("loss.png")), 0.8);
    const Mask cracks = suggest_craquelure(surface, mm).mask;
    record("craquelure_f1_2px", f1(cracks, truth("craquelure.png"), 2));
    EXPECT_GE(f1(cracks, truth("craquelure.png"), 2), 0.6);

    const GlossSuggestion gloss = suggest_gloss(surface, mm);
    const Mask varnish = truth("varnish.png"), retouch = truth("retouch.png");
    record("varnish_iou", intersection_over_union(gloss.glossier.mask, varnish));
    record("retouch_part_found_matt", sum(intersected(gloss.matter.mask, retouch)) / sum(retouch));
    EXPECT_GE(intersection_over_union(gloss.glossier.mask, varnish), 0.8);
    EXPECT_GE(sum(intersected(gloss.matter.mask, retouch)), 0.8 * sum(retouch));
    EXPECT_LE(sum(intersected(gloss.matter.mask, varnish)), 0.1 * sum(varnish));
    EXPECT_EQ(sum(intersected(gloss.glossier.mask, retouch)), 0);

    const Image<Rgb> height = read_picture(folder / "gt" / "height.exr");
    Image<float> height_mm(512, 512);
    for (std::size_t i = 0; i < height.size(); ++i) height_mm.pixels()[i] = height.pixels()[i].r;
    for (const FillTexture texture : {FillTexture::smooth, FillTexture::surroundings}) {
        Canvas canvas(std::make_shared<Surface>(surface));
        lay_fill(canvas, "fill 1", loss, {}, {texture, Rgb(0.8f)});
        const double rms = border_rms_mm(relief_of(canvas), height_mm, loss);
        record(fmt::format("fill_{}_border_rms_mm", name_of(texture)), rms);
        EXPECT_LE(rms, 0.1);
    }

    // Filled and retouched, it goes with what is around it under each illuminant; regions count by their
    // area.
    Canvas canvas(std::make_shared<Surface>(surface));
    const Mask lost = truth("loss.png");
    lay_fill(canvas, "fill 1", lost, {}, {FillTexture::surroundings, Rgb(0.8f)});
    lay_retouch(canvas, artist_acrylics(), lost, {}, {RetouchMode::mimetic, "retouch 1"});
    const std::array illuminants = {Illuminant::d65, Illuminant::a, Illuminant::f11};
    const QualityReport quality = quality_of(canvas, lost, {}, illuminants);
    for (const Illuminant illuminant : illuminants) {
        double sum = 0, area = 0;
        for (const RetouchQuality& region : quality.regions) {
            sum += region.area_mm2 * region.delta_e[static_cast<std::size_t>(illuminant)];
            area += region.area_mm2;
        }
        record(fmt::format("retouch_delta_e_2000_{}", name_of(illuminant)), sum / area);
        EXPECT_LE(sum / area, 3) << name_of(illuminant);
    }
}

}  // namespace
}  // namespace tangi
