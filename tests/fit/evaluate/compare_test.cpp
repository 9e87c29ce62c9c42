#include "fit/evaluate/compare.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "capture/formats/lights_file.h"
#include "fit/evaluate/compare_page.h"
#include "fit/evaluate/contact_sheet.h"
#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;
const std::string kOddName = "a <b> & \"c\" é.png";

// A wavy, glossy surface with its photographs: four fitted, two held out. A corner was not measured.
Surface example_surface() {
    Surface s(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float u = static_cast<float>(x) * 0.3f, v = static_cast<float>(y) * 0.2f;
            s.height_mm(x, y) = 0.4f * std::sin(u) * std::cos(v);
            s.diffuse(x, y) = Rgb(0.5f + 0.3f * std::sin(v), 0.4f, 0.3f);
            s.specular(x, y) = 0.05f;
            s.roughness(x, y) = 0.2f;
            s.confidence(x, y) = x < 6 && y < 6 ? 0.0f : 1.0f;
        }
    s.normal = normals_of(s.height_mm, 1);
    s.photography.transfer = {Transfer::Kind::srgb};
    s.photography.white_level = 0.8;
    const std::vector<std::pair<std::string, Vec3>> lights = {
        {"east.png", {1, 0, 1}}, {"north.png", {0, 1, 1}},  {"west.png", {-1, 0.1f, 1}},
        {kOddName, {0, -1, 1}},  {"low.png", {1, 1, 0.5f}}, {"high.png", {0.2f, 0.1f, 1}}};
    for (const auto& [name, direction] : lights) {
        Light light = distant_light(direction, name);
        light.gain = Rgb(0.7f + 0.05f * static_cast<float>(s.photography.photos.size()));
        s.photography.photos.push_back({light, s.photography.photos.size() < 4});
    }
    return s;
}

// Writes what a camera would have seen of the surface, and garbage where it was not measured.
void write_photographs(const fs::path& folder, const Surface& s, const CompareOptions& options = {}) {
    std::vector<Light> lights;
    for (const Photography::Photo& photo : s.photography.photos) {
        Image<Rgb> linear =
            relight(s, {&photo.light, 1},
                    {.cast_shadows = options.cast_shadows, .light_radius_deg = options.light_radius_deg});
        for (Rgb& pixel : linear.pixels()) pixel *= static_cast<float>(s.photography.white_level);
        for (int y = 0; y < 6; ++y)
            for (int x = 0; x < 6; ++x) linear(x, y) = Rgb(1, 0, 1);
        write_picture(folder / photo.light.name, linear, s.photography.transfer);
        lights.push_back(photo.light);
    }
    write_lights_file(folder / "lights.lp", lights);
}

TEST(Compare, FindsPhotographsOfItsOwnModelEqualAndTellsHeldOutApart) {
    const TestDir folder;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    const CompareReport report = compare(surface, open_stack(folder.path()));
    ASSERT_EQ(report.photos.size(), 6u);
    for (const PhotoComparison& photo : report.photos) {
        EXPECT_GT(photo.psnr_db, 80) << photo.name;  // 16-bit codes and lights rounded to 6 decimals
        EXPECT_LE(photo.psnr_db, kPsnrCap_db);
        EXPECT_GT(photo.ssim, 0.9999) << photo.name;
        EXPECT_LT(photo.delta_e_2000_p95, 0.05) << photo.name;
        EXPECT_NEAR(photo.bias, 0, 1e-4) << photo.name;
        EXPECT_EQ(photo.fitted, photo.name != "low.png" && photo.name != "high.png") << photo.name;
    }
    EXPECT_EQ(report.held_out.count, 2);
    EXPECT_EQ(report.fitted.count, 4);
    EXPECT_EQ(report.all.count, 6);
    EXPECT_NEAR(report.all.psnr_db * 6, report.held_out.psnr_db * 2 + report.fitted.psnr_db * 4, 1e-6);
    EXPECT_NEAR(report.photos[0].elevation_deg, 45, 1e-4);
    EXPECT_NEAR(report.photos[0].azimuth_deg, 0, 1e-4);
    EXPECT_NEAR(report.photos[1].azimuth_deg, 90, 1e-4);
    EXPECT_THAT(report.warnings, testing::IsEmpty());
}

TEST(Compare, CountsPhotographsOfTheStackThatWereHeldOutOfIt) {
    const TestDir folder;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    Stack stack = open_stack(folder.path());
    hold_out(stack, "0:2");
    EXPECT_EQ(compare(surface, stack).all.count, 6);
}

TEST(Compare, MeasuresAKnownErrorAndItsSign) {
    const TestDir folder;
    Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    surface.photography.transfer = {};  // so that the stored values are off by a known factor only
    for (const Photography::Photo& photo : surface.photography.photos) {
        Image<Rgb> linear(kWidth, kHeight, Rgb(0.25f));
        write_picture(folder.path() / photo.light.name, linear, {});
    }
    for (Rgb& diffuse : surface.diffuse.pixels()) diffuse = Rgb(0);
    for (float& specular : surface.specular.pixels()) specular = 0;
    const CompareReport report = compare(surface, open_stack(folder.path()));
    EXPECT_NEAR(report.photos[0].bias, -0.25, 1e-4);
    EXPECT_NEAR(report.photos[0].psnr_db, -20 * std::log10(0.25), 1e-3);
}

TEST(Compare, NamesTheWorstPhotograph) {
    const TestDir folder;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    write_picture(folder / "west.png", Image<Rgb>(kWidth, kHeight, Rgb(0.5f)), {});
    EXPECT_EQ(compare(surface, open_stack(folder.path())).worst, "west.png");
}

TEST(Compare, TakesUnknownPhotographsForHeldOutWithGainOne) {
    const TestDir folder;
    Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    surface.photography.photos[1].light.name = "another.png";
    const CompareReport report = compare(surface, open_stack(folder.path()));
    EXPECT_FALSE(report.photos[1].fitted);
    EXPECT_EQ(report.photos[1].light.gain, Rgb(1));
    EXPECT_EQ(report.held_out.count, 3);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_THAT(report.warnings[0],
                HasSubstr("1 of 6 photographs are not among those that the painting lists"));
}

TEST(Compare, TakesAnotherLightOfTheSameNameForAnotherPhotograph) {
    const TestDir folder;
    Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    surface.photography.photos[0].light.direction = glm::normalize(Vec3(0, 0, 1));
    const CompareReport report = compare(surface, open_stack(folder.path()));
    EXPECT_FALSE(report.photos[0].fitted);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_THAT(report.warnings[0], HasSubstr("1 of 6 photographs are not among those"));
}

TEST(Compare, ComparesInTheEncodingOfThePhotographs) {
    const TestDir folder;
    Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    surface.photography.transfer = {};  // as if fitted from linear files
    Stack stack = open_stack(folder.path());
    stack.transfer = Transfer{Transfer::Kind::srgb};
    const CompareReport report = compare(surface, stack);
    EXPECT_GT(report.all.psnr_db, 80);
    EXPECT_EQ(report.transfer.name(), "srgb");
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_THAT(report.warnings[0],
                HasSubstr("compared as srgb; the painting was fitted from photographs stored as linear"));
}

TEST(Compare, NamesBothSizesWhereTheyDiffer) {
    const TestDir folder;
    Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    Surface other(kWidth + 1, kHeight);
    other.photography = surface.photography;
    const Stack stack = open_stack(folder.path());
    const std::string message = error_of([&] { compare(other, stack); });
    EXPECT_THAT(message, HasSubstr(folder.path().string()));
    EXPECT_THAT(message, HasSubstr("the photographs are 64 x 48, the painting is 65 x 48"));
    EXPECT_THAT(message, HasSubstr("with the same crop"));
}

TEST(Compare, NeedsAPaintingThatComesFromPhotographsAndWasMeasured) {
    const TestDir folder;
    Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    const Stack stack = open_stack(folder.path());
    Surface blank(kWidth, kHeight);
    EXPECT_THAT(error_of([&] { compare(blank, stack); }), HasSubstr("does not come from photographs"));
    blank.photography = surface.photography;
    EXPECT_THAT(error_of([&] { compare(blank, stack); }), HasSubstr("was measured nowhere"));
}

TEST(Compare, TellsPhotographsOfAnotherPainting) {
    const TestDir folder;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    EXPECT_EQ(compare(surface, open_stack(folder.path())).foreign, "");
    Surface other = surface;  // a quarter of a wave along both axes, other colours
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float u = static_cast<float>(x) * 0.37f, v = static_cast<float>(y) * 0.23f;
            other.height_mm(x, y) = 0.4f * std::cos(u) * std::sin(v);
            other.diffuse(x, y) = Rgb(0.5f + 0.3f * std::cos(1.3f * u), 0.5f, 0.5f);
        }
    other.normal = normals_of(other.height_mm, 1);
    const CompareReport report = compare(other, open_stack(folder.path()));
    EXPECT_THAT(report.foreign, HasSubstr("another painting"));
    EXPECT_EQ(to_json(report)["warnings"].back(), report.foreign) << "the page shows it, too";
}

TEST(Compare, StopsWhenAsked) {
    const TestDir folder;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    const Stack stack = open_stack(folder.path());
    EXPECT_THROW(compare(surface, stack, {}, [](std::string_view, double done) { return done < 0.4; }),
                 Cancelled);
}

TEST(WriteComparison, WritesNumbersAPageAndPicturesForEveryPhotograph) {
    const TestDir folder, empty;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    const fs::path out = empty.path() / "made" / "here";
    const CompareReport report = write_comparison(out, surface, open_stack(folder.path()));

    const auto json = read_json(read_text_file(out / "compare.json"), "JSON");
    ASSERT_EQ(json["photos"].size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        const auto& photo = json["photos"][i];
        EXPECT_EQ(photo["name"], report.photos[i].name);
        EXPECT_EQ(photo["fitted"], report.photos[i].fitted);
        for (const char* key :
             {"psnr_db", "ssim", "delta_e_2000", "delta_e_2000_p95", "bias", "elevation_deg"})
            EXPECT_TRUE(photo[key].is_number()) << key;
        EXPECT_EQ(photo["light"].size(), 3u);
        for (const char* key : {"photo", "relit", "error", "delta_e"}) {
            const Image<Rgb> picture = read_picture(out / photo["pictures"][key].get<std::string>());
            EXPECT_EQ(picture.width(), kWidth);
        }
    }
    EXPECT_EQ(json["mean"]["held_out"]["count"], 2);
    EXPECT_EQ(json["worst"], report.worst);

    const std::string page = read_text_file(out / "compare.html");
    EXPECT_THAT(page, HasSubstr("east.png"));
    EXPECT_THAT(page, HasSubstr("low.png"));
    EXPECT_THAT(page, testing::Not(HasSubstr("<b>")));  // of the odd name
    EXPECT_THAT(page, testing::Not(HasSubstr("{{")));
    EXPECT_THAT(page, testing::Not(testing::ContainsRegex("(src|href)=.http")));
    for (const char* key : {"height", "normal", "diffuse", "specular", "roughness", "confidence"})
        EXPECT_TRUE(fs::exists(out / fmt::format("pictures/map_{}.png", key))) << key;
}

// The text between the page's data tags, as a browser finds it.
std::string data_of(const std::string& page) {
    const std::string open = "<script type=\"application/json\" id=\"report\">";
    const auto begin = page.find(open) + open.size();
    return page.substr(begin, page.find("</script>", begin) - begin);
}

TEST(ComparisonPage, KeepsNamesTextWhateverTheyHold) {
    CompareReport report;
    for (const std::string& name : {std::string("</script><script>alert(1)</script>"),
                                    std::string("{{script}} $& \\ \""), std::string("latin1 \xe9.jpg")}) {
        PhotoComparison photo;
        photo.name = name;
        report.photos.push_back(photo);
    }
    report.warnings = {"<!-- careful"};
    const std::string page = comparison_page(to_json(report));
    const auto data = read_json(data_of(page), "JSON");
    EXPECT_EQ(data["photos"][0]["name"], report.photos[0].name);
    EXPECT_EQ(data["photos"][1]["name"], report.photos[1].name);
    EXPECT_EQ(data["photos"][2]["name"], "latin1 \xef\xbf\xbd.jpg");
    EXPECT_EQ(data["warnings"][0], report.warnings[0]);
    EXPECT_TRUE(data["mean"]["held_out"]["psnr_db"].is_null());
}

TEST(TypicalPhotos, SpreadFromTheWorstToTheBestHeldOutOne) {
    CompareReport report;
    for (int i = 0; i < 9; ++i) {
        PhotoComparison photo;
        photo.name = fmt::format("photo {}", i);
        photo.psnr_db = 20 + (i * 5) % 9;  // 20 25 21 26 22 27 23 28 24
        photo.fitted = i >= 7;
        report.photos.push_back(photo);
    }
    report.held_out.count = 7;
    EXPECT_THAT(typical_photos(report, 3), testing::ElementsAre("photo 0", "photo 6", "photo 5"));
    EXPECT_EQ(typical_photos(report, 100).size(), 7u);
    EXPECT_EQ(typical_photos(report, 1).size(), 1u);
}

TEST(ContactSheet, IsAsWideAsAskedAndShowsThePhotographs) {
    const TestDir folder;
    const Surface surface = example_surface();
    write_photographs(folder.path(), surface);
    const Stack stack = open_stack(folder.path());
    const CompareReport report = compare(surface, stack);
    const Image<Rgb> two = contact_sheet(surface, stack, report, {.width = 900, .photos = 2});
    const Image<Rgb> one = contact_sheet(surface, stack, report, {.width = 900, .photos = 1});
    EXPECT_EQ(two.width(), 900);
    EXPECT_GT(two.height(), one.height() + 200);
    for (const Rgb& pixel : two.pixels()) {
        ASSERT_GE(std::min({pixel.r, pixel.g, pixel.b}), 0);
        ASSERT_LE(std::max({pixel.r, pixel.g, pixel.b}), 1);
    }
    EXPECT_THAT(error_of([&] { contact_sheet(surface, stack, report, {.width = 5000}); }),
                HasSubstr("contact_sheet.width = 5000 is outside [480, 2400]"));
}

}  // namespace
}  // namespace tangi
