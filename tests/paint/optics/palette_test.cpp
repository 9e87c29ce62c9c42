// palette_test.cpp: palette files, good and bad, and the built-in paints.
#include "paint/optics/palette.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paint/optics/kubelka_munk.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string file_with(const std::string& paints) {
    return R"({"format": "tangipaint palette", "version": 1, "name": "mine", "paints": [)" + paints + "]}";
}

std::string listed(const Spectrum& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }

TEST(ArtistAcrylics, AreNineteenPaintsThatReflect) {
    const Palette& palette = artist_acrylics();
    ASSERT_EQ(palette.paints.size(), 19u);
    EXPECT_THAT(palette.source, HasSubstr("Berns"));
    EXPECT_EQ(palette.paints[0].name, "Titanium White");
    for (const Pigment& paint : palette.paints) {
        EXPECT_EQ(paint.origin, PigmentOrigin::measured);
        EXPECT_EQ(paint.source, palette.source);
        for (const float r : opaque_look({paint.k, paint.s})) {
            EXPECT_GT(r, 0.001) << paint.name;
            EXPECT_LT(r, 0.995) << paint.name;
        }
    }
    EXPECT_GT(lab_under(opaque_look({palette.paints[0].k, palette.paints[0].s})).l, 95);
}

TEST(Palettes, FindPaintsByName) {
    EXPECT_EQ(artist_acrylics().at("titanium WHITE").name, "Titanium White");
    EXPECT_EQ(artist_acrylics().find("Lead White"), -1);
    EXPECT_THAT(error_of([] { artist_acrylics().at("Lead White"); }),
                AllOf(HasSubstr("'Lead White'"), HasSubstr("Titanium White, Bone Black")));
}

TEST(Palettes, ComeBackFromTheirFiles) {
    const TestDir dir;
    Palette palette = artist_acrylics();
    palette.paints.push_back(pigment_of_rgb("a \"red\"", {0.5f, 0.1f, 0.1f}));
    palette.paints.back().roughness = 0.4f;
    palette.paints.back().source = "picked";
    write_palette(dir / "p.json", palette);
    const Palette back = read_palette(dir / "p.json");
    EXPECT_EQ(back.name, palette.name);
    ASSERT_EQ(back.paints.size(), palette.paints.size());
    for (std::size_t i = 0; i < back.paints.size(); ++i) {
        EXPECT_EQ(back.paints[i].name, palette.paints[i].name);
        EXPECT_EQ(back.paints[i].k, palette.paints[i].k);  // bit for bit
        EXPECT_EQ(back.paints[i].s, palette.paints[i].s);
        EXPECT_EQ(back.paints[i].origin, palette.paints[i].origin);
        EXPECT_EQ(back.paints[i].source, palette.paints[i].source);
        EXPECT_EQ(back.paints[i].roughness, palette.paints[i].roughness);
    }
}

TEST(Palettes, TakePaintsInEveryForm) {
    const Pigment& red = artist_acrylics().at("Pyrrole Red");
    const Pigment& white = artist_acrylics().paints[0];
    const Pigment both[] = {red, white};
    const float parts[] = {0.25f, 0.75f};
    const Spectrum masstone = opaque_look({red.k, red.s}), tint = opaque_look(mix(both, parts));
    Spectrum glossy = masstone;
    for (float& r : glossy) r = 0.04f + 0.96f * r;
    const std::string text = file_with(fmt::format(
        R"({{"name": "white", "k_per_mm": {}, "s_per_mm": {}, "specular": 0.02}},
           {{"name": "red", "masstone": {}, "tint": {}, "tint_concentration": 0.25, "white": "White", "source": "me"}},
           {{"name": "flat red", "masstone": {}}},
           {{"name": "glossy red", "masstone": {}, "specular_included": true}},
           {{"name": "sky", "srgb": "#80C0ff", "hiding_mm": 0.05, "roughness": 0.3}},
           {{"name": "sky too", "srgb": [128, 192, 255]}})",
        listed(white.k), listed(white.s), listed(masstone), listed(tint), listed(masstone), listed(glossy)));
    const Palette palette = parse_palette(text, "x");
    ASSERT_EQ(palette.paints.size(), 6u);
    EXPECT_EQ(palette.paints[0].specular, 0.02f);
    EXPECT_EQ(palette.paints[1].source, "me");
    EXPECT_EQ(palette.paints[1].origin, PigmentOrigin::masstone_and_tint);
    EXPECT_EQ(palette.paints[2].origin, PigmentOrigin::masstone);
    EXPECT_EQ(palette.paints[4].origin, PigmentOrigin::colour);
    EXPECT_EQ(palette.paints[4].roughness, 0.3f);
    const Rgb sky = Transfer{Transfer::Kind::srgb}.encode(
        to_linear_rgb(opaque_look({palette.paints[4].k, palette.paints[4].s})));
    EXPECT_NEAR(sky.r * 255, 128, 0.5);
    EXPECT_NEAR(sky.g * 255, 192, 0.5);
    EXPECT_NEAR(hiding_thickness_mm(palette.paints[4]), 0.05, 1e-4);
    for (const std::size_t i : {1u, 2u, 3u}) {
        const Spectrum look = opaque_look({palette.paints[i].k, palette.paints[i].s});
        for (std::size_t band = 0; band < kBands; ++band) EXPECT_NEAR(look[band], masstone[band], 1e-3) << i;
    }
    EXPECT_EQ(opaque_look({palette.paints[4].k, palette.paints[4].s}),
              opaque_look({palette.paints[5].k, palette.paints[5].s}));
}

TEST(Palettes, ResampleOtherWavelengths) {
    const Palette palette = parse_palette(
        file_with(R"({"name": "ramp", "wavelengths_nm": [400, 440, 480, 530, 580, 630, 680, 730],
                      "k_per_mm": [400, 440, 480, 530, 580, 630, 680, 730], "s_per_mm": [9, 9, 9, 9, 9, 9, 9, 9]})"),
        "x");
    for (std::size_t band = 0; band < kBands; ++band) {
        EXPECT_NEAR(palette.paints[0].k[band], kBand_nm[band], 1e-3);
        EXPECT_EQ(palette.paints[0].s[band], 9);
    }
}

TEST(Palettes, SayWhatIsWrongAndWhere) {
    const std::string twelve = "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]";
    const std::string ok = R"({"name": "a", "srgb": "#123456"})";
    const std::pair<std::string, std::vector<const char*>> bad[] = {
        {"", {"x.json: line 1: is not JSON"}},
        {"{\n\"format\": \"tangipaint palette\",\n oops}", {"x.json: line 3: is not JSON"}},
        {"[1]", {"x.json: is not an object"}},
        {R"({"name": "GIMP"})", {"is no palette", "\"format\": \"tangipaint palette\""}},
        {R"({"format": "tangipaint palette", "version": 2, "name": "n", "paints": []})",
         {"/version: is 2", "newer"}},
        {R"({"format": "tangipaint palette", "version": "1", "name": "n", "paints": []})",
         {"/version: is \"1\", not the whole number 1"}},
        {R"({"format": "tangipaint palette", "version": 1.0, "name": "n", "paints": []})",
         {"/version: is 1.0, not the whole number 1"}},
        {R"({"format": "tangipaint palette", "version": 1, "paints": []})", {"has no \"name\""}},
        {R"({"format": "tangipaint palette", "version": 1, "name": "n", "paint": []})",
         {"\"paint\"", "paints"}},
        {file_with(""), {"/paints: is an empty list"}},
        {R"({"format": "tangipaint palette", "version": 1, "name": "n", "paints": {}})",
         {"/paints: is not a list of paints"}},
        {file_with(R"({"name": "a", "k_per_mm": [NaN)"),
         {"line 1: is not JSON", "column 102: JSON has no NaN"}},
        {file_with(R"({"name": ")" + std::string(201, 'x') + R"(", "srgb": "#ff0000"})"),
         {"/paints/0/name: is a name of 201 bytes; 200 at most"}},
        {file_with("7"), {"/paints/0: is not an object"}},
        {file_with(R"({"srgb": "#123456"})"), {"/paints/0: has no \"name\""}},
        {file_with(R"({"name": "a"})"), {"/paints/0: 'a' has no colour"}},
        {file_with(ok + "," + R"({"name": "A", "srgb": "#123456"})"),
         {"/paints/1/name: there are two paints 'A'"}},
        {file_with(R"({"name": "A\nB", "srgb": "#ff0000"})"), {"/paints/0/name: is to be in one line"}},
        {file_with(R"({"name": "clear medium", "srgb": "#ff0000"})"),
         {"/paints/0/name: is what medium without pigment is counted as"}},
        {file_with(R"({"name": "a", "rgb": [1, 2, 3]})"),
         {"/paints/0: 'a' has no colour", "'rgb' is none of these"}},
        {file_with(R"({"name": "a", "srgb": [0.5, 0.25, 1]})"),
         {"/paints/0/srgb", "[0.5, 0.25, 1]", "from 0 to 255"}},
        {file_with(R"({"name": "a", "srgb": "#12345"})"), {"/paints/0/srgb: '#12345' is no colour"}},
        {file_with(R"({"name": "a", "srgb": [1, 2]})"), {"/paints/0/srgb: has 2 numbers"}},
        {file_with(R"({"name": "a", "srgb": [1, 2, 256]})"),
         {"/paints/0/srgb/2: 256 is outside of [0, 255]"}},
        {file_with(R"({"name": "a", "srgb": "#123456", "hiding_mm": 0})"),
         {"/paints/0/hiding_mm: 0 is outside"}},
        {file_with(R"({"name": "a", "srgb": "#123456", "colour": 1})"),
         {"/paints/0: has \"colour\"", "hiding_mm"}},
        {file_with(R"({"name": "a", "k_per_mm": )" + twelve + "}"), {"/paints/0: has no \"s_per_mm\""}},
        {file_with(R"({"name": "a", "k_per_mm": [1, 2], "s_per_mm": )" + twelve + "}"),
         {"/paints/0/k_per_mm: has 2 numbers for 12 wavelengths"}},
        {file_with(R"({"name": "a", "s_per_mm": )" + twelve + R"(, "k_per_mm": [1,1,1,-1,1,1,1,1,1,1,1,1]})"),
         {"/paints/0/k_per_mm/3: -1 is outside of [0, "}},
        {file_with(R"({"name": "a", "masstone": [50,1,1,1,1,1,1,1,1,1,1,1]})"),
         {"/paints/0/masstone/0: 50 is outside"}},
        {file_with(R"({"name": "a", "masstone": "dark"})"), {"/paints/0/masstone: is not a list"}},
        {file_with(R"({"name": "a", "masstone": [1], "wavelengths_nm": [500]})"),
         {"/paints/0/wavelengths_nm"}},
        {file_with(R"({"name": "a", "masstone": [1, 1], "wavelengths_nm": [400, 700]})"),
         {"/paints/0/wavelengths_nm/1: 700 nm after 400 nm"}},
        {file_with(R"({"name": "a", "masstone": [1, 1], "wavelengths_nm": [500, 550]})"),
         {"/paints/0/wavelengths_nm: covers 500 to 550 nm only"}},
        {file_with(R"({"name": "a", "masstone": )" + twelve + R"(, "tint": )" + twelve +
                   R"(, "tint_concentration": 0.1, "white": "w"})"),
         {"/paints/0/white: there is no paint 'w' before this one"}},
        {file_with(R"({"name": "a", "k_per_mm": )" + twelve + R"(, "s_per_mm": )" + twelve +
                   R"(, "origin": "magic"})"),
         {"/paints/0/origin: 'magic' is none of: measured"}},
    };
    for (const auto& [text, parts] : bad)
        for (const char* part : parts)
            EXPECT_THAT(error_of([&text = text] { parse_palette(text, "x.json"); }),
                        AllOf(HasSubstr("x.json"), HasSubstr(part)))
                << text;
}

TEST(Palettes, ThatAreDamagedAreReadOrRefusedWithTheirName) {
    const std::string whole = palette_text(artist_acrylics());
    Random random(1);
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
        std::string damaged = whole;
        if (i % 3 == 0)
            damaged.resize(static_cast<std::size_t>(random.below(static_cast<int>(whole.size()))));
        for (int k = 0; k < 3 && !damaged.empty(); ++k) {
            const auto at = static_cast<std::size_t>(random.below(static_cast<int>(damaged.size())));
            if (i % 3 == 1)
                damaged[at] = static_cast<char>(random.below(256));
            else if (i % 3 == 2)
                damaged.erase(at, 1 + static_cast<std::size_t>(random.below(20)));
        }
        try {
            for (const Pigment& paint : parse_palette(damaged, "x.json").paints)
                for (std::size_t band = 0; band < kBands; ++band) {
                    ASSERT_GE(paint.k[band], 0);
                    ASSERT_GE(paint.s[band], 0);
                }
        } catch (const Error& error) {  // and nothing else
            ++refused;
            EXPECT_THAT(error.what(), HasSubstr("x.json"));
        }
    }
    EXPECT_GT(refused, 100);
}

TEST(Palettes, ThatAreNoFilesAreNamed) {
    const TestDir dir;
    EXPECT_THAT(error_of([&] { read_palette(dir / "none.json"); }), HasSubstr("none.json"));
    EXPECT_THAT(error_of([&] { write_palette(dir / "none" / "p.json", artist_acrylics()); }),
                HasSubstr("none"));
    EXPECT_TRUE(names_in(dir.path()).empty());
}

TEST(Palettes, SayNothingTwice) {
    EXPECT_THAT(error_of([] {
                    parse_palette(
                        file_with("\n{\"name\": \"a\",\n \"srgb\": \"#123456\",\n \"srgb\": \"#000000\"}"),
                        "x.json");
                }),
                HasSubstr("x.json: line 4: has the field 'srgb' twice"));
    EXPECT_LT(error_of([] { artist_acrylics().at(std::string(1000000, 'x')); }).size(), 1000u);
}

}  // namespace
}  // namespace tangi
