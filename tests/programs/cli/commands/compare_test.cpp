// compare, run as a user would run it.
#include <gmock/gmock.h>

#include "surface/base/json_reading.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(CliCompare, WritesNumbersForEachPhotographAndAPage) {
    const TinyStack stack;
    // Two of the photographs count as held out.
    Surface s = read_painting(stack.truth());
    s.photography.photos[3].fitted = s.photography.photos[7].fitted = false;
    write_painting(stack.out("a.exr"), s);
    const std::string out = stack.out("new/report");
    const Finished run = tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", out});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.err, "");
    const nlohmann::json said = run.json(), file = read_json(read_text_file(out + "/compare.json"), "JSON");
    EXPECT_EQ(said["page"], out + "/compare.html");
    EXPECT_EQ(said["mean"], file["mean"]);
    ASSERT_EQ(file["photos"].size(), 12u);
    double held_out = 0, fitted = 0;
    for (int i = 0; i < 12; ++i) {
        const nlohmann::json& photo = file["photos"][static_cast<std::size_t>(i)];
        EXPECT_EQ(photo["name"], stack.name(i));
        EXPECT_EQ(photo["fitted"], i != 3 && i != 7);
        EXPECT_GT(photo["psnr_db"], 25);  // the truth itself: only noise and shadows' edges differ
        EXPECT_GT(photo["ssim"], 0.8);
        EXPECT_LT(photo["delta_e_2000"], 6);
        (photo["fitted"] ? fitted : held_out) += photo["psnr_db"].get<double>();
        for (const auto& [what, picture] : photo["pictures"].items())
            EXPECT_EQ(read_picture(fs::path(out) / picture.get<std::string>()).width(), 32) << what;
    }
    EXPECT_EQ(file["mean"]["held_out"]["count"], 2);
    EXPECT_EQ(file["mean"]["fitted"]["count"], 10);
    EXPECT_NEAR(file["mean"]["held_out"]["psnr_db"].get<double>(), held_out / 2, 1e-9);
    EXPECT_NEAR(file["mean"]["fitted"]["psnr_db"].get<double>(), fitted / 10, 1e-9);
    EXPECT_THAT(read_text_file(out + "/compare.html"), HasSubstr(stack.name(3)));
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
}

TEST(CliCompare, ComparesTheCropThatWasFitted) {
    const TinyStack stack;
    const std::string painting = stack.out("crop.exr");
    ASSERT_TRUE(ended(tangipaint({"fit", stack.path(), "--crop", "8,4,20,16", "--out", painting}), 0));
    const auto psnr_db = [&](const std::string& crop) {
        const Finished run =
            tangipaint({"compare", painting, stack.path(), "--crop", crop, "--out", stack.out("c")});
        return run.json()["mean"]["all"]["psnr_db"].get<double>();
    };
    EXPECT_GT(psnr_db("8,4,20,16"), psnr_db("0,0,20,16") + 5);  // another part is another picture
}

TEST(CliCompare, SaysEveryWarningOnce) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) { lines[0] = "99"; });
    const Finished run = tangipaint({"compare", stack.truth(), stack.path(), "--out", stack.out("c")});
    ASSERT_TRUE(ended(run, 0, {"says 99 lights, but 12 follow"}));
    ASSERT_EQ(run.json()["warnings"].size(), 1u);
    const auto first = run.err.find("says 99 lights");
    EXPECT_EQ(run.err.find("says 99 lights", first + 1), std::string::npos) << run.err;
}

TEST(CliCompare, PhotographsThePaintingDoesNotKnowCountAsHeldOut) {
    const TinyStack stack, other([](GeneratorOptions&o) { o.seed = 9; });
    fs::rename(other.photo(0), other.out("photos/stranger.png"));
    other.change_lights([&](auto& lines) { lines[1].replace(0, other.name(0).size(), "stranger.png"); });
    const Finished run = tangipaint({"compare", stack.truth(), other.path(), "--out", stack.out("c")});
    ASSERT_TRUE(ended(run, 0, {"1 of 12 photographs are not among those", "held out"}));
    EXPECT_EQ(run.json()["mean"]["held_out"]["count"], 1);
}

TEST(CliCompare, RefusesWhatCannotBeCompared) {
    const TinyStack stack;
    const auto refused = [&](const std::string& painting, const std::string& photos,
                             const std::vector<std::string>& said) {
        EXPECT_TRUE(ended(tangipaint({"compare", painting, photos, "--out", stack.out("c")}), 1, said));
        EXPECT_FALSE(fs::exists(stack.out("c/compare.html")));
        EXPECT_FALSE(fs::exists(stack.out("c/compare.json")));
    };
    Surface bare(32, 32);
    write_painting(stack.out("bare.exr"), bare);
    refused(stack.out("bare.exr"), stack.path(), {"does not come from photographs", "tangipaint fit"});
    Surface small(16, 16);
    small.photography = stack.photography();
    write_painting(stack.out("small.exr"), small);
    refused(stack.out("small.exr"), stack.path(), {"32 x 32", "16 x 16", "with the same crop"});
    refused(stack.out("none.exr"), stack.path(), {"none.exr: no such file"});
    refused(stack.truth(), stack.out("nowhere"), {"nowhere: no such folder"});
    refused(stack.photo(0), stack.path(), {stack.name(0), "is not a painting file"});
    refused(stack.path() + "/gt/height.exr", stack.path(), {"height.exr", "no part 'dry'", "tangipaint fit"});
    Surface unmeasured(32, 32);
    unmeasured.photography = stack.photography();
    write_painting(stack.out("dark.exr"), unmeasured);
    refused(stack.out("dark.exr"), stack.path(), {"measured nowhere"});
}

}  // namespace
}  // namespace tangi
