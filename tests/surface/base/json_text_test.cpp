// json_text_test.cpp: JSON that says something twice is refused with its line; messages stay short.
#include "surface/base/json_text.h"

#include <gmock/gmock.h>

#include "surface/base/json_reading.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(JsonText, IsReadAsJson) {
    const std::string text = R"({"a": [1, {"b": 2}, {"b": 3}], "c": {"a": null, "b": "\"a\": 1"}})";
    EXPECT_EQ(parse_json(text, "x"), json::parse(text));
    EXPECT_THROW(parse_json("{\"a\": 1", "x"), json::parse_error);
    EXPECT_THROW(parse_json("", "x"), json::parse_error);
    EXPECT_THROW(parse_json("{\"a\": 1, \"a\": 2, }", "x"), json::parse_error) << "it is no JSON at all";
}

TEST(JsonText, AFieldThatIsThereTwiceIsNamedWithItsLine) {
    const auto error = [](const std::string& text) { return error_of([&] { parse_json(text, "a.json"); }); };
    EXPECT_EQ(error(R"({"x": 1, "x": 1})"), "a.json: has the field 'x' twice; keep one of them");
    EXPECT_EQ(error("{\n \"list\": [{\"y\": \"\\\"z\\\": 1\"},\n  {\"y\": 1,\n\n   \"y\" : 2}]\n}"),
              "a.json: line 5: has the field 'y' twice; keep one of them");
    EXPECT_THAT(error("{\"" + std::string(5000, 'k') + "\": 1, \"" + std::string(5000, 'k') + "\": 1}"),
                AllOf(HasSubstr("kkk… (5000 bytes)"), Not(HasSubstr(std::string(100, 'k')))));
    EXPECT_THAT(error(std::string(100000, '[')), HasSubstr("deeper than 64"));
    EXPECT_THAT(error("[1e400]"), HasSubstr("a.json: holds a number that is too large"));
}

// 140,000 lists in each other are no more than a text to a parser; whoever writes them into a message calls
// himself as often.
TEST(JsonText, OfAFileIsReadWithinLimits) {
    const auto error = [](const std::string& text) { return error_of([&] { read_json(text, "a.json"); }); };
    const std::string deep = "{\"poor\": " + std::string(140'000, '[') + std::string(140'000, ']') + "}";
    EXPECT_THAT(error(deep), HasSubstr("a.json: has lists and objects in each other, deeper than 64"));
    EXPECT_TRUE(json_or_discarded(deep).is_discarded());
    EXPECT_EQ(error("{\n\"a\": NaN}"),
              "a.json: line 2: is not JSON: column 6: JSON has no NaN and no Infinity; write a number");
    EXPECT_EQ(read_json("{\"a\": [1]}", "x"), json_or_discarded("{\"a\": [1]}"));
    EXPECT_TRUE(json_or_discarded("{\"a\": 1").is_discarded());
    EXPECT_TRUE(json_or_discarded("[1e400]").is_discarded());
    EXPECT_THAT(error("[" + std::string(kLongestJson, ' ') + "]"), HasSubstr("a.json: has 67108866 bytes"));
    const std::string nest = std::string(kDeepestJson, '[') + std::string(kDeepestJson, ']');
    EXPECT_EQ(json_or_discarded(nest).dump(), nest);
}

TEST(JsonText, WordsOfTheLibraryAreNotShown) {
    const auto why = [](const std::string& text) -> std::string {
        try {
            const json value = json::parse(text);
            return value.at("lens").get<std::string>();
        } catch (const json::exception& error) {
            return why_wrong_field(error);
        }
    };
    EXPECT_EQ(why("{}"), "the field 'lens' is missing");
    EXPECT_EQ(why("{\"lens\": 3}"), "a field is a number where a string belongs");
    EXPECT_THAT(why("true"), Not(HasSubstr("json")));
}

TEST(JsonText, SaysWhyATextIsNone) {
    const auto why = [](const std::string& text) -> std::string {
        try {
            parse_json(text, "x");
        } catch (const json::parse_error& error) {
            return why_no_json(text, error.byte);
        }
        return "it is JSON";
    };
    EXPECT_EQ(why("[1]"), "it is JSON");
    EXPECT_EQ(why(" \n"), "it is empty; copy the file again, or make it anew");
    for (const char* cut : {"{\"a\": 1", "[\n", "[\"caf\xc3", "[tr"})
        EXPECT_THAT(why(cut), HasSubstr("as if cut off; copy the file again, or make it anew")) << cut;
    EXPECT_EQ(why("[1,\n  \"caf\xc3\xa9\", NaN]"),
              "column 11: JSON has no NaN and no Infinity; write a number");
    EXPECT_THAT(why("[-Infinity]"), HasSubstr("no Infinity"));
    EXPECT_EQ(why("[\"\xc3\xa9\xff\"]"), "column 4: the byte 0xff is no UTF-8; save it as a text in UTF-8");
    EXPECT_THAT(why("[\"\xc3\x28\"]"), HasSubstr("column 3: the byte 0xc3"));
    EXPECT_THAT(why(std::string("\0\1", 2)), HasSubstr("column 1: a byte 0x00, which no text has"));
    EXPECT_EQ(why("{}xx"), "column 3: 'xx' does not belong there; correct it");
    EXPECT_EQ(why("{\"a\": 1,}"), "column 9: '}' does not belong there; correct it");
    EXPECT_THAT(why("[\"a\nb\"]"), HasSubstr("column 4: a tab or line end"));
    EXPECT_LT(why("[" + std::string(100000, 'x')).size(), 120u);
}

TEST(JsonText, MessagesAreValidUtf8) {
    EXPECT_EQ(valid_utf8("caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8e\xa8"),
              "caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8e\xa8");
    const std::string mark = "\xef\xbf\xbd";
    EXPECT_EQ(valid_utf8("a\xff"
                         "b"),
              "a" + mark + "b");
    EXPECT_EQ(valid_utf8("\xe2\x82"), mark + mark) << "cut off";
    EXPECT_EQ(valid_utf8("\xc0\xaf\xed\xa0\x80"), mark + mark + mark + mark + mark)
        << "overlong, a surrogate";
    EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80"), mark + mark + mark + mark) << "beyond Unicode";
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        std::string bytes;
        for (int n = random.below(12); n > 0; --n) bytes += static_cast<char>(random.below(256));
        EXPECT_NO_THROW((void)json(valid_utf8(bytes)).dump());
        EXPECT_NO_THROW((void)json(shortened(bytes, 5)).dump());
    }
    EXPECT_EQ(first_line("\nread error: \xff\nread error\nfailed"), R"(read error: \xff)");
}

TEST(JsonText, ValuesInMessagesAreShort) {
    EXPECT_EQ(shown(json(0.1 + 0.2)), "0.30000000000000004");
    EXPECT_EQ(shown(json(0.3)), "0.3");
    EXPECT_EQ(shown(json(2)), "2");
    EXPECT_EQ(shown(json("a")), "\"a\"");
    EXPECT_EQ(shown(json(std::vector<int>(1000, 7))).size(), 80 + std::string("… (2001 bytes)").size());
    EXPECT_EQ(shortened("aé", 2), "a… (3 bytes)") << "no half characters";
    EXPECT_EQ(shortened("aé", 3), "aé");
    EXPECT_EQ(shortened("a\nb\x1b[1m"), R"(a\nb\x1b[1m)") << "one line, and no orders to a terminal";
    EXPECT_EQ(line_of("a\nb\n", 0), 1);
    EXPECT_EQ(line_of("a\nb\n", 2), 2);
    EXPECT_EQ(line_of("a\nb\n", 999), 3);
}

}  // namespace
}  // namespace tangi
