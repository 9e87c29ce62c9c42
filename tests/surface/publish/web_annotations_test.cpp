// web_annotations_test.cpp: Web Annotations are read, changed and written as the page of `export --to web`
// does it.
#include "surface/publish/web_annotations.h"

#include <gmock/gmock.h>

#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/publish/svg_path.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Kind = AnnotationKind;

const AnnotatedPicture kPicture{"urn:tangipaint:0", 200, 100};

json svg_selector(const std::string& shape) {
    return {{"type", "SvgSelector"},
            {"value", "<svg xmlns='http://www.w3.org/2000/svg'>" + shape + "</svg>"}};
}
AnnotationShape shape_drawn(const std::string& svg) { return shape_of_selector(svg_selector(svg), 200, 100); }

TEST(AnnotationShapes, AreTheSameOnceWrittenAndRead) {
    for (const AnnotationShape& shape :
         {AnnotationShape{Kind::point, {{{3, 4.25}}}},
          AnnotationShape{Kind::line, {{{0, 0}, {-0.5, 99.5}, {7, 8}}}},
          AnnotationShape{Kind::polygon, {{{1, 2}, {30, 2}, {30, 40}}}},
          AnnotationShape{Kind::polygon, {{{1, 2}, {30, 2}, {30, 40}}, {{10, 5}, {20, 5}, {20, 15}}}},
          AnnotationShape{Kind::text, {{{150, 20}}}}}) {
        const std::string svg = svg_of_shape(shape, "a < b & \"c\"\nnot this", 200);
        EXPECT_EQ(shape_of_selector({{"type", "SvgSelector"}, {"value", svg}}, 200, 100), shape) << svg;
        EXPECT_EQ(why_nowhere({{"selector", {{"type", "SvgSelector"}, {"value", svg}}}}), "") << svg;
        EXPECT_THAT(svg, testing::Not(HasSubstr("not this")));
    }
    // In selectors pixels begin at whole numbers; as annotation.js writes them.
    EXPECT_EQ(
        svg_of_shape({Kind::point, {{{100.5, 149.5}}}}, "", 300),
        R"(<svg xmlns="http://www.w3.org/2000/svg"><circle class="point" cx="101" cy="150" r="1.5"/></svg>)");
}

TEST(AnnotationShapes, OfOthersAreRead) {
    EXPECT_EQ(shape_drawn("<rect x='1' y='2' width='10' height='20'/>"),
              (AnnotationShape{Kind::polygon, {{{0.5, 1.5}, {10.5, 1.5}, {10.5, 21.5}, {0.5, 21.5}}}}));
    EXPECT_EQ(shape_drawn("<line x1='1' y1='2' x2='3' y2='4'/>"),
              (AnnotationShape{Kind::line, {{{0.5, 1.5}, {2.5, 3.5}}}}));
    const AnnotationShape circle = shape_drawn("<circle cx='50.5' cy='40.5' r='20'/>");
    EXPECT_EQ(circle.kind, Kind::polygon);
    for (const glm::dvec2& p : circle.rings[0]) EXPECT_NEAR(glm::length(p - glm::dvec2(50, 40)), 20, 1e-9);
    EXPECT_EQ(
        shape_drawn("<polygon points='1,1 2,1 2,2'/><rect x='0' y='0' width='1' height='1'/>").rings.size(),
        2u)
        << "both are the place";
    EXPECT_EQ(shape_drawn("<line x1='1' y1='2' x2='3' y2='4'/><circle cx='1' cy='1' r='1'/>").rings.size(),
              1u);
    const json percent = selector_of("http://a.example/canvas#xywh=percent:10,10,50,20");
    EXPECT_EQ(shape_of_selector(percent, 200, 100),
              (AnnotationShape{Kind::polygon, {{{19.5, 9.5}, {119.5, 9.5}, {119.5, 29.5}, {19.5, 29.5}}}}));
    EXPECT_EQ(shape_of_selector({{"type", "PointSelector"}, {"x", 30}, {"y", 40}}, 200, 100),
              (AnnotationShape{Kind::point, {{{29.5, 39.5}}}}));
    EXPECT_EQ(selector_of({{"selector",
                            {{{"type", "CssSelector"}, {"value", "p"}},
                             {{"type", "PointSelector"}, {"x", 1}, {"y", 2}}}}})["type"],
              "PointSelector");
    EXPECT_TRUE(selector_of("http://a.example/canvas").is_null());
    EXPECT_THAT(error_of([] { shape_drawn("<path d='MA1 2 3'/>"); }), HasSubstr("without numbers"));
}

TEST(SvgPaths, BecomeOutlines) {
    const auto ends = [](const std::string& d) { return outlines_of_path(d); };
    const auto straight = ends("M10.0 10L50,10l0 30ZM20-12h5v5.5.5z m1 1 2 0");
    ASSERT_EQ(straight.size(), 3u);
    EXPECT_EQ(straight[0].points, (std::vector<glm::dvec2>{{10, 10}, {50, 10}, {50, 40}}));
    EXPECT_TRUE(straight[0].closed);
    EXPECT_EQ(straight[1].points, (std::vector<glm::dvec2>{{20, -12}, {25, -12}, {25, -6.5}, {25, -6}}));
    EXPECT_EQ(straight[2].points, (std::vector<glm::dvec2>{{21, -11}, {23, -11}}));
    EXPECT_FALSE(straight[2].closed);
    // A quarter, and three quarters, of a circle of radius 10 about 10, 0.
    for (const char* arc : {"M0 0A10 10 0 0 1 10 -10", "M0 0a10 10 30 1 0 10 -10"}) {
        const auto points = ends(arc).front().points;
        for (const glm::dvec2& p : points) EXPECT_NEAR(glm::length(p - glm::dvec2(10, 0)), 10, 1e-9) << arc;
        EXPECT_EQ(points.back(), glm::dvec2(10, -10));
    }
    EXPECT_GT(ends("M0 0a10 10 30 1 0 10 -10")[0].points[24].y, 5) << "the long way";
    // Radii that are too small are enlarged: half a circle.
    const auto enlarged = ends("M0 0A1 1 0 0 1 20 0");
    for (const glm::dvec2& p : enlarged.front().points)
        EXPECT_NEAR(glm::length(p - glm::dvec2(10, 0)), 10, 1e-9);
    // A cubic whose control points are those of the quadratic is the same curve; S and T go on smoothly.
    const auto cubic = ends("M0 0C20 40 40 40 60 0S100 -40 120 0")[0].points,
               quadratic = ends("M0 0Q30 60 60 0T120 0")[0].points;
    ASSERT_EQ(cubic.size(), quadratic.size());
    for (std::size_t i = 0; i < cubic.size(); ++i) EXPECT_LT(glm::length(cubic[i] - quadratic[i]), 1e-9) << i;
    EXPECT_TRUE(ends("").empty());
    EXPECT_EQ(ends("M1 2L3 4 L x 5 L 6 7")[0].points.size(), 2u) << "up to what is no number";
}

TEST(WebAnnotations, KeepWhatIsNotChanged) {
    json theirs = {
        {"type", "Annotation"},
        {"id", "urn:a"},
        {"motivation", "classifying"},
        {"creator", "B"},
        {"body",
         {{{"type", "TextualBody"}, {"value", "old"}}, {{"type", "Image"}, {"id", "http://a.example/b"}}}},
        {"target", "http://a.example/canvas#xywh=1,2,30,40"}};
    const json text = changed_annotation(theirs, {.text = "new"}, kPicture);
    EXPECT_EQ(text_of_annotation(text), "new");
    EXPECT_EQ(text["body"][1], theirs["body"][1]);
    EXPECT_EQ(text["creator"], "B");
    EXPECT_EQ(text["target"]["source"], "http://a.example/canvas");
    EXPECT_EQ(text["target"]["selector"]["value"], "xywh=1,2,30,40") << "its place as it was written";
    const json view = changed_annotation(text, {.view = "azimuth=20&elevation=30"}, kPicture);
    EXPECT_EQ(view_of_annotation(view), "azimuth=20&elevation=30");
    EXPECT_EQ(view["target"]["selector"], text["target"]["selector"]);
    const json moved =
        changed_annotation(view, {.shape = AnnotationShape{Kind::point, {{{5, 6}}}}}, kPicture);
    EXPECT_EQ(moved["target"]["state"], view["target"]["state"]);
    EXPECT_EQ(shape_of_selector(moved["target"]["selector"], 200, 100),
              (AnnotationShape{Kind::point, {{{5, 6}}}}));
    // A word on the painting is its text.
    const json word = changed_annotation(new_annotation({Kind::text, {{{5, 6}}}}, "", kPicture),
                                         {.text = "Signature\nof 1620"}, kPicture);
    EXPECT_THAT(word["target"]["selector"]["value"].get<std::string>(), HasSubstr(">Signature</text>"));
    EXPECT_EQ(word["target"]["source"], kPicture.source);
}

TEST(WebAnnotations, OfAPageAreReadAgain) {
    const TestDir folder;
    json items = json::array();
    for (int i = 0; i < 3; ++i)
        items.push_back(new_annotation({Kind::point, {{{1.0 * i, 2}}}}, "azimuth=20", kPicture));
    EXPECT_NE(items[0]["id"], items[1]["id"]);
    const std::string file = (folder / "notes.json").string();
    write_bytes(file, text_of_page(items));
    EXPECT_EQ(read_annotations(file, "notes.json"), items);
    EXPECT_EQ(read_json(text_of_page(items), "")["type"], "AnnotationPage");
    EXPECT_EQ(read_annotations("", ""), json::array());
    write_bytes(file,
                json_line({{"type", "Manifest"}, {"items", {{{"annotations", {{{"items", items}}}}}}}}));
    EXPECT_EQ(read_annotations(file, "notes.json"), items) << "of a IIIF manifest";
    write_bytes(file, json_line(json::array({items[0], items[0]})));
    EXPECT_THAT(error_of([&] { read_annotations(file, "mine"); }), HasSubstr("mine: item 2"));
}

TEST(WebAnnotations, WordsOfAView) {
    const std::string view = "azimuth=20&elevation=-3.5&light_2=1,2,3,0&turn=x&x=";
    EXPECT_EQ(number_in_view(view, "azimuth"), 20);
    EXPECT_EQ(number_in_view(view, "elevation"), -3.5);
    EXPECT_EQ(word_in_view(view, "light_2"), "1,2,3,0");
    for (const char* missing : {"zoom", "turn", "x", "light", "muth"})
        EXPECT_FALSE(number_in_view(view, missing)) << missing;
}

}  // namespace
}  // namespace tangi
