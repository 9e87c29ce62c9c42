// treatment_safety_test.cpp: treatments that two programs, crashes and wrong files come into.
#include "retouch/treatment/treatment.h"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "paint/files/canvas_file.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_folder.h"
#include "retouch/treatment/treatment_steps.h"
#include "surface/base/error.h"
#include "tests/support/retouch/treatment_folder.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

TEST_F(TreatmentFolder, OfTwoProgramsAtOnceTheSecondChangesNothing) {
    Treatment one = begin(), two = Treatment::open(folder());
    Canvas canvas = two.read_canvas();
    add(one, LayerRole::fill, 10);
    lay(canvas, "varnish 1", 20, 8);
    const Mask all(100, 70, 1.0f);
    EXPECT_THAT(
        [&] {
            two.record({.action = "test",
                        .masks = {{"stain", all}},
                        .canvas = &canvas,
                        .added = {{"varnish 1", LayerRole::varnish}}},
                       kAuthor);
        },
        ThrowsMessage<Error>(HasSubstr("changed by another program")));
    const Treatment after = Treatment::open(folder());
    EXPECT_THAT(after.check(), IsEmpty());
    ASSERT_EQ(after.layers().size(), 1u);
    EXPECT_EQ(after.layers()[0].name, "fill 1");
    EXPECT_FALSE(std::filesystem::exists(folder() / "masks/stain.png"));
    EXPECT_FALSE(std::filesystem::exists(folder() / "pending"));
}

// A crash between two writes, as it would be found: a step's files pending, with its line or without.
TEST_F(TreatmentFolder, AStepThatACrashCameIntoIsThereAsAWholeOrNotAtAll) {
    namespace fs = std::filesystem;
    Treatment treatment = begin();
    treatment.record({.action = "draw damage", .masks = {{"stain", Mask(100, 70, 1.0f)}}}, kAuthor);
    const std::string head = treatment.log().head();
    fs::copy(folder(), dir_ / "before", fs::copy_options::recursive);
    Canvas canvas = treatment.read_canvas();
    lay(canvas, "fill 1", 10, 8);
    treatment.record({.action = "fill",
                      .masks = {{"stain", Mask(100, 70)}},
                      .canvas = &canvas,
                      .added = {{"fill 1", LayerRole::fill}}},
                     kAuthor);
    const std::string lines = read_text_file(dir_ / "before/log.jsonl");
    for (const std::string line : {"none", "half", "whole"}) {
        const bool in_log = line == "whole";
        const fs::path crashed = dir_ / line;
        fs::copy(dir_ / "before", crashed, fs::copy_options::recursive);
        fs::create_directories(crashed / "pending/masks/earlier");
        for (const char* file : {"painting.exr", "masks/stain.png", "masks/earlier/stain.2.png"})
            fs::copy_file(folder() / file, crashed / "pending" / file);
        write_text_file(crashed / "pending/step.json", nlohmann::json{{"previous", head}}.dump());
        const std::string all = read_text_file(folder() / "log.jsonl");
        if (line == "half")
            write_bytes(crashed / "log.jsonl", all.substr(0, (lines.size() + all.size()) / 2));
        if (line == "whole") write_bytes(crashed / "log.jsonl", all);
        const Treatment found = Treatment::open(crashed);
        EXPECT_THAT(found.check(), IsEmpty());
        EXPECT_EQ(found.layers().size(), in_log ? 1u : 0u);
        EXPECT_EQ(area_of(found.mask(DamageClass::stain), 1).mm2, in_log ? 0 : 7000);
        EXPECT_FALSE(fs::exists(crashed / "pending"));
        EXPECT_EQ(read_text_file(crashed / "log.jsonl"), in_log ? all : lines);
    }
}

// A disk that fails for a moment: the step has not happened, and can be done then.
TEST_F(TreatmentFolder, AStepWhoseLineIsNotWrittenHasNotHappened) {
    namespace fs = std::filesystem;
    begin();
    const fs::path head = folder() / "log.head.json", log = folder() / "log.jsonl";
    const std::string before = read_text_file(log);
    fs::rename(head, dir_ / "head");
    fs::create_directory(head);
    fs::create_directory(head / "in the way");
    const auto step = [&](Treatment& treatment) {
        treatment.record({.action = "draw damage", .masks = {{"stain", Mask(100, 70, 1.0f)}}}, kAuthor);
    };
    // It was opened before.
    fs::rename(head, dir_ / "folder"), fs::rename(dir_ / "head", head);
    Treatment treatment = Treatment::open(folder());
    fs::rename(head, dir_ / "head"), fs::rename(dir_ / "folder", head);
    EXPECT_THAT([&] { step(treatment); }, ThrowsMessage<Error>(HasSubstr("log.head.json: is a folder")));
    fs::remove_all(head), fs::rename(dir_ / "head", head);
    EXPECT_EQ(read_text_file(log), before);
    EXPECT_FALSE(fs::exists(folder() / "pending"));
    Treatment again = Treatment::open(folder());
    EXPECT_THAT(again.check(), IsEmpty());
    EXPECT_FALSE(again.has_mask(DamageClass::stain));
    step(again);
    EXPECT_THAT(Treatment::open(folder()).check(), IsEmpty());
}

TEST_F(TreatmentFolder, AStepWhoseFileCannotBePlacedIsFinishedByTheNextCommand) {
    namespace fs = std::filesystem;
    Treatment treatment = begin();
    const fs::path mask = folder() / "masks/stain.png";
    fs::create_directories(mask / "in the way");
    EXPECT_THAT(
        [&] {
            treatment.record({.action = "draw damage", .masks = {{"stain", Mask(100, 70, 1.0f)}}}, kAuthor);
        },
        ThrowsMessage<Error>(AllOf(HasSubstr("masks/stain.png: cannot be put in its place"),
                                   HasSubstr("the next command finishes it"))));
    fs::remove_all(mask);
    const Treatment found = Treatment::open(folder());
    EXPECT_THAT(found.check(), IsEmpty());
    EXPECT_EQ(area_of(found.mask(DamageClass::stain), 1).mm2, 7000);
    EXPECT_FALSE(fs::exists(folder() / "pending"));
}

// One rename makes a treatment of it.
TEST_F(TreatmentFolder, ABeginningThatFailsLeavesNothing) {
    namespace fs = std::filesystem;
    {
        const FullDisk full(2000);
        EXPECT_THAT([&] { Treatment::begin(dir_ / "new/p.treatment", dir_ / "p.exr", kAuthor); },
                    ThrowsMessage<Error>(AllOf(HasSubstr("new/p.treatment/painting.exr: cannot be written: "),
                                               HasSubstr("File too large"))));
    }
    EXPECT_FALSE(fs::exists(dir_ / "new"));
    EXPECT_THAT(Treatment::begin(dir_ / "new/p.treatment/", dir_ / "p.exr", kAuthor).check(), IsEmpty());
    EXPECT_FALSE(fs::exists(dir_ / "new/p.treatment/pending"));
}

TEST_F(TreatmentFolder, LogsWithAWholeChainThatNoTreatmentWroteAreNamed) {
    begin();
    nlohmann::json first = TreatmentLog::open(folder() / "log.jsonl").entries()[0].content;
    const auto told = [&](const nlohmann::json& begun, const nlohmann::json& line) {
        const TestDir dir;
        TreatmentLog log = TreatmentLog::begin(dir / "log.jsonl", begun);
        log.append(line);
        try {
            Treatment::open(dir.path());
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(told(first, {{"action", "note"}}), "");
    for (const auto& [field, value] : std::vector<std::pair<std::string, nlohmann::json>>{
             {"width", -1}, {"height", "70"}, {"mm_per_pixel", 0}, {"dry_sha256", 7}, {"scale_known", "x"}}) {
        nlohmann::json begun = first;
        begun[field] = value;
        EXPECT_THAT(told(begun, {{"action", "note"}}),
                    AllOf(HasSubstr("log.jsonl:1: "), HasSubstr("'" + field + "'")));
    }
    for (const nlohmann::json& line : std::vector<nlohmann::json>{{{"action", 1}},
                                                                  {{"layers", {"fill 1"}}},
                                                                  {{"layers", {{{"name", "fill 1"}}}}},
                                                                  {{"outputs", {{"../p.exr", "0"}}}},
                                                                  {{"outputs", {{"masks/stain.png", 1}}}},
                                                                  {{"kept", {{"stain", "/etc/passwd"}}}},
                                                                  {{"withdrawn", {"a/../../p.exr"}}},
                                                                  {{"results", "none"}}}) {
        nlohmann::json written = {{"action", "test"}};
        written.update(line);
        EXPECT_THAT(told(first, written), AllOf(HasSubstr("log.jsonl:2: "), HasSubstr("not written by")));
    }
    EXPECT_THAT(told(first, {{"action", "undo"}}), HasSubstr("does not say which line it undoes"));
}

TEST_F(TreatmentFolder, WrongFoldersAndPaintingsAreRefused) {
    EXPECT_THAT([&] { Treatment::open(dir_ / "none"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("is no treatment"), HasSubstr("damage"))));
    begin();
    EXPECT_THAT([&] { begin(); }, ThrowsMessage<Error>(HasSubstr("holds a treatment already")));
    Canvas painted(flat_surface(100, 70));
    lay(painted, "old", 1, 5);
    write_canvas(dir_ / "painted.exr", painted);
    EXPECT_THAT([&] { Treatment::begin(dir_ / "other", dir_ / "painted.exr", kAuthor); },
                ThrowsMessage<Error>(HasSubstr("has been painted on")));
    // A folder with somebody's painting in it is not written over.
    std::filesystem::create_directories(dir_ / "full");
    write_text_file(dir_ / "full/painting.exr", "mine");
    EXPECT_THAT([&] { Treatment::begin(dir_ / "full", dir_ / "p.exr", kAuthor); },
                ThrowsMessage<Error>(HasSubstr("painting.exr: is another painting")));
    EXPECT_EQ(read_text_file(dir_ / "full/painting.exr"), "mine");
}

TEST_F(TreatmentFolder, OfManyThatBeginAtOnceOneDoes) {
    std::atomic<int> begun = 0, late = 0;
    std::vector<std::thread> programs;
    for (int i = 0; i < 6; ++i)
        programs.emplace_back([&] {
            try {
                begin();
                ++begun;
            } catch (const Error& error) {
                late += std::string(error.what()).find("holds a treatment already") != std::string::npos;
            }
        });
    for (std::thread& program : programs) program.join();
    EXPECT_EQ(begun, 1);
    EXPECT_EQ(late, 5);
    EXPECT_THAT(Treatment::open(folder()).check(), IsEmpty());
}

// The log makes a treatment: without it, what else a beginning left is begun again.
TEST_F(TreatmentFolder, ABeginningThatACrashCameIntoIsBegunAgain) {
    begin();
    std::filesystem::remove(folder() / "log.jsonl");
    EXPECT_THAT(begin().check(), IsEmpty());
    EXPECT_THAT(Treatment::open(folder()).log().warnings(), IsEmpty());
}

// As a legend that cannot be put in place.
TEST_F(TreatmentFolder, WhatBelongsToAStepElsewhereComesAboutWithItOrNeitherDoes) {
    Treatment treatment = begin();
    const std::string log = bytes_of(folder() / "log.jsonl"), head = bytes_of(folder() / "log.head.json");
    TreatmentStep step{.action = "draw damage", .masks = {{"abrasion", Mask(100, 70, 1.0f)}}};
    step.elsewhere = [] { fail("no room for it"); };
    EXPECT_THAT(error_of([&] { treatment.record(step, kAuthor); }), testing::HasSubstr("no room for it"));
    EXPECT_EQ(bytes_of(folder() / "log.jsonl"), log);
    EXPECT_EQ(bytes_of(folder() / "log.head.json"), head);
    EXPECT_FALSE(std::filesystem::exists(folder() / "pending"));
    EXPECT_FALSE(std::filesystem::exists(folder() / "masks" / "abrasion.png"));
    bool done = false;
    step.elsewhere = [&] { done = true; };
    treatment.record(step, kAuthor);  // the same treatment goes on
    EXPECT_TRUE(done);
    EXPECT_TRUE(Treatment::open(folder()).has_mask(DamageClass::abrasion));
    EXPECT_THAT(treatment.check(), testing::IsEmpty());
}

}  // namespace
}  // namespace tangi
