// journal_test.cpp: a journal paints the same in the browser's engine and natively, bit for bit: all layers,
// and how they look.
#include <gtest/gtest.h>

#include "paint/canvas/appearance.h"
#include "paint/canvas/canvas_hash.h"
#include "paint/session/session.h"
#include "paint/substrate/substrate.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/random_journal.h"
#include "tests/web/web_support.h"
#include "web/engine/easel.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

struct Hashes {
    std::string canvas, look;
};

// As `tangipaint replay` paints it.
Hashes replayed_natively(const nlohmann::json& choice, const std::filesystem::path& journal) {
    const auto ground = std::make_shared<const Surface>(make_ground(choice));
    Session session(ground, artist_acrylics());
    replay(session, read_journal(journal));
    return {hash_of(session.canvas(), hash_of(*ground)), hash_of(appearance(session.canvas()))};
}

class JournalsInBothEngines : public testing::Test {
protected:
    void expect_the_same(const nlohmann::json& choice, const std::filesystem::path& journal,
                         int lines_at_once) {
        TP_NEEDS_WEB_APP();
        write_text_file(scratch_ / "choice.json", choice.dump());
        const nlohmann::json web = replayed_in_node(scratch_ / "choice.json", journal, lines_at_once);
        const Hashes native = replayed_natively(choice, journal);
        EXPECT_EQ(web["canvas"], native.canvas) << journal << " on " << choice;
        EXPECT_EQ(web["look"], native.look) << journal << " on " << choice;
        EXPECT_GT(web["bristle_pixels"], 1e5);
    }
    std::filesystem::path random_journal(std::uint64_t seed, int events) {
        std::filesystem::path path = scratch_ / fmt::format("random{}.jsonl", seed);
        write_text_file(path, RandomJournal(seed, 120, 90).text(events));
        return path;
    }
    TestDir scratch_;
};

TEST_F(JournalsInBothEngines, OfTheStillLifePaintTheSameBits) {
    const std::filesystem::path journal =
        std::filesystem::path(TP_SOURCE_DIR) / "datasets/strokes/still_life.jsonl";
    expect_the_same({{"substrate", "linen"}, {"width_mm", 200}, {"height_mm", 150}, {"pixel_mm", 0.5}},
                    journal, 0);
}

TEST_F(JournalsInBothEngines, DrawnAtRandomPaintTheSameBits) {
    for (const std::uint64_t seed : {1, 2, 3})
        expect_the_same({{"substrate", "canvas"}, {"width_mm", 120}, {"height_mm", 90}, {"pixel_mm", 0.3}},
                        random_journal(seed, 80), static_cast<int>(seed) - 1);
}

// Addresses of large paintings are beyond those that numbers of 32 bits with a sign can name.
TEST_F(JournalsInBothEngines, PaintTheSameBeyondTwoGigabytes) {
    TP_NEEDS_WEB_APP();
    const nlohmann::json choice = {
        {"substrate", "canvas"}, {"width_mm", 120}, {"height_mm", 90}, {"pixel_mm", 0.3}};
    write_text_file(scratch_ / "choice.json", choice.dump());
    const auto replayed = [&](double memory_bytes) {
        nlohmann::json web =
            replayed_in_node(scratch_ / "choice.json", random_journal(8, 20), 5, memory_bytes);
        EXPECT_GE(web["memory"].get<double>(), memory_bytes);
        return std::tuple(web["canvas"], web["look"], web["texels"]);
    };
    EXPECT_EQ(replayed(2.2e9), replayed(0));
}

// Every support is made of noise, waves and exponentials.
TEST_F(JournalsInBothEngines, AreOfTheSameSupports) {
    for (const std::string& name : substrate_names())
        expect_the_same({{"substrate", name},
                         {"width_mm", 120},
                         {"height_mm", 90},
                         {"pixel_mm", 0.4},
                         {"seed", 7},
                         {"tint", {0.9, 0.7, 0.5}},
                         {"specular", 0.03},
                         {"roughness", 0.2}},
                        random_journal(4, 12), 0);
}

// What the worker does line by line is what replay() does at once.
TEST_F(JournalsInBothEngines, PaintTheSameOnTheEaselLineByLine) {
    const nlohmann::json choice = {
        {"substrate", "gesso"}, {"width_mm", 120}, {"height_mm", 90}, {"pixel_mm", 0.4}};
    const auto path = random_journal(5, 60);
    Easel easel(make_ground(choice));
    std::istringstream lines(read_text_file(path));
    std::string line;
    std::getline(lines, line);
    easel.begin(line);
    for (int i = 0; std::getline(lines, line); ++i) {
        easel.apply(line);
        if (i % 7 == 0) easel.refresh(false);
    }
    const Hashes native = replayed_natively(choice, path);
    EXPECT_EQ(easel.hash(), native.canvas);
    EXPECT_EQ(easel.look_hash(), native.look);
}

// Another colour and gloss of the ground: as if its strokes had been painted on that, dried ones and all.
TEST_F(JournalsInBothEngines, PaintTheSameOnAGroundThatLooksOtherwise) {
    nlohmann::json choice = {{"substrate", "linen"}, {"width_mm", 120}, {"height_mm", 90}, {"pixel_mm", 0.4}};
    const auto path = random_journal(6, 60);
    Easel easel(make_ground(choice));
    const std::string head = easel.head();
    std::istringstream lines(read_text_file(path));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) easel.apply(line);
    nlohmann::json otherwise = choice;
    otherwise.update({{"tint", {0.3, 0.5, 0.9}}, {"specular", 0.1}, {"roughness", 0.1}});
    easel.lie_on(make_ground(otherwise));
    const Hashes native = replayed_natively(otherwise, path);
    EXPECT_EQ(easel.hash(), native.canvas);
    EXPECT_EQ(easel.look_hash(), native.look);
    EXPECT_NE(easel.head(), head);
    EXPECT_EQ(easel.head(), Easel(make_ground(otherwise)).hash())
        << "its journal goes on from the new ground";
    choice["seed"] = 2;
    EXPECT_THROW(easel.lie_on(make_ground(choice)), ContractError) << "another relief";
    EXPECT_EQ(easel.look_hash(), native.look);
}

}  // namespace
}  // namespace tangi
