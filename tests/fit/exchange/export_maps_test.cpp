// export_maps_test.cpp: the numbers of exported pictures, as a page in a browser has them.
#include "fit/exchange/export_maps.h"

#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "surface/file/base64.h"
#include "surface/report/png_encode.h"
#include "tests/programs/support/browser.h"

namespace tangi {
namespace {

constexpr int kSide = 12;

// Slopes, gloss and colours of all sizes.
Surface varied_surface(bool coloured) {
    Random random(7);
    Surface s(kSide, kSide);
    for (std::size_t i = 0; i < s.normal.size(); ++i) {
        s.normal.pixels()[i] =
            glm::normalize(Vec3(random.real(-1, 1), random.real(-1, 1), random.real(0.3, 1)));
        s.diffuse.pixels()[i] = {random.real(0, 1), random.real(0, 1), random.real(0, 1)};
        s.specular.pixels()[i] = static_cast<float>(random.real(0, 0.5));
        s.roughness.pixels()[i] = static_cast<float>(random.real(0.05, 0.5));
        s.confidence.pixels()[i] = 1;
    }
    if (coloured) s.specular_colour = Image<Rgb>(kSide, kSide, Rgb(1, 0.7f, 0.3f));
    return s;
}

class PicturesInABrowser : public testing::Test {
protected:
    void SetUp() override {
        if (browser_program().empty()) GTEST_SKIP() << "no Chromium here (Debian: chromium-headless-shell)";
        browser_.emplace(scratch_.path());
        write_text_file(scratch_ / "page.html", "<canvas id=canvas></canvas>");
        browser_->open("file://" + (scratch_ / "page.html").string(), 100, 100);
        ASSERT_TRUE(browser_->becomes_true(
            "document.readyState === 'complete' && !!document.getElementById('canvas')"));
    }
    // What a script reads back of a PNG picture that it drew on a canvas, 0..1.
    Image<Rgb> read_back(const std::string& png) {
        browser_->evaluate(fmt::format(
            "{{ window.numbers = null; const picture = new Image(); picture.onload = () => {{"
            "const canvas = document.getElementById('canvas'), c = canvas.getContext('2d');"
            "canvas.width = picture.width; canvas.height = picture.height; c.drawImage(picture, 0, 0);"
            "window.numbers = [...c.getImageData(0, 0, picture.width, picture.height).data]; }};"
            "picture.src = 'data:image/png;base64,{}'; }}",
            base64(png)));
        EXPECT_TRUE(browser_->becomes_true("window.numbers !== null"));
        const nlohmann::json numbers = browser_->evaluate("window.numbers");
        Image<Rgb> read(kSide, kSide);
        EXPECT_EQ(numbers.size(), 4 * read.size());
        for (std::size_t i = 0; i < read.size() && 4 * i + 3 < numbers.size(); ++i)
            for (int c = 0; c < 3; ++c)
                read.pixels()[i][c] = numbers[4 * i + static_cast<std::size_t>(c)].get<float>() / 255;
        return read;
    }

    TestDir scratch_;
    std::optional<Browser> browser_;
};

float largest_difference(const Image<Rgb>& a, const Image<Rgb>& b) {
    float most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a.pixels()[i][c] - b.pixels()[i][c]));
    return most;
}

constexpr float kRounding = 0.51f / 255, kCutOff = 1.01f / 255;  // of 16 bits browsers keep the upper 8

TEST_F(PicturesInABrowser, OfOpenLimeAreTheNumbersOfThePainting) {
    for (const bool coloured : {false, true}) {
        const Surface s = varied_surface(coloured);
        const auto folder = scratch_ / "openlime";
        write_openlime(folder, s);
        const auto limits =
            read_json(read_text_file(folder / "brdf.json"), "JSON")["alphaLimits"].get<std::vector<double>>();
        Image<Rgb> kd = s.diffuse, ks(kSide, kSide), normals = s.normal, gloss(kSide, kSide);
        const double rough = 1 - std::pow(limits[1], 0.25), smooth = 1 - std::pow(limits[0], 0.25);
        for (std::size_t i = 0; i < kd.size(); ++i) {
            kd.pixels()[i] = Transfer{Transfer::Kind::srgb}.encode(kd.pixels()[i]);
            ks.pixels()[i] = s.specular.pixels()[i] * (coloured ? s.specular_colour.pixels()[i] : Rgb(1));
            normals.pixels()[i] = (normals.pixels()[i] + 1.0f) / 2.0f;
            gloss.pixels()[i] = Rgb(
                static_cast<float>((1 - rough - std::pow(s.roughness.pixels()[i], 0.25)) / (smooth - rough)));
        }
        const auto in_browser = [&](const char* file) { return read_back(read_text_file(folder / file)); };
        EXPECT_LE(largest_difference(in_browser("kd.png"), kd), kRounding);
        EXPECT_LE(largest_difference(in_browser("ks.png"), ks), kRounding);
        EXPECT_LE(largest_difference(in_browser("normals.png"), normals), kRounding);
        EXPECT_LE(largest_difference(in_browser("gloss.png"), gloss), kRounding);
    }
}

// Snapshots, pictures in OpenRaster files; and what is no colour: masks, heights in OpenRaster files.
TEST_F(PicturesInABrowser, AreAsTheyWereWritten) {
    const Surface s = varied_surface(false);
    Image<Rgb> encoded = s.diffuse, grey(kSide, kSide);
    for (Rgb& c : encoded.pixels()) c = Transfer{Transfer::Kind::srgb}.encode(c);
    for (std::size_t i = 0; i < grey.size(); ++i) grey.pixels()[i] = Rgb(s.specular.pixels()[i]);
    write_picture(scratch_ / "snapshot.png", s.diffuse, {Transfer::Kind::srgb});
    EXPECT_LE(largest_difference(read_back(read_text_file(scratch_ / "snapshot.png")), encoded), kCutOff);
    EXPECT_LE(largest_difference(read_back(png_bytes(encoded)), encoded), kRounding);
    EXPECT_LE(largest_difference(read_back(png_bytes(s.specular, 8)), grey), kRounding);
    write_map(scratch_ / "mask.png", s.specular, {.bits = 8});
    EXPECT_LE(largest_difference(read_back(read_text_file(scratch_ / "mask.png")), grey), kRounding);
    // A picture in linear light says so, and is shown as it should look: but for a step of 8 bits where sRGB
    // is steepest.
    write_picture(scratch_ / "linear.png", s.diffuse, Transfer{});
    EXPECT_LE(largest_difference(read_back(read_text_file(scratch_ / "linear.png")), encoded), 12.92f / 255);
}

}  // namespace
}  // namespace tangi
