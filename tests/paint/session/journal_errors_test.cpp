// journal_errors_test.cpp: what is wrong in a journal is told with file and line, in few words.
#include "paint/session/journal.h"

#include <gmock/gmock.h>

#include "tests/support/paint/journal_text.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Journal, ErrorsNameFileAndLine) {
    const TestDir dir;
    const auto error = [&](const std::string& text) {
        write_bytes(dir / "bad.jsonl", text);
        return error_of([&] { read_journal(dir / "bad.jsonl"); });
    };
    EXPECT_THAT(error(""), AllOf(HasSubstr("bad.jsonl"), HasSubstr("empty")));
    EXPECT_THAT(error("\n"), AllOf(HasSubstr("bad.jsonl"), HasSubstr("empty")));
    EXPECT_THAT(error("\nhello"), HasSubstr("not a journal"));
    EXPECT_THAT(error("hello\n"), AllOf(HasSubstr("bad.jsonl:1"), HasSubstr("not a journal")));
    EXPECT_THAT(error("{\"format\": \"tangipaint strokes\", \"version\": 2}\n"), HasSubstr("version 2"));
    EXPECT_THAT(error(kJournalHeader + "\n{\"event\": }\n"),
                AllOf(HasSubstr("bad.jsonl:3"), HasSubstr("not JSON")));
    EXPECT_THAT(error(kJournalHeader + "[]\n"), AllOf(HasSubstr("bad.jsonl:2"), HasSubstr("object")));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"jump\"}\n"),
                AllOf(HasSubstr("\"jump\""), HasSubstr("stroke")));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"point\", \"x\": 1}\n"),
                AllOf(HasSubstr(":2"), HasSubstr("'y'")));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"point\", \"x\": 1, \"y\": 1, \"p\": 2}\n"),
                HasSubstr("'p' = 2"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"point\", \"x\": 1, \"y\": \"a\"}\n"),
                HasSubstr("not a number"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"end\", \"now\": 1}\n"), HasSubstr("'now'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"paint\": {\"a\": 0}}\n"),
                HasSubstr("parts of a"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"point\", \"t\": 0, \"x\": 0, \"y\": 0, \"p\": NaN}\n"),
                AllOf(HasSubstr(":2: is not JSON"), HasSubstr("column 49: JSON has no NaN")));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"dry\", \"layer\": \"\xff\"}\n"),
                HasSubstr(":2: is not JSON: column 28: the byte 0xff is no UTF-8"));
    EXPECT_THAT(error(kJournalHeader + std::string(3, '\0') + "\n"),
                HasSubstr(":2: is not JSON: column 1: a byte 0x00"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"po\n"), HasSubstr("is not JSON: it ends before"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"paint\": {\"a\": 1e7}}\n"),
                HasSubstr("above 0, 1000000 at most"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"start\": \"wet\"}\n"),
                HasSubstr("'start'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"brush\": {\"sise\": 1}}\n"),
                HasSubstr("'sise'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"dry\"}\n"), HasSubstr(":2: has no 'layer'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"dry\", \"layer\": \"\"}\n"),
                HasSubstr("that is not empty"));
    EXPECT_THAT(
        error(kJournalHeader + "{\"event\": \"dry\", \"layer\": \"" + std::string(201, 'x') + "\"}\n"),
        HasSubstr("'layer' is a name of 201 bytes; 200 at most"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"dry\", \"layer\": \"a\\nb\"}\n"),
                HasSubstr("one line"));
    const auto dry = [&](const std::string& part) {
        return error(kJournalHeader + "{\"event\": \"dry\", \"layer\": \"a\", " + part + "}\n");
    };
    EXPECT_THAT(dry("\"circle\": {\"x\": 1, \"y\": 2}"), AllOf(HasSubstr(":2"), HasSubstr("'radius_mm'")));
    EXPECT_THAT(dry("\"circle\": {\"x\": 1, \"y\": 2, \"radius_mm\": 3, \"z\": 1}"), HasSubstr("'z'"));
    EXPECT_THAT(dry("\"polygon\": [[0, 0], [1, 1]]"), HasSubstr("3 to 10000"));
    EXPECT_THAT(dry("\"polygon\": [[0, 0], [1, 1], [2]]"), HasSubstr("[2]"));
    EXPECT_THAT(dry("\"circle\": {}, \"polygon\": []"), HasSubstr("both"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"on\": \"wall\"}\n"),
                HasSubstr("'on' is \"wall\""));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"roughness\": 3}\n"),
                HasSubstr("'roughness' = 3"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"pile\", \"x\": 1, \"y\": 1}\n"), HasSubstr("'paint'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"palette\", \"width_mm\": 10}\n"),
                HasSubstr("'height_mm'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"palette\", \"paints\": [1]}\n"), HasSubstr("'paints'"));
    EXPECT_THAT(error_of([&] { read_journal(dir / "none.jsonl"); }), HasSubstr("none.jsonl"));
    write_bytes(dir / "bad.jsonl", "something else\n");
    EXPECT_THAT(error_of([&] { JournalWriter(dir / "bad.jsonl"); }), HasSubstr("not a journal"));
    EXPECT_EQ(bytes_of(dir / "bad.jsonl"), "something else\n");
}

TEST(Journal, SaysWhichEventsAreNotWhereTheyBelong) {
    const TestDir dir;
    const std::string stroke = "{\"event\": \"stroke\"}\n",
                      point = "{\"event\": \"point\", \"x\": 1, \"y\": 1}\n", end = "{\"event\": \"end\"}\n",
                      undo = "{\"event\": \"undo\"}\n", dry = "{\"event\": \"dry\", \"layer\": \"a\"}\n";
    const auto warnings = [&](const std::string& events) {
        write_bytes(dir / "a.jsonl", kJournalHeader + events);
        std::vector<std::string> texts;
        for (const JournalWarning& warning : read_journal(dir / "a.jsonl").warnings)
            texts.push_back(fmt::format("{}: {}", warning.line, warning.text));
        return texts;
    };
    EXPECT_THAT(warnings(stroke + point + end + undo + stroke + point + point + end + dry),
                testing::IsEmpty());
    EXPECT_THAT(warnings(end), ElementsAre("2: an 'end' without a stroke: it ends nothing"));
    EXPECT_THAT(warnings(stroke + end), ElementsAre("2: the stroke has no points: it paints nothing"));
    EXPECT_THAT(warnings(stroke + point + stroke + point),
                ElementsAre("2: the stroke has no 'end' before that of line 4 begins; it ends there",
                            "4: the stroke has no 'end'; it ends with the journal"));
    EXPECT_THAT(warnings(stroke + point + undo + end),
                ElementsAre("4: 'undo' comes before the 'end' of the stroke of line 2, which it ends",
                            "5: an 'end' without a stroke: it ends nothing"));
    EXPECT_THAT(warnings(stroke + dry),
                ElementsAre("2: the stroke has no points: it paints nothing",
                            "3: 'dry' comes before the 'end' of the stroke of line 2, which it ends"));
}

TEST(Journal, ErrorsAreShortAndSayWhatIsMissing) {
    const TestDir dir;
    const auto error = [&](const std::string& text) {
        write_bytes(dir / "bad.jsonl", text);
        return error_of([&] { read_journal(dir / "bad.jsonl"); });
    };
    const std::string long_text(2000000, 'x');
    for (const std::string& event :
         {"\"" + long_text + "\"", "{\"event\": \"" + long_text + "\"}",
          "{\"event\": \"end\", \"" + long_text + "\": 1}",
          "{\"event\": \"stroke\", \"start\": \"" + long_text + "\"}",
          "{\"event\": \"stroke\", \"brush\": {\"" + long_text + "\": 1}}",
          "{\"event\": \"stroke\", \"brush\": {\"preset\": \"" + long_text + "\"}}",
          "{\"event\": \"stroke\", \"paint\": {\"" + long_text + "\": 0}}"}) {
        const std::string words = error(kJournalHeader + event + "\n");
        EXPECT_LT(words.size(), 500u) << event.substr(0, 60);
        EXPECT_THAT(words, HasSubstr("bad.jsonl:2"));
    }
    EXPECT_THAT(error(kJournalHeader + "{\"x\": 1}\n"), HasSubstr("bad.jsonl:2: has no 'event'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"seed\": 1.5}\n"),
                HasSubstr("'seed' is 1.5, not a whole"));
    EXPECT_THAT(error("{\"format\": \"tangipaint strokes\"}\n"), HasSubstr("has no 'version'"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"point\", \"x\": 1, \"y\": 2, \"x\": 3}\n"),
                HasSubstr("bad.jsonl:2: has the field 'x' twice"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"brush\": {\"size_mm\": -0.3}}\n"),
                HasSubstr("'size_mm' is -0.3, outside [0.01, 1000] mm"));
    EXPECT_THAT(error(kJournalHeader + "{\"event\": \"stroke\", \"brush\": {\"grain\": 3}}\n"),
                testing::EndsWith("'grain' is 3, outside [0, 1]"));
}

}  // namespace
}  // namespace tangi
