// lossy_tiles_test.cpp: tiles with losses relight as well as they say, in C++ and in a browser.
#include "viewer/web/lossy_tiles.h"

#include "surface/image/metrics.h"
#include "tests/viewer/web/page_support.h"
#include "viewer/web/web_page.h"
#include "viewer/web/web_tiles.h"

namespace tangi {
namespace {

// As paintings are, and noise is not: smooth in most places.
Surface soft_surface(int width, int height) {
    Surface s = painted_surface(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = static_cast<float>(x) / 40, v = static_cast<float>(y) / 30;
            s.height_mm(x, y) = 0.3f * std::sin(2 * u) * std::cos(3 * v);
            s.diffuse(x, y) = {0.4f + 0.3f * std::sin(u + v), 0.4f + 0.2f * std::cos(v),
                               x > width / 2 ? 0.5f : 0.2f};
            s.specular(x, y) = 0.05f + 0.03f * std::cos(u);
            s.roughness(x, y) = 0.25f + 0.1f * std::sin(v);
            s.confidence(x, y) = 1;
        }
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    return s;
}

const std::vector<Light> kTwoLights = {distant_light(direction_of(130, 50)),
                                       distant_light(direction_of(20, 15))};

double psnr_of(const Surface& s, const TexelTiles& tiles, int quality) {
    return error_of(lossy_tile(tiles, {0, 0, 0}, quality), s, tiles, {0, 0, 0}, kTwoLights).psnr_db();
}

TEST(LossyTiles, AreSmallerTheMoreTheyLose) {
    const Surface s = soft_surface(250, 203);
    const TexelTiles tiles(s, range_of(s));
    double better = 99;
    std::size_t larger = web_tile(tiles, {0, 0, 0}).size();
    for (const int quality : {95, 75, 50, 25}) {
        const double psnr = psnr_of(s, tiles, quality);
        EXPECT_LT(psnr, better) << quality;
        EXPECT_GT(psnr, 30) << quality;
        const std::size_t size = lossy_tile(tiles, {0, 0, 0}, quality).size();
        EXPECT_LT(size, larger) << quality;
        better = psnr;
        larger = size;
    }
}

TEST(LossyTiles, HaveTheLowestQualityThatIsGoodEnough) {
    const Surface s = soft_surface(250, 203);
    const TexelTiles tiles(s, range_of(s));
    for (const double wanted : {45.0, 48.0}) {
        const int quality = quality_for(wanted, s, tiles, kTwoLights);
        EXPECT_GE(psnr_of(s, tiles, quality), wanted);
        EXPECT_LT(psnr_of(s, tiles, quality - 1), wanted + 0.2) << "but for a step that is none";
    }
    EXPECT_EQ(quality_for(90, s, tiles, kTwoLights), kBestQuality);
}

// Of lobes with colours, which channel is the largest is no number to be blurred.
TEST(LossyTiles, KeepWhatIsNoNumberExactly) {
    for (const Surface& s : {gilded_surface(120, 90), brushed_surface(120, 90)}) {
        const TexelTiles tiles(s, range_of(s));
        std::vector<WebField> exact;
        for (const WebField& field : web_fields(tiles.range()))
            if (field.packing == Packing::exact) exact.push_back(field);
        ASSERT_EQ(exact.size(), 3u);
        const std::string packed = lossy_tile(tiles, {0, 0, 0}, 50),
                          whole = web_tile(tiles, {0, 0, 0}, exact);
        EXPECT_TRUE(packed.ends_with(whole));
        EXPECT_GT(error_of(packed, s, tiles, {0, 0, 0}, kTwoLights).psnr_db(), 10);
    }
}

// The page in a browser is as good as the export has measured, and knows how good its heights are.
TP_LONG TEST_F(WebPageInABrowser, RelightsWithLossesAsItSays) {
    for (const bool gilded : {false, true}) {
        Surface s = soft_surface(kWidth, kHeight);
        if (gilded) s.specular_colour = Image<Rgb>(kWidth, kHeight, Rgb(1, 0.8f, 0.3f));
        const WebReport report =
            write_web_page(scratch_ / "page", s, {.title = "Soft"},
                           {.light_azimuth_deg = 130, .light_elevation_deg = 40, .lossy_psnr_db = 38});
        const WebReport whole = write_web_page(scratch_ / "whole", s, {.title = "Soft"});
        EXPECT_GE(report.psnr_db, 38);
        EXPECT_LT(report.bytes, whole.bytes);
        EXPECT_LT(report.height_rms, 0.02);
        double squared = 0;
        for (const auto& [azimuth, elevation] : {std::pair{130.0, 40.0}, {130.0, 15.0}, {220.0, 15.0}}) {
            open(url_of(scratch_ / "page/index.html", azimuth, elevation));
            const Transfer srgb{Transfer::Kind::srgb};
            Image<Rgb> seen = middle_of(browser_->screenshot()), wanted = reference(s, azimuth, elevation);
            for (Image<Rgb>* picture : {&seen, &wanted})
                for (Rgb& c : picture->pixels()) c = glm::clamp(srgb.encode(c), 0.0f, 1.0f);
            squared += std::pow(10, -psnr_db(seen, wanted) / 10) / 3;
        }
        // The page's eye is near, and its picture has 8 bits.
        EXPECT_NEAR(-10 * std::log10(squared), report.psnr_db, 1) << gilded;
    }
    EXPECT_EQ(browser_->errors, "");
    EXPECT_TRUE(std::ranges::any_of(browser_->requests, [](const std::string& url) {
        return url.starts_with("blob:");
    })) << "a worker decodes";
}

}  // namespace
}  // namespace tangi
