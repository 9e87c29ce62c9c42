// lights_file_test.cpp: .lp files as they occur, and what is said of those that are none.
#include "capture/formats/lights_file.h"
#include "capture/photo/photo_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

LightsFile parse(const std::string& text) { return parse_lights(text, "x.lp"); }

std::string error_in(const std::string& text) {
    return error_of([&] { parse(text); });
}

void expect_light(const Light& light, const std::string& name, const Vec3& direction) {
    EXPECT_EQ(light.name, name);
    EXPECT_LE(glm::length(light.direction - glm::normalize(direction)), 1e-6f) << name;
}

void expect_a_and_b(const LightsFile& file) {
    ASSERT_EQ(file.lights.size(), 2u);
    expect_light(file.lights[0], "a.jpg", {0, 0, 1});
    expect_light(file.lights[1], "b.jpg", {0.6f, 0, 0.8f});
    EXPECT_THAT(file.warnings, IsEmpty());
}

TEST(LightsFile, NamesMayBeQuoted) {
    const LightsFile file = parse_lights("2\n\"a b.png\" 0 0 1\n\"c.png\" 1 0 1\n", "x.lp");
    EXPECT_EQ(file.lights[0].name, "a b.png");
    EXPECT_EQ(file.lights[1].name, "c.png");
}

TEST(LightsFile, IsACountAndALineForEachPhotograph) {
    const LightsFile file = parse("2\na.jpg 0 0 1\nb.jpg 0.6 0 0.8\n");
    expect_a_and_b(file);
    EXPECT_EQ(file.lights[0].gain, Rgb(1));
    EXPECT_FALSE(file.lights[0].position_mm);
}

TEST(LightsFile, MayHoldNamesWithSpacesNumbersAndFolders) {
    const LightsFile file =
        parse("4\nDay 2/photo no 1 .jpg 0 0 1\nC:\\scans\\img 02.tif 1 0 1\n0.5 0.5 0 1 1\né–ü.png 0 1 0\n");
    ASSERT_EQ(file.lights.size(), 4u);
    expect_light(file.lights[0], "Day 2/photo no 1 .jpg", {0, 0, 1});
    expect_light(file.lights[1], "C:\\scans\\img 02.tif", {1, 0, 1});
    expect_light(file.lights[2], "0.5 0.5", {0, 1, 1});
    expect_light(file.lights[3], "é–ü.png", {0, 1, 0});
}

TEST(LightsFile, MayHaveWindowsLineEndsTabsAndAByteOrderMark) {
    const LightsFile file = parse("\xEF\xBB\xBF 2 \r\na.jpg\t0\t0\t1\r\n\tb.jpg  0.6 \t 0   0.8 \t\r\n");
    expect_a_and_b(file);
}

TEST(LightsFile, MayHaveLinesThatEndWithACarriageReturn) {
    const LightsFile file = parse("2\ra.jpg 0 0 1\rb.jpg 0.6 0 0.8\r");
    expect_a_and_b(file);
}

TEST(LightsFile, MayHaveBlankLinesAnywhereAndNoLastLineEnd) {
    const LightsFile file = parse("\n\n2\n\na.jpg 0 0 1\n  \t\n\nb.jpg 1 0 0\n\n\n");
    EXPECT_EQ(file.lights.size(), 2u);
    EXPECT_THAT(file.warnings, IsEmpty());
    EXPECT_EQ(parse("1\na.jpg 0 0 1").lights.size(), 1u);
}

TEST(LightsFile, MayHaveDecimalCommasSignsAndExponents) {
    const LightsFile file = parse("2\na.jpg -0,6 +0,0 0,8\nb.jpg 6e-1 -0.0 8E-1\n");
    expect_light(file.lights.at(0), "a.jpg", {-0.6f, 0, 0.8f});
    expect_light(file.lights.at(1), "b.jpg", {0.6f, 0, 0.8f});
}

TEST(LightsFile, HasItsVectorsNormalisedWhateverTheirLength) {
    for (const char* length : {"0.001", "0.5", "17", "1e30", "1e200", "1e308"}) {
        const LightsFile file = parse(fmt::format("1\na.jpg {0} -{0} {0}\n", length));
        expect_light(file.lights.at(0), "a.jpg", {1, -1, 1});
    }
}

TEST(LightsFile, WithoutACountIsReadWithAWarning) {
    const LightsFile file = parse("a.jpg 0 0 1\nb.jpg 1 0 1\n");
    EXPECT_EQ(file.lights.size(), 2u);
    EXPECT_THAT(file.warnings, ElementsAre("x.lp: the first line is not a count of lights"));
}

TEST(LightsFile, WithAnotherCountThanLinesIsReadWithAWarning) {
    EXPECT_THAT(parse("3\na.jpg 0 0 1\nb.jpg 1 0 1\n").warnings,
                ElementsAre("x.lp: its first line says 3 lights, but 2 follow; all 2 are used"));
    EXPECT_THAT(parse("-1\na.jpg 0 0 1\n").warnings,
                ElementsAre("x.lp: its first line says -1 lights, but 1 follow; all 1 are used"));
}

TEST(LightsFile, WithAZeroVectorIsAnError) {
    EXPECT_EQ(error_in("2\na.jpg 0 0 1\nb.jpg 0 0 -0.0\n"),
              "x.lp, line 3: the light of 'b.jpg' is a zero vector; give a direction or remove the line");
}

TEST(LightsFile, WithNanOrInfinityIsAnError) {
    for (const char* word : {"nan", "NaN", "inf", "-inf", "Infinity"})
        EXPECT_EQ(error_in(fmt::format("1\n\na.jpg 0 {} 1\n", word)),
                  "x.lp, line 3: the light of 'a.jpg' is not finite; give a direction or remove the line")
            << word;
}

TEST(LightsFile, WithTooFewColumnsIsAnError) {
    EXPECT_EQ(error_in("1\na.jpg 0 1\n"), "x.lp, line 2: expected 'name x y z', but 'a.jpg' is not a number");
    EXPECT_EQ(error_in("1\n0 0 1\n"),
              "x.lp, line 2: expected 'name x y z', but the photograph's name is missing");
    EXPECT_THAT(error_in("1\na.jpg\n"), StartsWith("x.lp, line 2: expected 'name x y z', but 'a.jpg'"));
    EXPECT_THAT(error_in("1\n5\n"), StartsWith("x.lp, line 2: expected 'name x y z'"));
}

TEST(LightsFile, WithANumberThatIsTooLargeIsAnError) {
    for (const char* word : {"1e400", "-1E+400"})
        EXPECT_EQ(
            error_in(fmt::format("1\na.jpg 0 {} 1\n", word)),
            fmt::format("x.lp, line 2: '{}' is out of range; only the light's direction counts, so give a "
                        "smaller vector",
                        word));
    expect_light(parse("1\na.jpg 0 1e-400 1\n").lights.at(0), "a.jpg", {0, 0, 1});
}

TEST(LightsFile, ThatIsBinaryIsAnErrorWithoutItsBytes) {
    using testing::HasSubstr;
    EXPECT_EQ(error_in(std::string("\xFF\xFE") + std::string("1\0\n\0", 4)),
              "x.lp: is UTF-16 text; save it as UTF-8");
    EXPECT_THAT(error_in("1\na.jpg 0 0 \x1b[2J\n"), HasSubstr("but '\\x1b[2J' is not a number"));
    EXPECT_THAT(error_in("1\na.jpg 0 0 \xC2\x9B\x31\n"), HasSubstr("but '\\xc2\\x9b1' is not a number"));
    EXPECT_THAT(error_in("1\n\x07é\xE9 0 0 0\n"), HasSubstr("the light of '\\x07é\\xe9' is a zero vector"));
    EXPECT_THAT(error_in("2\n\x07 0 0 1\n\x07 0 1 1\n"), HasSubstr("'\\x07' has a light in line 2"));
    Random random(1);
    std::string bytes = "1\n";
    for (int i = 0; i < 100000; ++i) bytes += static_cast<char>('\x0b' + random.below(245));
    const std::string message = error_in(bytes);
    EXPECT_LT(message.size(), 200u);
    for (const char c : message) EXPECT_FALSE(static_cast<unsigned char>(c) < 0x20) << message;
}

TEST(LightsFile, WithTextInsteadOfANumberIsAnError) {
    EXPECT_EQ(error_in("1\na.jpg 0 up 1\n"), "x.lp, line 2: expected 'name x y z', but 'up' is not a number");
    EXPECT_EQ(error_in("1\na.jpg 0 0 1;\n"), "x.lp, line 2: expected 'name x y z', but '1;' is not a number");
    EXPECT_EQ(error_in("1\na.jpg 0 0 0x1\n"),
              "x.lp, line 2: expected 'name x y z', but '0x1' is not a number");
    EXPECT_EQ(error_in("16 lights\na.jpg 0 0 1\n"),
              "x.lp, line 1: expected 'name x y z', but 'lights' is not a number");
}

TEST(LightsFile, ThatIsEmptyIsAnError) {
    const char* expected =
        "x.lp: holds no lights; expected a count, then a line 'name x y z' for each photograph";
    for (const char* text : {"", "\n\n", "12\n", "\xEF\xBB\xBF", "0\n  \n"})
        EXPECT_EQ(error_in(text), expected);
}

// Few among many lines that are lights: the photographs are rejected, the line is named.
TEST(LightsFile, PassesOverFewLinesThatAreNone) {
    const std::string good = "a.jpg 0 0 1\nb.jpg 1 0 1\nc.jpg 0 1 1\nd.jpg 1 1 1\n";
    for (const char* bad : {"e.jpg 0 nan 1", "e.jpg 0 0 0", "e.jpg 0 up 1"}) {
        const LightsFile file = parse("5\n" + good + bad + "\n");
        EXPECT_EQ(file.lights.size(), 4u) << bad;
        ASSERT_EQ(file.rejected.size(), 1u) << bad;
        EXPECT_EQ(file.rejected[0].name, "e.jpg") << bad;
        EXPECT_THAT(file.warnings, testing::ElementsAre(testing::AllOf(StartsWith("x.lp, line 6: "),
                                                                       testing::HasSubstr("rejected"))))
            << bad;
    }
    const LightsFile twice = parse("6\n" + good + "e.jpg 1 2 3\nb.jpg 0 1 1\nf.jpg 0 2 1\n");
    EXPECT_EQ(twice.lights.size(), 5u);  // neither of the two of b.jpg
    for (const Light& light : twice.lights) EXPECT_NE(light.name, "b.jpg");
    const LightsFile same = parse("5\n" + good + "b.jpg 2 0 2\n");
    EXPECT_EQ(same.lights.size(), 4u);
    EXPECT_TRUE(same.rejected.empty());
}

TEST(LightsFile, WithANameTwiceIsAnError) {
    EXPECT_EQ(error_in("3\na.jpg 0 0 1\nb.jpg 1 0 1\na.jpg 0 1 1\n"),
              "x.lp, line 4: 'a.jpg' has a light in line 2 already");
}

TEST(LightsFile, ThatIsMissingOrAFolderIsAnError) {
    const TestDir dir;
    EXPECT_EQ(error_of([] { read_lights_file("/nowhere/x.lp"); }), "/nowhere/x.lp: no such lights file");
    EXPECT_EQ(error_of([&] { read_lights_file(dir.path()); }),
              dir.path().string() + ": is a folder; name the lights file (.lp) in it");
}

TEST(LightsFile, ThatIsAPictureOrNoTextIsAnErrorThatSaysSo) {
    const TestDir dir;
    for (const char* name : {"x.png", "x.jpg", "x.tif"}) {
        write_picture_8bit(dir / name, Image<Rgb>(9, 9, Rgb(0.3f)));
        EXPECT_EQ(
            error_of([&] { read_lights_file(dir / name); }),
            (dir / name).string() +
                ": is a picture, and no lights file (.lp); name the list of photographs and their lights");
    }
    EXPECT_THAT(error_in(std::string("\0\0\0\030ftyp", 8)), StartsWith("x.lp: is no text"));
    // Damaged further on, it is a lights file still.
    std::string text =
        "3\n" + std::string(60, '\n') + "a.jpg 0 0 1\nb.jpg 1 0 1\nc.jpg 0 1 1\nd.jpg 0 \x7f 1\n";
    text[text.find('\x7f')] = '\0';
    EXPECT_EQ(parse(text).lights.size(), 3u);
}

TEST(LightsFile, RoundTripsWithinItsSixDecimals) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(30, 1);
    lights[3].name = "folder/a name with 3 spaces";
    write_lights_file(dir / "x.lp", lights);
    const LightsFile back = read_lights_file(dir / "x.lp");
    EXPECT_THAT(back.warnings, IsEmpty());
    ASSERT_EQ(back.lights.size(), lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        EXPECT_EQ(back.lights[i].name, lights[i].name);
        EXPECT_LE(glm::length(back.lights[i].direction - lights[i].direction), 2e-6f);
    }
    EXPECT_THAT(bytes_of(dir / "x.lp"), StartsWith("30\nphoto_000.png "));
}

TEST(DataLightsFile, OfEveryStackIsRead) {
    TP_DATA(real, "real");
    int files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(real)) {
        if (entry.path().extension() != ".lp") continue;
        ++files;
        const LightsFile file = read_lights_file(entry.path());
        EXPECT_GE(file.lights.size(), 40u) << entry.path();
        for (const Light& light : file.lights)
            EXPECT_NEAR(glm::length(light.direction), 1, 1e-6) << light.name;
    }
    EXPECT_GE(files, 6);
}

TEST(LightsFile, MayHaveFurtherColumns) {
    for (const std::string more : {" 1.0", " 255 250 240"}) {
        const LightsFile file = parse("2\na 1.png 0 0 1" + more + "\n\"b.png\" 0.6 0 0.8" + more + "\n");
        ASSERT_EQ(file.lights.size(), 2u);
        expect_light(file.lights[0], "a 1.png", {0, 0, 1});
        expect_light(file.lights[1], "b.png", {0.6f, 0, 0.8f});
        EXPECT_THAT(file.warnings, ElementsAre(testing::HasSubstr("the first three are the light's")));
    }
}

TEST(LightsFile, MayHaveComments) {
    const LightsFile file = parse("# by hand\n2\n; x\na.jpg 0 0 1\n#c.jpg 1 0 1\nb.jpg 0.6 0 0.8\n");
    ASSERT_EQ(file.lights.size(), 2u);
    EXPECT_THAT(file.rejected, IsEmpty());
    EXPECT_THAT(file.warnings, ElementsAre(testing::HasSubstr("x.lp, line 5: begins with #")));
}

TEST(LightsFile, MayBeATable) {
    for (const std::string text :
         {"a.jpg,0,0,1\nb.jpg,0.6,0,0.8\n", "2\na.jpg, 0, 0, 1\nb.jpg, 0.6, 0, 0.8\n",
          "file;x;y;z\na.jpg;0;0;1\nb.jpg;0,6;0;0,8\n"}) {
        const LightsFile file = parse(text);
        ASSERT_EQ(file.lights.size(), 2u) << text;
        expect_light(file.lights[1], "b.jpg", {0.6f, 0, 0.8f});
        EXPECT_THAT(file.warnings, testing::Contains(testing::HasSubstr("columns are separated by")));
        EXPECT_THAT(file.rejected, IsEmpty());
    }
}

TEST(LightsFile, MayBeLatin1) {
    const LightsFile file = parse("1\nGem\xe4lde.png 0 0 1\n");
    ASSERT_EQ(file.lights.size(), 1u);
    EXPECT_EQ(file.lights[0].name, "Gem\xe4lde.png") << "a file may have the same bytes in its name";
    EXPECT_EQ(alike(file.lights[0].name), alike("Gemälde.png"));
    EXPECT_THAT(file.warnings, ElementsAre(testing::HasSubstr("as Latin-1")));
}

TEST(LightsFile, MayHoldDirectionsAsNormalMapsDo) {
    const Vec3 directions[] = {{0.6f, 0, 0.8f}, {-0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {0.48f, -0.6f, 0.64f}};
    for (const float full : {255.0f, 1.0f}) {
        std::string text = "4\n";
        for (const Vec3& d : directions) {
            const Vec3 v = (d + 1.0f) * (full / 2);
            text += full == 1 ? fmt::format("a{}.png {:.3f} {:.3f} {:.3f}\n", text.size(), v.x, v.y, v.z)
                              : fmt::format("a{}.png {:.0f} {:.0f} {:.0f}\n", text.size(), v.x, v.y, v.z);
        }
        const LightsFile file = parse(text);
        ASSERT_EQ(file.lights.size(), 4u);
        for (std::size_t i = 0; i < 4; ++i)
            EXPECT_LT(glm::length(file.lights[i].direction - directions[i]), 0.01f) << full;
        EXPECT_THAT(file.warnings, ElementsAre(testing::HasSubstr("as normal maps store them")));
    }
}

TEST(LightsFile, OfAnglesIsToldAsThat) {
    EXPECT_THAT(error_in("4\na.png 0 15 1\nb.png 90 15 1\nc.png 180 30 1\nd.png -90 60 1\n"),
                testing::HasSubstr("azimuth and elevation"));
}

}  // namespace
}  // namespace tangi
