// brush_settings_test.cpp: presets, and what is wrong with those of users.
#include "paint/brush/brush_settings.h"

#include <gmock/gmock.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(BrushSettings, PresetsAreValidAndDiffer) {
    for (const auto& [name, settings] : brush_presets()) EXPECT_NO_THROW(validate(settings)) << name;
    for (const char* name :
         {"round", "flat", "filbert", "fan", "knife", "rag", "smudge", "scrape", "eraser", "height eraser"})
        EXPECT_TRUE(brush_presets().contains(name)) << name;
    EXPECT_EQ(brush_presets().at("smudge").load_mm, 0);
}

TEST(BrushSettings, ComeBackFromJson) {
    for (const auto& [name, settings] : brush_presets()) {
        const auto json = brush_to_json(settings);
        EXPECT_EQ(brush_to_json(brush_from_json(json, "test")), json) << name;
    }
    const BrushSettings s = brush_from_json({{"preset", "flat"}, {"size_mm", 31}}, "test");
    EXPECT_EQ(s.shape, BrushShape::flat);
    EXPECT_EQ(s.size_mm, 31);
    EXPECT_TRUE(s.follow);
}

TEST(BrushSettings, ErrorsNameThePlaceAndTheField) {
    const auto error = [](const nlohmann::json& json) {
        return error_of([&] { brush_from_json(json, "here:3"); });
    };
    EXPECT_THAT(error({{"sise_mm", 3}}), AllOf(HasSubstr("here:3"), HasSubstr("sise_mm")));
    EXPECT_THAT(error({{"size_mm", "big"}}),
                AllOf(HasSubstr("size_mm"), HasSubstr("\"big\""), HasSubstr("number")));
    EXPECT_THAT(error({{"size_mm", -1}}), AllOf(HasSubstr("here:3"), HasSubstr("size_mm"), HasSubstr("-1")));
    EXPECT_THAT(error({{"follow", 1}}), HasSubstr("true or false"));
    EXPECT_THAT(error({{"shape", "square"}}), AllOf(HasSubstr("square"), HasSubstr("filbert")));
    EXPECT_THAT(error({{"preset", "broom"}}), AllOf(HasSubstr("broom"), HasSubstr("knife")));
    EXPECT_THAT(error(nlohmann::json::array()), HasSubstr("object"));
}

TEST(BrushSettings, FilesAddToThePresets) {
    const TestDir dir;
    write_bytes(dir / "a.json", R"({"format": "tangipaint brushes", "version": 1,
                                    "brushes": {"broom": {"preset": "fan", "size_mm": 60}}})");
    const auto presets = read_brush_presets(dir / "a.json");
    EXPECT_EQ(presets.at("broom").size_mm, 60);
    std::vector<std::string> warnings;
    read_brush_presets(dir / "a.json", &warnings);
    EXPECT_TRUE(warnings.empty());
    write_bytes(dir / "b.json", R"({"format": "tangipaint brushes", "version": 1,
                                    "brushes": {"round": {"size_mm": 3}, "nib": {"size_mm": 1}}})");
    EXPECT_EQ(read_brush_presets(dir / "b.json", &warnings).at("round").size_mm, 3);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0], HasSubstr("b.json: its brush 'round' takes the place of the preset"));
    EXPECT_EQ(presets.at("broom").shape, BrushShape::fan);
    EXPECT_EQ(presets.size(), brush_presets().size() + 1);
    write_bytes(dir / "c.json", R"({"format": "tangipaint brushes", "version": 1, "brushes": {},
                                    "brooms": {"besom": {"size_mm": 60}}})");
    EXPECT_FALSE(read_brush_presets(dir / "c.json", &warnings).contains("besom"));
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_THAT(warnings[1], AllOf(HasSubstr("c.json: 'brooms' is not"), HasSubstr("\"brushes\"")));

    const auto error = [&](const std::string& text) {
        write_bytes(dir / "b.json", text);
        return error_of([&] { read_brush_presets(dir / "b.json"); });
    };
    EXPECT_THAT(error("{"), AllOf(HasSubstr("b.json"), HasSubstr("not JSON")));
    EXPECT_THAT(error("{}"), AllOf(HasSubstr("b.json"), HasSubstr("tangipaint brushes")));
    EXPECT_THAT(error(R"({"format": "tangipaint brushes", "version": 9})"), HasSubstr("version 9"));
    EXPECT_THAT(error(R"({"format": "tangipaint brushes", "version": 1})"), HasSubstr("\"brushes\""));
    EXPECT_THAT(error(R"({"format": "tangipaint brushes", "version": 1, "brushes": {"x": {"gap_mm": 99}}})"),
                AllOf(HasSubstr("'x'"), HasSubstr("gap_mm")));
    EXPECT_THAT(error(R"({"format": "tangipaint brushes", "version": 1, "brushes": {"": {}}})"),
                AllOf(HasSubstr("b.json"), HasSubstr("no name")));
    EXPECT_THAT(error(R"({"format": "tangipaint brushes", "version": 1, "brushes": {"a\nb": {}}})"),
                AllOf(HasSubstr("b.json: brush 'a"), HasSubstr("in one line")));
    EXPECT_THAT(error(R"({"format": "tangipaint brushes", "version": 1, "brushes": {")" +
                      std::string(201, 'x') + R"(": {}}})"),
                HasSubstr("200 bytes at most"));
    EXPECT_THAT(error("{\"format\": \"tangipaint brushes\",\n \"version\": NaN}"),
                AllOf(HasSubstr("b.json: line 2: is not JSON"), HasSubstr("column 13: JSON has no NaN")));
}

TEST(BrushSettings, FilesSayThatABrushHoldsLessThanItIsLoadedWith) {
    const TestDir dir;
    write_bytes(dir / "a.json", R"({"format": "tangipaint brushes", "version": 1,
        "brushes": {"a": {"load_mm": 15, "hold_mm": 1}, "b": {"load_mm": 8, "hold_mm": 8}}})");
    std::vector<std::string> warnings;
    read_brush_presets(dir / "a.json", &warnings);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0], HasSubstr("a.json: brush 'a': its load_mm 15 is more than its hold_mm 1"));
    for (const auto& [name, preset] : brush_presets()) EXPECT_LE(preset.load_mm, preset.hold_mm) << name;
}

TEST(BrushSettings, FilesSayNothingTwice) {
    const TestDir dir;
    write_bytes(dir / "a.json",
                "{\"format\": \"tangipaint brushes\", \"version\": 1,\n \"brushes\": "
                "{\"broom\": {\"size_mm\": 60},\n \"broom\": {\"size_mm\": 6}}}");
    EXPECT_THAT(error_of([&] { read_brush_presets(dir / "a.json"); }),
                HasSubstr("a.json: line 3: has the field 'broom' twice"));
    write_bytes(dir / "a.json", "{\"format\": \"tangipaint brushes\", \"brushes\": {}}");
    EXPECT_THAT(error_of([&] { read_brush_presets(dir / "a.json"); }), HasSubstr("has no \"version\""));
}

}  // namespace
}  // namespace tangi
