// no_window_test.cpp: where there is no display or no OpenGL, what the program says, and what draws
// without one.
#include <gmock/gmock.h>

#include "surface/render/relight.h"
#include "tests/programs/support/painting_window.h"

namespace tangi {
namespace {

TEST_F(Window, WithoutOpenGl33SaysSo) {
    Conditions old = screen_->conditions();
    old.environment["LIBGL_ALWAYS_INDIRECT"] = "1";  // draws in the server, OpenGL 1.4
    const Finished done = Program({"paint", painting_.string()}, old).wait();
    EXPECT_EQ(done.code, 1);
    EXPECT_THAT(done.err, testing::HasSubstr("no window with OpenGL 3.3 can be opened"));
    EXPECT_THAT(names_in(folder_.path()), testing::ElementsAre("small.exr"));
}

TEST(NoWindow, SaysWhatIsMissing) {
    TestDir folder;
    write_painting(folder / "a.exr", small_painting());
    Conditions nowhere;
    nowhere.environment = {{"DISPLAY", ":4711"}, {"WAYLAND_DISPLAY", ""}};
    const Finished done = Program({"paint", (folder / "a.exr").string()}, nowhere).wait();
    EXPECT_EQ(done.code, 1);
    EXPECT_THAT(done.err, testing::HasSubstr("no window can be opened"));
    EXPECT_THAT(done.err, testing::HasSubstr("display"));
    EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.exr"));
}

TEST(NoWindow, MistypedIsAUsageError) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"paint"},
                                                  {"paint", "a.exr", "--substrate", "linen"},
                                                  {"paint", "--substrate", "glass"},
                                                  {"paint", "--substrate", "linen", "--size", "big"}})
        EXPECT_EQ(Program(words).wait().code, 2);
}

// Relit by the program with these further words; what it said on stdout and stderr.
std::pair<Image<Rgb>, Finished> relit(const TestDir& folder, const std::string& name,
                                      std::vector<std::string> words, const Conditions& conditions = {}) {
    words.insert(words.begin(), {"relight", (folder / "a.exr").string(), "--light=-1,0.4,0.5",
                                 "--point-light=4,5,9", "--out", (folder / name).string()});
    Finished done = Program(words, conditions).wait();
    EXPECT_EQ(done.code, 0) << done.err;
    return {read_picture(folder / name), done};
}

TEST(RelightGpu, DrawsTheSamePicture) {
    try {
        gl::HeadlessContext();
    } catch (const Error& error) {
        GTEST_SKIP() << "no OpenGL here: " << error.what();
    }
    TestDir folder;
    write_painting(folder / "a.exr", small_painting());
    const auto [reference, by_reference] = relit(folder, "r.exr", {});
    const auto [drawn, by_gl] = relit(folder, "g.exr", {"--gpu"});
    EXPECT_GE(part_within(drawn, reference, 1), 0.999);
    EXPECT_EQ(by_reference.json()["drawn_by"], "reference renderer");
    EXPECT_NE(by_gl.json()["drawn_by"], "reference renderer");
}

TEST(RelightGpu, FallsBackWithANote) {
    TestDir folder;
    write_painting(folder / "a.exr", small_painting());
    Conditions bare;
    bare.environment = {{"__EGL_VENDOR_LIBRARY_DIRS", "/nowhere"}, {"LIBGL_DRIVERS_PATH", "/nowhere"}};
    const auto [reference, by_reference] = relit(folder, "r.exr", {});
    const auto [fallen, done] = relit(folder, "g.exr", {"--gpu"}, bare);
    EXPECT_TRUE(images_near(fallen, reference, 0));
    EXPECT_THAT(done.err, testing::HasSubstr("warning: --gpu: "));
    EXPECT_THAT(done.err, testing::HasSubstr("the reference renderer draws instead"));
    EXPECT_EQ(done.json()["drawn_by"], "reference renderer");
}

}  // namespace
}  // namespace tangi
