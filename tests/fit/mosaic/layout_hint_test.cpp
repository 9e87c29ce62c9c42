// layout_hint_test.cpp: which positions may overlap, from files and from names.
#include "fit/mosaic/layout_hint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kThree = {"a", "b", "c"};

LayoutHint hint_in(const std::string& text) {
    const TestDir dir;
    write_text_file(dir / "layout", text);
    return read_layout_hint(dir / "layout", kThree);
}

std::string refusal_of(const std::string& text) {
    try {
        hint_in(text);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

void expect_a_row(const LayoutHint& hint) {
    EXPECT_TRUE(hint.may_overlap(0, 1));
    EXPECT_TRUE(hint.may_overlap(2, 1));
    EXPECT_FALSE(hint.may_overlap(0, 2));
}

TEST(LayoutHints, AreReadFromJsonAndCsv) {
    expect_a_row(hint_in(R"({"positions": [{"name": "c", "column": 2, "row": 0},
        {"name": "a", "column": 0, "row": 0}, {"name": "b", "column": 1, "row": 1}]})"));
    expect_a_row(hint_in("name,column,row\na,0,0\nb,1,0\nc,2,0\n"));
    expect_a_row(hint_in("c;2;5\r\n\"a\" ; 0; 5\r\n\r\nb;1;5"));
}

TEST(LayoutHints, SayWhatIsWrongAndWhere) {
    EXPECT_THAT(refusal_of("a,0,0\nb,1\nc,2,0\n"), HasSubstr("line 2: has 2 columns; give three"));
    EXPECT_THAT(refusal_of("a,0,0\nb,x,0\nc,2,0\n"), HasSubstr("line 2: x is no number"));
    EXPECT_THAT(refusal_of("a,0,0\na,1,0\nc,2,0\n"), HasSubstr("line 2: a is there twice"));
    EXPECT_THAT(refusal_of("a,0,0\nb,1,0\n"), HasSubstr("has no position c"));
    EXPECT_THAT(refusal_of(R"({"positions": [{"name": "a", "column": "left"}]})"), HasSubstr("layout is"));
    EXPECT_THAT(refusal_of("{\"positions\": "), HasSubstr("layout"));
}

TEST(LayoutHints, AreTheLastTwoNumbersOfNames) {
    const auto hint = layout_hint_of({"wall7_r0_c0", "wall7_r0_c1", "wall7_r0_c2"});
    ASSERT_TRUE(hint);
    expect_a_row(*hint);
    EXPECT_EQ(hint->places[2], glm::dvec2(2, 0)) << "column, row";
    EXPECT_TRUE(layout_hint_of({"03-11", "03-12"})->may_overlap(0, 1));
    EXPECT_FALSE(layout_hint_of({"left", "right"}));
    EXPECT_FALSE(layout_hint_of({"part1", "part2"}));
    EXPECT_FALSE(layout_hint_of({"a_1_1", "b_1_1"}));  // two at one place
}

}  // namespace
}  // namespace tangi
