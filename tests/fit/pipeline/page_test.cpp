// page_test.cpp: the sample's misfit, and the page that shows how photographs were understood.
#include "fit/pipeline/fit_report_page.h"

#include <gtest/gtest.h>

#include <limits>

#include "datasets/generator.h"
#include "surface/report/html_report.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

TEST(LightMisfit, IsTypicalByTheMedianOfWhatIsKnown) {
    const LightMisfit misfit{4, 1, {}, {{0.1f, kUnknown, 0.2f, 9.0f}, {kUnknown, kUnknown}}};
    EXPECT_FLOAT_EQ(misfit.typical(0).offset, 0.2f);
    EXPECT_FLOAT_EQ(misfit.typical(0).scatter, 1.4826f * 0.1f);
    EXPECT_EQ(misfit.typical(1).scatter, 0);
}

TEST(LightMisfit, MapHasTheNearestSample) {
    const LightMisfit misfit{8, 4, {{1, 2}, {7, 2}}, {{0.5f, -0.25f}}};
    const Image<float> map = misfit.map(0, 8);
    EXPECT_EQ(map.width(), 8);
    EXPECT_EQ(map.height(), 4);
    EXPECT_EQ(map(0, 0), 0.5f);
    EXPECT_EQ(map(7, 3), -0.25f);
    EXPECT_EQ(misfit.map(0, 4).width(), 4);
    EXPECT_TRUE(std::isnan(LightMisfit{8, 4, {}, {{}}}.map(0, 8)(0, 0)));
}

TEST(PageParts, ErrorsHaveTwoDigits) {
    EXPECT_EQ(with_error(1.23456, 0.0234), "1.235 ± 0.023");
    EXPECT_EQ(with_error(12.3, 4.5), "12.3 ± 4.5");
    EXPECT_EQ(with_error(1234.5, 67.8), "1234 ± 68");
}

TEST(PageParts, AnErrorNeverReadsZero) {
    EXPECT_EQ(plus_minus(0.0123, 3), " ± 0.012");
    EXPECT_EQ(plus_minus(0.00004, 4), " ± 0.00004");
    EXPECT_EQ(plus_minus(2e-7f, 4), " ± 0.0000002");
    EXPECT_EQ(plus_minus(0, 4), "");  // not known
}

TEST(PageParts, ALightWithoutAnErrorHasNone) {
    const glm::dvec3 up(0, 0, 1);
    const std::string lights =
        hemisphere({{.name = "sure", .direction = up, .listed = {}},
                    {.name = "off", .direction = up, .sigma_deg = 0.25, .listed = {}}});
    EXPECT_NE(lights.find("sure: elevation 90.0°<"), std::string::npos);
    EXPECT_NE(lights.find("off: elevation 90.0° ± 0.25°<"), std::string::npos);
}

TP_LONG TEST(FitPage, ShowsEachPhotographsLightAndMisfit) {
    const TestDir folder;
    write_stack(folder.path(), painting(32, 32), {.lights = 12, .held_out = 0, .gain_min = 0.5});
    Stack stack = open_stack(folder.path());
    stack.photos.front().light.name = "<b>&.png";  // a name may hold anything
    const FitResult fit = fit_painting(stack, {.white_level = 0.75});
    ASSERT_EQ(fit.report.misfit.log_ratios.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) {
        const LightMisfit::Typical typical = fit.report.misfit.typical(i);
        EXPECT_LT(std::abs(typical.offset), 0.1) << i;
        EXPECT_LT(typical.scatter, 0.2) << i;
        EXPECT_GT(typical.scatter, 0) << i;
    }
    const std::string page = fit_page(fit, "a <fit>", folder / "page.html");
    // Not as matchers: a failure would print all pictures.
    const auto has = [&](const char* text) { return page.find(text) != std::string::npos; };
    for (const char* part :
         {"<title>a &lt;fit&gt;</title>", "&lt;b&gt;&amp;.png", "strength", "Transfer curve", "Misfit",
          "validation photographs, dB", "data:image/jpeg;base64,/9j/", "</html>"})
        EXPECT_TRUE(has(part)) << part;
    for (const char* part : {"<b>&.png", ">nan", "-nan"}) EXPECT_FALSE(has(part)) << part;
}

}  // namespace
}  // namespace tangi
