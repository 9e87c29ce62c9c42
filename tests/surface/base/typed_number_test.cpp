// typed_number_test.cpp: a decimal comma is a decimal comma, and what can be read in two ways is
// refused.
#include "surface/base/typed_number.h"

#include <gmock/gmock.h>

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(TypedNumber, HasAPointOrAComma) {
    for (const auto& [text, value] : {std::pair("120,5", 120.5),
                                      {"120.5", 120.5},
                                      {" 12 ", 12},
                                      {"0,125", 0.125},
                                      {"1.234", 1.234},
                                      {"-3,5", -3.5},
                                      {"+2", 2},
                                      {",5", 0.5},
                                      {"5,", 5},
                                      {"1,5e-3", 1.5e-3},
                                      {"2E3", 2000},
                                      {"\xe2\x88\x92"
                                       "4,25",
                                       -4.25},
                                      {"1234,567", 1234.567},
                                      {"00,5", 0.5},
                                      {"12,3456", 12.3456}}) {
        const TypedNumber number = typed_number(text);
        EXPECT_EQ(number.complaint, "") << text;
        EXPECT_DOUBLE_EQ(number.value, value) << text;
        EXPECT_DOUBLE_EQ(std::stod(number.plain), value) << text;
    }
    EXPECT_TRUE(typed_number("0,3").comma);
    EXPECT_FALSE(typed_number("0.3").comma);
}

TEST(TypedNumber, IsNotGuessedWhereItCanBeReadInTwoWays) {
    for (const auto& [text, remedy] : {std::pair("1.234,5", "write 1234.5"),
                                       {"1,234.5", "write 1234.5"},
                                       {"1.234.567", "write 1234567"},
                                       {"1,234,567", "write 1234567"},
                                       {"12.345.678,9", "write 12345678.9"},
                                       {"1,234", "may be 1.234 or 1234"},
                                       {"-12,500", "may be -12.500 or -12500"},
                                       {"1 234,5", "write 1234.5"},
                                       {"1\xe2\x80\xaf"
                                        "234",
                                        "write 1234"},
                                       {"-1'234'567.25", "write -1234567.25"},
                                       {"1'234", "write 1234"}}) {
        const TypedNumber number = typed_number(text);
        EXPECT_THAT(number.complaint, HasSubstr(remedy)) << text;
        EXPECT_EQ(number.plain, "") << text;
    }
}

// Thousands have three digits: what is no group of thousands is no number, and nothing is made of it.
TEST(TypedNumber, IsNotMadeOfWhatHasMarksAnywhere) {
    for (const char* text : {"1.5.2", "1,5,2", "1.23.4", "1.234.56", "12 34", "1'5", "0.123.456",
                             "1234.567.890", "1.234,5,6", "1,5.5", "1..2", "1 2", "12'", "1.234.567,8e3"}) {
        const TypedNumber number = typed_number(text);
        EXPECT_THAT(number.complaint, HasSubstr("is not a number")) << text;
        EXPECT_THAT(number.complaint, Not(HasSubstr("thousands"))) << text;
    }
}

TEST(TypedNumber, MayHaveItsUnitAndNoOther) {
    EXPECT_EQ(typed_number("120,5 mm", "mm").value, 120.5);
    EXPECT_EQ(typed_number("120,5mm", " mm").value, 120.5);
    EXPECT_EQ(typed_number("45°", "°").value, 45);
    EXPECT_EQ(typed_number("45 mm2", "mm²").value, 45);
    EXPECT_EQ(typed_number("45 mm²", "mm2").value, 45);
    EXPECT_THAT(typed_number("45 mm", "mm²").complaint, HasSubstr("give it in mm²"));
    EXPECT_THAT(typed_number("12 cm", "mm").complaint, HasSubstr("give it in mm"));
    EXPECT_THAT(typed_number("12 cm").complaint, HasSubstr("not a number"));
}

TEST(TypedNumber, IsNone) {
    for (const char* text : {"", "  ", "abc", "-", ",", ".", "e5", "nan", "inf", "*2", "1e999", "3x"})
        EXPECT_NE(typed_number(text).complaint, "") << text;
}

}  // namespace
}  // namespace tangi
