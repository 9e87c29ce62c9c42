// treatment_log_test.cpp: the log of a treatment: its chain, and what it makes of edits and crashes.
#include "retouch/treatment/treatment_log.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "retouch/treatment/treatment_folder.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

std::vector<std::string> lines_of(const std::filesystem::path& path) {
    std::ifstream stream(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

void write_lines(const std::filesystem::path& path, const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    write_text_file(path, text);
}

// A log of `count` entries after the first.
std::filesystem::path a_log(const TestDir& dir, int count) {
    TreatmentLog log = TreatmentLog::begin(dir / "log.jsonl", {{"action", "begin"}});
    for (int i = 0; i < count; ++i) log.append({{"action", "note"}, {"number", i}});
    return dir / "log.jsonl";
}

TEST(Sha256, IsThatOfTheStandard) {
    EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    const TestDir dir;
    write_bytes(dir / "a", std::string(3'000'000, 'a'));
    EXPECT_EQ(sha256_of_file(dir / "a"), sha256_of(std::string(3'000'000, 'a')));
    EXPECT_THAT([&] { sha256_of_file(dir / "none"); },
                ThrowsMessage<Error>(HasSubstr("none: cannot be read")));
}

TEST(TreatmentLog, GoesOnWhereItEnded) {
    const TestDir dir;
    const auto path = a_log(dir, 2);
    TreatmentLog log = TreatmentLog::open(path);
    log.append({{"action", "later"}});
    const TreatmentLog again = TreatmentLog::open(path);
    ASSERT_EQ(again.entries().size(), 4u);
    EXPECT_EQ(again.entries()[3].content["action"], "later");
    EXPECT_EQ(again.entries()[3].content["previous"], again.entries()[2].sha256);
    EXPECT_EQ(again.head(), log.head());
    EXPECT_THAT([&] { TreatmentLog::begin(path, {}); }, ThrowsMessage<Error>(HasSubstr("a log already")));
}

TEST(TreatmentLog, AnEditedLineIsNamed) {
    const TestDir dir;
    const auto path = a_log(dir, 5);
    const std::vector<std::string> whole = lines_of(path);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::vector<std::string> lines = whole;
        const auto at = lines[i].find("\"action\":\"");
        lines[i][at + 10] = 'X';
        write_lines(path, lines);
        EXPECT_THAT([&] { TreatmentLog::open(path); },
                    ThrowsMessage<Error>(HasSubstr(fmt::format("log.jsonl:{}: was edited", i + 1))));
    }
}

TEST(TreatmentLog, LinesThatWereRemovedMovedOrPutInAreNoticed) {
    const TestDir dir;
    const auto path = a_log(dir, 5);
    const std::vector<std::string> whole = lines_of(path);
    const auto refused = [&](const std::vector<std::string>& lines, const std::string& said) {
        write_lines(path, lines);
        EXPECT_THAT([&] { TreatmentLog::open(path); }, ThrowsMessage<Error>(HasSubstr(said)));
    };
    std::vector<std::string> lines = whole;
    lines.erase(lines.begin() + 2);
    refused(lines, "log.jsonl:3: does not follow the line before it");
    lines = whole;
    std::swap(lines[1], lines[2]);
    refused(lines, "log.jsonl:2: does not follow");
    lines = whole;
    lines.insert(lines.begin() + 4, whole[1]);
    refused(lines, "log.jsonl:5: does not follow");
    lines.assign(whole.begin(), whole.end() - 2);  // the chain holds, but its head says more
    refused(lines, "log.jsonl:5: the log was cut: 2 lines are missing");
    lines.assign(whole.begin() + 1, whole.end());
    refused(lines, "log.jsonl:1: is not the first");
    write_lines(path, whole);
    EXPECT_NO_THROW(TreatmentLog::open(path));
}

// Whose chain holds, and whose fields are of another kind: no bug of ours, but a log that somebody wrote.
TEST(TreatmentLog, WhoseFirstLineIsOfAnotherKindIsAnError) {
    const TestDir dir;
    const auto first = [&](const json& format, const json& version) {
        const json line = {{"format", format}, {"version", version}, {"previous", std::string(64, '0')}};
        const std::string body = line.dump(), hash = sha256_of(body);
        write_bytes(dir / "log.jsonl", body.substr(0, body.size() - 1) + ",\"sha256\":\"" + hash + "\"}\n");
        write_bytes(dir / "log.head.json", json{{"lines", 1}, {"sha256", hash}}.dump());
        return error_of([&] { TreatmentLog::open(dir / "log.jsonl"); });
    };
    EXPECT_THAT(first(1e30, 1), HasSubstr("log.jsonl:1: is not the first line of a treatment's log"));
    EXPECT_THAT(first(json::array(), 1), HasSubstr("log.jsonl:1: "));
    EXPECT_THAT(first(kTreatmentFormat, "one"), HasSubstr("log.jsonl: is of a newer version"));
}

// Names that no window or message can show, and places that are none.
TEST(TreatmentLog, ALineThatIsOfAnotherFormIsNamed) {
    const TestDir dir;
    const auto form = [&](const char* field, const json& value) {
        std::filesystem::remove(dir / "log.jsonl");
        TreatmentLog log = TreatmentLog::begin(
            dir / "log.jsonl",
            {{"action", "begin"}, {"width", 2}, {"height", 2}, {"mm_per_pixel", 1.0}, {"dry_sha256", "00"}});
        json line = {{"action", "undo"},
                     {"parameters", {{"step", {{"line", 1}}}}},
                     {"layers", {{{"name", "fill 1"}, {"role", "fill"}, {"sha256", "00"}}}}};
        if (field) line[field] = value;
        log.append(line);
        return log;
    };
    EXPECT_NO_THROW(require_form(form(nullptr, {})));
    const json layer = {{"name", std::string(2000, 'x')}, {"role", "fill"}, {"sha256", "00"}};
    EXPECT_THAT(error_of([&] { require_form(form("layers", json::array({layer}))); }),
                HasSubstr("log.jsonl:2: cannot have such a 'layers'"));
    EXPECT_THAT(error_of([&] {
                    require_form(form("parameters", {{"step", {1, 2}}}));
                }),
                HasSubstr("log.jsonl:2: does not say which line it undoes"));
}

TEST(TreatmentLog, WrittenAnewIsNoticedByItsHead) {
    const TestDir dir, other;
    const auto path = a_log(dir, 3);
    std::filesystem::copy_file(a_log(other, 4), path, std::filesystem::copy_options::overwrite_existing);
    // The first lines are the same, so that the fourth is the one that the head names.
    // One line more than the head: a crash may have come between.
    EXPECT_THAT(TreatmentLog::open(path).warnings(),
                ElementsAre(HasSubstr("log.jsonl:5: is not in log.head")));
    TreatmentLog::open(other / "log.jsonl").append({{"action", "more"}});
    std::filesystem::copy_file(other / "log.jsonl", path, std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT([&] { TreatmentLog::open(path); }, ThrowsMessage<Error>(HasSubstr("lines were put in")));
    std::filesystem::remove(dir / "log.head.json");
    EXPECT_THAT([&] { TreatmentLog::open(path); }, ThrowsMessage<Error>(HasSubstr("log.head.json")));
}

TEST(TreatmentLog, ALineThatACrashCutIsLeftOut) {
    const TestDir dir;
    const auto path = a_log(dir, 2);
    const std::string text = read_text_file(path);
    write_bytes(path, text + "{\"action\":\"ha");
    TreatmentLog log = TreatmentLog::open(path);
    EXPECT_EQ(log.entries().size(), 3u);
    EXPECT_THAT(log.warnings(), ElementsAre(HasSubstr("log.jsonl:4: was cut short")));
    log.append({{"action", "next"}});
    EXPECT_EQ(TreatmentLog::open(path).entries().size(), 4u);
    EXPECT_THAT(TreatmentLog::open(path).warnings(), IsEmpty());
}

// However much of the line came to the disk: a part of it is never taken for a whole, nor the whole for lost.
TEST(TreatmentLog, ALineThatACrashCutAnywhereIsLeftOut) {
    const TestDir dir;
    const auto path = a_log(dir, 2);
    const std::string head = read_text_file(dir / "log.head.json");
    const std::string before = read_text_file(path);
    TreatmentLog::open(path).append({{"action", "next"}, {"who", "Ä. Ö."}});
    const std::string after = read_text_file(path);
    for (std::size_t cut = before.size() + 1; cut < after.size(); ++cut) {
        write_bytes(path, after.substr(0, cut));
        write_bytes(dir / "log.head.json", head);
        const TreatmentLog log = TreatmentLog::open(path);
        ASSERT_EQ(log.entries().size(), 3u) << cut;
        ASSERT_THAT(log.warnings(),
                    ElementsAre(HasSubstr("log.jsonl:4: was cut short by a crash and is left out")));
    }
}

TEST(TreatmentLog, TwoWritersAtOnceDoNotBreakTheChain) {
    const TestDir dir;
    const auto path = a_log(dir, 1);
    TreatmentLog one = TreatmentLog::open(path), two = TreatmentLog::open(path);
    one.append({{"action", "one"}});
    EXPECT_THAT(
        [&] {
            two.append({{"action", "two"}});
        },
        ThrowsMessage<Error>(HasSubstr("changed by another program")));
    EXPECT_EQ(TreatmentLog::open(path).entries().size(), 3u);
}

TEST(TreatmentLog, AnEditIsNoticedByWhoHasReadItAlready) {
    const TestDir dir;
    const auto path = a_log(dir, 2);
    TreatmentLog log = TreatmentLog::open(path);
    std::vector<std::string> lines = lines_of(path);
    lines[1][lines[1].find("\"action\":\"") + 10] = 'X';  // as long as before
    write_lines(path, lines);
    EXPECT_THAT(
        [&] {
            log.append({{"action", "later"}});
        },
        ThrowsMessage<Error>(HasSubstr("changed by another program")));
    EXPECT_EQ(lines_of(path), lines);
}

}  // namespace
}  // namespace tangi
