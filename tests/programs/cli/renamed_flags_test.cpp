// renamed_flags_test.cpp: flags of version 0.1 are taken by the names that they had, with a note.
#include "cli/renamed_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RenamedFlags, AreTakenByTheirOldNames) {
    for (const auto& [before, now] : {std::pair("--faithful", "--residual"),
                                      {"--faithful-terms", "--residual-terms"},
                                      {"--faithful-colour-terms", "--residual-colour-terms"},
                                      {"--faithful-samples", "--residual-samples"},
                                      {"--faithful-worth-db", "--residual-min-gain-db"},
                                      {"--coloured-lobes", "--specular-colour"},
                                      {"--drawn-out-lobes", "--anisotropic-specular"},
                                      {"--haze", "--second-lobe-weight"},
                                      {"--lamp-radius-deg", "--light-radius-deg"},
                                      {"--matt-ball", "--diffuse-sphere"},
                                      {"--no-balls", "--no-spheres"},
                                      {"--ball-radius-mm", "--sphere-radius-mm"},
                                      {"--ball-height-mm", "--sphere-height-mm"},
                                      {"--lamps", "--illuminants"},
                                      {"--lights-turn", "--light-rotation-deg"}}) {
        const RenamedFlags apart = with_present_flags({"fit", before, "3", "photos"});
        EXPECT_THAT(apart.words, ElementsAre("fit", now, "3", "photos"));
        EXPECT_THAT(apart.notes, ElementsAre(HasSubstr(std::string(before) + " is now " + now + ";")));
        EXPECT_THAT(with_present_flags({std::string(before) + "=-1"}).words,
                    ElementsAre(std::string(now) + "=-1"));
        EXPECT_THAT(with_present_flags({now, "3"}).notes, IsEmpty());
    }
}

TEST(RenamedFlags, OfAxesBecomeOne) {
    EXPECT_THAT(with_present_flags({"fit", "--lights-flip-y", "p"}).words,
                ElementsAre("fit", "p", "--light-axes=x,-y,z"));
    EXPECT_THAT(with_present_flags({"--lights-flip-x", "--lights-flip-y"}).words,
                ElementsAre("--light-axes=-x,-y,z"));
}

// Both may be meant, or one is left over: which, only who wrote them knows.
TEST(RenamedFlags, OfAxesBesideTheNewOneAreToldWhatToWrite) {
    const RenamedFlags both = with_present_flags({"fit", "--light-axes", "x,-y,z", "--lights-flip-x"});
    EXPECT_THAT(both.given_twice,
                "--lights-flip-x and --light-axes x,-y,z: both say how axes point; give one of them, or "
                "--light-axes -x,-y,z where both are meant");
    EXPECT_THAT(with_present_flags({"--lights-flip-x", "--light-axes=y,x,z"}).given_twice,
                HasSubstr("--light-axes y,-x,z where both are meant"));
    EXPECT_THAT(with_present_flags({"--lights-flip-y", "--light-axes=x,-y,z"}).given_twice,
                HasSubstr("--light-axes x,-y,z where both are meant"));
    EXPECT_THAT(with_present_flags({"--lights-flip-y", "--light-rotation-deg", "5"}).given_twice, IsEmpty());
}

TEST(CliRenamedFlags, AreTakenWithANote) {
    const TestDir dir;
    const Finished run = tangipaint({"calibrate", dir.path(), "--no-balls", "--out", dir / "c.json"});
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.err, HasSubstr("note: --no-balls is now --no-spheres"));
    EXPECT_THAT(run.err, testing::Not(HasSubstr("no such option")));
}

TEST(CliRenamedFlags, OfAxesBesideTheNewOneAreRefused) {
    const TestDir dir;
    const Finished run =
        tangipaint({"fit", dir.path(), "--light-axes", "-x,y,z", "--lights-flip-y", "--out", dir / "p.exr"});
    EXPECT_TRUE(
        ended(run, 2, {"or --light-axes -x,-y,z where both are meant", "See: tangipaint fit --help"}));
}

TEST(CliRenamedFlags, OfAxesThatAreNoneAreRefused) {
    const TestDir dir;
    EXPECT_TRUE(ended(tangipaint({"fit", dir.path(), "--light-axes", "x,y,-z", "--out", dir / "p.exr"}), 2,
                      {"--light-axes", "x,y,-z is none of"}));
}

}  // namespace
}  // namespace tangi
