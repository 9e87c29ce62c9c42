// lights_format_test.cpp: laws of the table of lights-file formats: each is known by its name and by its text
// alone, and reads what is written in it.
#include "capture/formats/lights_format.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A small file of each format.
std::string sample_of(const LightsFormat& format) {
    static const std::map<std::string_view, std::string> samples = {
        {".lp", "2\na.png 0.6 0 0.8\nb.png 0 0.6 0.8\n"},
        {".dome", R"({"directions": [{"x": 0.6, "y": 0, "z": 0.8}, {"x": 0, "y": 0.6, "z": 0.8}]})"},
        {".relight",
         R"({"images": [{"filename": "a.png", "skip": false}],
             "dome": {"directions": [{"x": 0.6, "y": 0, "z": 0.8}]}})"},
        {".json",
         R"({"format": "tangipaint capture 1", "photographs": {"width": 41, "height": 31},
             "camera": {"position_mm": null, "mm_per_pixel": null}, "frame": {"origin_px": [20, 15]},
             "lights": [{"name": "a.png", "direction": [0.6, 0, 0.8], "position_mm": null}]})"}};
    EXPECT_TRUE(samples.contains(format.extension)) << format.extension << " has no sample";
    return samples.contains(format.extension) ? samples.at(format.extension) : std::string();
}

TEST(LightsFormats, HaveNamesAndExtensionsOfTheirOwn) {
    std::set<std::string_view> names, extensions;
    for (const LightsFormat& format : lights_formats()) {
        EXPECT_TRUE(names.insert(format.name).second) << format.name;
        EXPECT_TRUE(extensions.insert(format.extension).second) << format.extension;
        EXPECT_TRUE(format.extension.starts_with('.')) << format.extension;
        const std::string file = "A" + std::string(format.extension);
        EXPECT_EQ(lights_format_named(file), &format);
        EXPECT_EQ(&lights_format_of("/nowhere/" + file), &format);
    }
    EXPECT_EQ(lights_format_named("A.LP"), lights_format_named("b/a.lp"));
    EXPECT_EQ(lights_format_named("a.lpx"), nullptr);
    EXPECT_EQ(lights_format_named("lp"), nullptr);
}

TEST(LightsFormats, AreToldByTheirTextAlone) {
    const TestDir dir;
    for (const LightsFormat& format : lights_formats()) {
        const std::string text = sample_of(format);
        for (const LightsFormat& other : lights_formats())
            EXPECT_EQ(other.sniff(text), &other == &format) << other.name << " sniffs a " << format.name;
        write_bytes(dir / "lights.txt", text);
        EXPECT_EQ(&lights_format_of(dir / "lights.txt"), &format);
        for (const char* nothing : {"", "{}", "[1, 2]", "no lights at all", "\x89PNG\r\n"})
            EXPECT_FALSE(format.sniff(nothing)) << format.name << ": " << nothing;
    }
}

TEST(LightsFormats, ReadWhatIsWrittenInThem) {
    const TestDir dir;
    for (const LightsFormat& format : lights_formats()) {
        const fs::path path = dir / ("of" + std::string(format.extension));
        write_bytes(path, sample_of(format));
        EXPECT_TRUE(is_lights_file(path));
        const LightList list = read_lights(path);
        EXPECT_FALSE(list.lights.empty()) << format.name;
        EXPECT_EQ(list.lengths.size(), format.bare_vectors ? list.lights.size() : 0) << format.name;
        EXPECT_EQ(list.capture.has_value(), !format.bare_vectors) << format.name;
        EXPECT_EQ(list.capture && list.capture->width > 0, format.is_capture) << format.name;
    }
}

TEST(LightsFormats, HaveOneThatOtherNamesStandFor) {
    const auto bare = std::ranges::count_if(lights_formats(), &LightsFormat::bare_vectors);
    EXPECT_GE(bare, 1);
    EXPECT_TRUE(lights_format_of("/nowhere/lights.txt").bare_vectors);
    EXPECT_THAT(error_of([] { read_lights("/nowhere/lights.txt"); }), HasSubstr("no such lights file"));
}

TEST(LightsFormats, AreNoJsonOfAnotherKind) {
    const TestDir dir;
    write_bytes(dir / "palette.json", "{\"format\": \"tangipaint palette\", \"version\": 1}");
    EXPECT_FALSE(is_lights_file(dir / "palette.json"));
    EXPECT_FALSE(is_lights_file(dir / "missing.json"));
    EXPECT_FALSE(is_lights_file(dir / "photo.png"));
}

TEST(LightsFormats, AreListedInMessages) {
    EXPECT_EQ(extensions_in_words([](const LightsFormat& f) { return f.search != LightsSearch::never; }),
              ".lp, .dome or .relight");
    EXPECT_EQ(extensions_in_words([](const LightsFormat& f) { return f.bare_vectors; }), ".lp");
}

}  // namespace
}  // namespace tangi
