// Camera raw, frames and brackets, as a user gives them to fit and compare.
#include <gmock/gmock.h>

#include "surface/base/json_reading.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/capture/dng_writer.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

float vignette(int x, int y) {
    const float u = (static_cast<float>(x) - 16) / 32, v = (static_cast<float>(y) - 16) / 32;
    return 1 - u * u - v * v;
}

// Photographs of a tiny painting, as a lens that vignettes and a sensor with a dark signal would have stored
// them.
void spoil(const TinyStack& stack) {
    const auto seen = [](const Image<Rgb>& truth) {
        Image<Rgb> photo(truth.width(), truth.height());
        for (int y = 0; y < truth.height(); ++y)
            for (int x = 0; x < truth.width(); ++x) photo(x, y) = 0.03f + 0.8f * vignette(x, y) * truth(x, y);
        return photo;
    };
    for (int i = 0; i < 12; ++i)
        write_picture(stack.photo(i), seen(read_picture(stack.photo(i))), {}, {.bits = 16});
    write_picture(stack.out("dark.png"), seen(Image<Rgb>(32, 32)), {}, {.bits = 16});
    write_picture(stack.out("flat.png"), seen(Image<Rgb>(32, 32, Rgb(0.7f))), {}, {.bits = 16});
}

std::vector<std::string> fit(const TinyStack& stack, const std::string& out,
                             const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"fit", stack.path(), "--out", stack.out(out), "--transfer", "linear"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

// Mean difference of two maps' diffuse reflectance, of its mean, but for one factor.
double unlike(const std::string& first, const std::string& second) {
    const Surface a = read_painting(first), b = read_painting(second);
    double sum_a = 0, sum_b = 0, difference = 0;
    for (const auto& [s, sum] : {std::pair{&a, &sum_a}, std::pair{&b, &sum_b}})
        for (const Rgb& d : s->diffuse.pixels()) *sum += static_cast<double>(d.g);
    for (std::size_t i = 0; i < a.diffuse.size(); ++i)
        difference += std::abs(static_cast<double>(a.diffuse.pixels()[i].g) / sum_a -
                               static_cast<double>(b.diffuse.pixels()[i].g) / sum_b);
    return difference;
}

TEST(CliRadiometry, FramesGiveThePaintingBackThatLensAndSensorSpoiled) {
    const TinyStack stack;
    ASSERT_TRUE(ended(tangipaint(fit(stack, "clean.exr")), 0));
    spoil(stack);
    ASSERT_TRUE(ended(tangipaint(fit(stack, "spoiled.exr")), 0));
    const std::vector<std::string> frames = {"--dark", stack.out("dark.png"), "--flat",
                                             stack.out("flat.png")};
    const Finished run = tangipaint(fit(stack, "restored.exr", frames));
    ASSERT_TRUE(ended(run, 0));
    const double spoiled = unlike(stack.out("clean.exr"), stack.out("spoiled.exr"));
    const double restored = unlike(stack.out("clean.exr"), stack.out("restored.exr"));
    EXPECT_GT(spoiled, 0.08);
    EXPECT_LT(restored, spoiled / 4);

    const nlohmann::json said = run.json()["development"];
    EXPECT_EQ(said["encoding"], "linear");
    EXPECT_EQ(said["dark"]["files"][0], "dark.png");
    EXPECT_NEAR(said["dark"]["mean"].get<double>(), 0.03, 1e-3);
    EXPECT_TRUE(said["ambient"].is_null());
    EXPECT_TRUE(said["raw"].is_null());
    EXPECT_THAT(run.json()["transfer"]["source"].get<std::string>(), HasSubstr("developed"));
    const nlohmann::json provenance = read_json(read_painting(stack.out("restored.exr")).provenance, "JSON");
    EXPECT_EQ(provenance["development"], said);
    EXPECT_EQ(provenance["options"]["photos"]["flat"], "../flat.png");  // from the photographs

    std::vector<std::string> compare = {"compare", stack.out("restored.exr"), stack.path(), "--out",
                                        stack.out("report")};
    const Finished without = tangipaint(compare);
    compare.insert(compare.end(), frames.begin(), frames.end());
    const Finished with = tangipaint(compare);
    ASSERT_TRUE(ended(with, 0));
    EXPECT_GT(with.json()["mean"]["all"]["psnr_db"].get<double>(),
              without.json()["mean"]["all"]["psnr_db"].get<double>() + 3);
    EXPECT_EQ(with.json()["development"]["encoding"], "linear");
}

TEST(CliRadiometry, RawJustWorks) {
    const TinyStack stack;
    for (int i = 0; i < 12; ++i) {
        fs::path raw = stack.photo(i);
        const Image<Rgb> photo = read_picture(raw);
        fs::remove(raw);
        write_dng(raw.replace_extension(".dng"), photo);
    }
    const fs::path scratch = stack.root() / "scratch";
    fs::create_directory(scratch);
    const Conditions here{.environment = {{"TMPDIR", scratch.string()}}};
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")}, here);
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json said = run.json()["development"];
    EXPECT_EQ(said["encoding_source"], "camera raw");
    EXPECT_EQ(said["raw"]["camera"], "TestCam");
    EXPECT_EQ(said["raw"]["demosaic"], "AHD");
    EXPECT_EQ(said["scratch_bytes"], 12 * 32 * 32 * 6);
    EXPECT_THAT(everything_in(scratch), IsEmpty());
    const Finished compared =
        tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("report")}, here);
    ASSERT_TRUE(ended(compared, 0));
    EXPECT_EQ(compared.json()["development"]["scratch_bytes"], 0);
    EXPECT_THAT(everything_in(scratch), IsEmpty());

    const Finished full = tangipaint({"fit", stack.path(), "--out", stack.out("b.exr")},
                                     {.environment = {{"TMPDIR", scratch.string()}}, .largest_file = 20000});
    EXPECT_TRUE(ended(full, 1, {"12 developed camera raws need", "TMPDIR"}));
    EXPECT_FALSE(fs::exists(stack.out("b.exr")));
    EXPECT_THAT(everything_in(scratch), IsEmpty());
}

TEST(CliRadiometry, LeavesNothingOnDiskWhenItIsInterrupted) {
    const TinyStack stack({}, 64);
    for (int i = 0; i < 12; ++i) {
        fs::path raw = stack.photo(i);
        const Image<Rgb> photo = read_picture(raw);
        fs::remove(raw);
        write_dng(raw.replace_extension(".dng"), photo);
    }
    const fs::path scratch = stack.root() / "scratch";
    fs::create_directory(scratch);
    for (const int how : {SIGINT, SIGKILL}) {
        Program program({"fit", stack.path(), "--out", stack.out("a.exr")},
                        {.environment = {{"TMPDIR", scratch.string()}}});
        std::this_thread::sleep_for(std::chrono::milliseconds(150));
        program.signal(how);
        const Finished run = program.wait();
        EXPECT_TRUE(run.code == 130 || run.code == 137 || run.code == 0) << run.code << run.err;
        EXPECT_THAT(everything_in(scratch), IsEmpty());
    }
}

TEST(CliRadiometry, WrongFlagsAndFramesAreToldBeforeAnythingIsWritten) {
    const TinyStack stack;
    spoil(stack);
    write_picture(stack.out("small.png"), Image<Rgb>(8, 8, Rgb(0.5f)), {});
    EXPECT_TRUE(ended(tangipaint(fit(stack, "a.exr", {"--flat", stack.out("small.png")})), 1,
                      {"small.png", "8 x 8"}));
    EXPECT_TRUE(ended(tangipaint(fit(stack, "a.exr", {"--dark", stack.out("none.png")})), 1, {"none.png"}));
    EXPECT_TRUE(
        ended(tangipaint(fit(stack, "a.exr", {"--brackets", stack.out("none.json")})), 1, {"none.json"}));
    EXPECT_TRUE(ended(tangipaint(fit(stack, "a.exr", {"--brackets", "auto"})), 1, {"NAME_1"}));
    EXPECT_TRUE(ended(tangipaint(fit(stack, "a.exr", {"--raw-demosaic", "magic"})), 2, {"--raw-demosaic"}));
    EXPECT_TRUE(ended(tangipaint(fit(stack, "a.exr", {"--raw-colour", "pink"})), 2, {"--raw-colour"}));
    EXPECT_FALSE(fs::exists(stack.out("a.exr")));
    // A frame is a photograph too: it is not to be replaced by a painting.
    write_picture(stack.out("dark.exr"), Image<Rgb>(32, 32), {});
    const std::string before = bytes_of(stack.out("dark.exr"));
    EXPECT_TRUE(
        ended(tangipaint(fit(stack, "dark.exr", {"--dark", stack.out("dark.exr")})), 1, {"would overwrite"}));
    EXPECT_EQ(bytes_of(stack.out("dark.exr")), before);
}

}  // namespace
}  // namespace tangi
