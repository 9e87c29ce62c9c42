// stack_test.cpp: photographs are matched to lights and held out.
#include "capture/stack/stack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "capture/stack/open_screened.h"
#include "capture/stack/stack_calibration.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

std::vector<std::string> names_of(const std::vector<StackPhoto>& photos) {
    std::vector<std::string> names;
    for (const StackPhoto& photo : photos) names.push_back(photo.path.filename().string());
    return names;
}

// A test stack whose photographs stay and whose lights file calls them by other names.
struct Renamed {
    TestDir dir;
    std::vector<Light> lights = dome_lights(5);

    explicit Renamed(const std::function<std::string(int)>& listed) {
        write_test_stack(dir, lights);
        for (std::size_t i = 0; i < lights.size(); ++i) lights[i].name = listed(static_cast<int>(i));
        write_lights(dir / "lights.lp", lights);
    }
};

void expect_photo_and_light_matched(const Stack& stack, const std::vector<Light>& lights) {
    ASSERT_EQ(stack.photos.size(), lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        EXPECT_EQ(stack.photos[i].path.filename(), fmt::format("photo_{:03}.png", i));
        EXPECT_EQ(stack.photos[i].light.name, lights[i].name);
        EXPECT_LE(glm::length(stack.photos[i].light.direction - lights[i].direction), 1e-6f);
    }
}

TEST(OpenStack, ReadsHeadersAndLights) {
    const TestDir dir;
    const std::vector<Light> lights = dome_lights(5);
    write_test_stack(dir, lights, 11, 7);
    const Stack stack = open_stack(dir.path());
    expect_photo_and_light_matched(stack, lights);
    EXPECT_EQ(stack.width(), 11);
    EXPECT_EQ(stack.height(), 7);
    EXPECT_EQ(stack.channels, 3);
    EXPECT_EQ(stack.bits, 8);
    EXPECT_FALSE(stack.transfer);
    EXPECT_TRUE(stack.mask.empty());
    EXPECT_THAT(stack.warnings, IsEmpty());
    EXPECT_EQ(stack.lights().size(), 5u);
}

TEST(OpenStack, TakesTheLightsFileThatIsNamed) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5));
    write_lights(dir / "other.lp",
                 {distant_light({1, 1, 1}, "photo_002.png"), distant_light({0, 1, 1}, "photo_004.png")});
    const Stack stack = open_stack(dir.path(), {.lights_file = dir / "other.lp"});
    EXPECT_THAT(names_of(stack.photos), ElementsAre("photo_002.png", "photo_004.png"));
    EXPECT_LE(glm::length(stack.photos[0].light.direction - glm::normalize(Vec3(1, 1, 1))), 1e-6f);
}

TEST(OpenStack, MatchesNamesByStem) {
    const Renamed r([](int i) { return fmt::format("photo_{:03}.CR2", i); });
    const Stack stack = open_stack(r.dir.path());
    expect_photo_and_light_matched(stack, r.lights);
    EXPECT_THAT(stack.warnings, IsEmpty());
}

TEST(OpenStack, MatchesNamesInAnyCase) {
    const Renamed r([](int i) { return fmt::format("PHOTO_{:03}.Png", i); });
    const Stack stack = open_stack(r.dir.path());
    expect_photo_and_light_matched(stack, r.lights);
    EXPECT_THAT(stack.warnings, IsEmpty());
}

// macOS writes marks as code points of their own, and files come from there in archives.
TEST(OpenStack, MatchesLettersWhoseMarksAreWrittenOtherwise) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(4);
    write_test_stack(dir, lights);
    fs::rename(dir / "photo_001.png", dir / "Gema\xcc\x88lde.png");  // a, diaeresis
    fs::rename(dir / "photo_002.png", dir / "\xc3\x89t\xc3\xa9.png");
    fs::rename(dir / "photo_003.png", dir / "\xd0\x98\xd0\xb9.png");  // Cyrillic I, short i
    lights[1].name = "Gem\xc3\xa4lde.png";
    lights[2].name = "e\xcc\x81tE\xcc\x81.png";
    lights[3].name = "\xd0\xb8\xd0\x98\xcc\x86.PNG";
    write_lights(dir / "lights.lp", lights);
    const Stack stack = open_stack(dir.path());
    ASSERT_EQ(stack.photos.size(), 4u);
    EXPECT_THAT(stack.warnings, IsEmpty());
    // Another letter is another name.
    lights[1].name = "Gemalde.png";
    write_lights(dir / "lights.lp", lights);
    EXPECT_THAT([&] { open_stack(dir.path()); }, testing::Throws<Error>());
}

TEST(OpenStack, MatchesNamesWithFoldersInFront) {
    for (const char* folder :
         {"./", "jpeg-exports/", "/home/somebody/may 3/", "C:\\Users\\scan\\", "..\\set\\"}) {
        const Renamed r([&](int i) { return fmt::format("{}photo_{:03}.png", folder, i); });
        const Stack stack = open_stack(r.dir.path());
        expect_photo_and_light_matched(stack, r.lights);
        EXPECT_THAT(stack.warnings, IsEmpty()) << folder;
    }
}

TEST(OpenStack, FindsPhotographsInTheFolderThatIsListed) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(4);
    fs::create_directory(dir / "jpeg");
    for (Light& light : lights) light.name = "jpeg/" + light.name;
    write_test_stack(dir, lights);
    const Stack stack = open_stack(dir.path());
    ASSERT_EQ(stack.photos.size(), 4u);
    EXPECT_EQ(stack.photos[1].path, dir / "jpeg/photo_001.png");
    EXPECT_THAT(stack.warnings, IsEmpty());
}

TEST(OpenStack, MatchesByOrderWithAWarningWhereNoNameMatches) {
    const Renamed r([](int i) { return fmt::format("IMG_{}.jpg", 9 - i); });
    const Stack stack = open_stack(r.dir.path());
    expect_photo_and_light_matched(stack, r.lights);
    EXPECT_THAT(
        stack.warnings,
        ElementsAre(fmt::format("{0}/lights.lp: none of its names ('IMG_9.jpg', …) is a photograph in {0}; "
                                "lights are taken in the order of the file names: the first is "
                                "photo_000.png's, the last photo_004.png's",
                                r.dir.path().string())));
}

// Lights and photographs are numbered as people count; a file that a program sorted by letters says so
// itself.
TEST(OpenStack, TakesLightsInTheOrderThatTheirNumbersHave) {
    for (const bool by_letters : {false, true}) {
        const TestDir dir;
        std::vector<Light> lights = dome_lights(12);
        write_test_stack(dir, lights);
        std::vector<std::string> order;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const std::string name = fmt::format("shot{}", i + 1);
            fs::rename(dir / lights[i].name, dir / (name + ".png"));
            order.push_back(name);
            lights[i].name = "lamp_" + std::to_string(i + 1) + ".tif";
        }
        if (by_letters) {
            std::sort(order.begin(), order.end());
            std::sort(lights.begin(), lights.end(), [](auto& a, auto& b) { return a.name < b.name; });
        }
        write_lights(dir / "lights.lp", lights);
        const Stack stack = open_stack(dir.path());
        ASSERT_EQ(stack.photos.size(), 12u);
        for (std::size_t i = 0; i < 12; ++i) {
            EXPECT_EQ(stack.photos[i].path.stem(), order[i]);
            EXPECT_LE(glm::length(stack.photos[i].light.direction - lights[i].direction), 1e-6f);
        }
        EXPECT_THAT(stack.warnings, ElementsAre(HasSubstr("the last " + order.back() + ".png's")));
    }
}

TEST(OpenStack, WarnsOfPhotographsThatAreNotListed) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5));
    write_picture_8bit(dir / "chart.png", Image<Rgb>(3, 3, Rgb(1)));
    write_bytes(dir / ".hidden.png", "no photograph");
    write_bytes(dir / "notes.txt", "neither");
    EXPECT_THAT(open_stack(dir.path()).warnings,
                ElementsAre(dir.path().string() +
                            ": 1 photographs are not listed in lights.lp and not used: chart.png"));
}

TEST(OpenStack, APaintingBesidePhotographsIsNone) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5));
    write_painting(dir / "fitted.exr", Surface(8, 6));
    EXPECT_THAT(open_stack(dir.path()).warnings, IsEmpty());
}

TEST(OpenStack, PassesOnTheWarningsOfTheLightsFile) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5));
    const std::string text = bytes_of(dir / "lights.lp");
    write_bytes(dir / "lights.lp", "6" + text.substr(1));
    EXPECT_THAT(open_stack(dir.path()).warnings,
                ElementsAre(HasSubstr("its first line says 6 lights, but 5 follow")));
}

TEST(OpenStack, LeavesOutALightFromBelowWithAWarning) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(5);
    lights[1].direction = glm::normalize(Vec3(1, 0, -0.5f));
    write_test_stack(dir, lights);
    const Stack stack = open_stack(dir.path());
    EXPECT_THAT(names_of(stack.photos),
                ElementsAre("photo_000.png", "photo_002.png", "photo_003.png", "photo_004.png"));
    EXPECT_THAT(stack.warnings,
                ElementsAre(dir.path().string() +
                            "/lights.lp: rejected 1 photograph lit from below the painting's plane: "
                            "photo_001.png (z = -0.4472)"));
    const UsableStack usable = open_usable_stack(dir.path(), {});
    ASSERT_EQ(usable.rejected.size(), 1u);
    EXPECT_EQ(usable.rejected[0].name, "photo_001.png");
    EXPECT_THAT(usable.rejected[0].reason, HasSubstr("below the painting's plane (z = -0.4472)"));
}

TEST(HoldOut, TakesPositionsNamesAndSteps) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(12));
    const auto held = [&](const std::string& which) {
        Stack stack = open_stack(dir.path());
        hold_out(stack, which);
        EXPECT_EQ(stack.photos.size() + stack.held_out.size(), 12u) << which;
        std::string numbers;
        for (const std::string& name : names_of(stack.held_out)) numbers += name.substr(7, 2) + " ";
        for (const std::string& name : names_of(stack.photos))
            EXPECT_THAT(numbers, Not(HasSubstr(name.substr(7, 2) + " ")));
        return numbers;
    };
    EXPECT_EQ(held("4"), "04 ");
    EXPECT_EQ(held("11,0,3"), "00 03 11 ");
    EXPECT_EQ(held(" 0, 3\t,11 "), "00 03 11 ");
    EXPECT_EQ(held("4:8"), "04 ");
    EXPECT_EQ(held("1:4"), "01 05 09 ");
    EXPECT_EQ(held("0:1"), "00 01 02 03 04 05 06 07 08 09 10 11 ");
    EXPECT_EQ(held("photo_007.png"), "07 ");
    EXPECT_EQ(held("photo_007.png,2,2,0:6"), "00 02 06 07 ");
    EXPECT_EQ(held(""), "");
}

TEST(HoldOut, CountsPositionsInTheLightsFileAlsoWhereLightsWereLeftOut) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(12);
    lights[0].direction.z = -0.2f;
    lights[6].direction.z = -0.2f;
    write_test_stack(dir, lights);
    Stack stack = open_stack(dir.path());
    hold_out(stack, "4,7");
    EXPECT_THAT(names_of(stack.held_out), ElementsAre("photo_004.png", "photo_007.png"));
    stack = open_stack(dir.path());
    hold_out(stack, "2:4");  // 2, 6 (rejected), 10
    EXPECT_THAT(names_of(stack.held_out), ElementsAre("photo_002.png", "photo_010.png"));
    EXPECT_EQ(error_of([&] { hold_out(stack, "6"); }),
              "--hold-out 6: there is no photograph 6; " + dir.path().string() + " has photographs 1 to 11");
}

TEST(HoldOut, OfWhatIsNotThereIsAnError) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5));
    Stack stack = open_stack(dir.path());
    const std::string has = dir.path().string() + " has photographs 0 to 4";
    EXPECT_EQ(error_of([&] { hold_out(stack, "5"); }), "--hold-out 5: there is no photograph 5; " + has);
    EXPECT_EQ(error_of([&] { hold_out(stack, "1,7:2"); }),
              "--hold-out 1,7:2: there is no photograph 7:2; " + has);
    for (const char* word : {"no.png", "4-8", "99999999999999999999"})
        EXPECT_EQ(error_of([&] { hold_out(stack, word); }),
                  fmt::format("--hold-out {0}: there is no photograph {0}; {1}; give such numbers, names, or "
                              "START:STEP for every STEPth from START on",
                              word, has));
    for (const char* wrong : {"1:0", "1:", "1:x", "1:-2"})
        EXPECT_EQ(error_of([&] { hold_out(stack, wrong); }),
                  fmt::format("--hold-out {0}: '{0}' is not START:STEP with a step of at least 1", wrong));
    EXPECT_EQ(stack.photos.size(), 5u);  // untouched
}

TEST(RequireEnoughLights, RefusesFewerThanFour) {
    std::vector<Light> lights = dome_lights(3);
    EXPECT_EQ(error_of([&] { require_enough_lights(lights, "set"); }),
              "set: 3 usable photographs; at least 4 under different lights are needed");
    EXPECT_NO_THROW(require_enough_lights(dome_lights(4), "set"));
}

TEST(RequireEnoughLights, RefusesLightsInOnePlaneHoweverItIsTurned) {
    Random random(1);
    for (int i = 0; i < 300; ++i) {
        // A plane through the origin that rises from the picture: spanned by an axis in it and one near the
        // zenith.
        const double turn = random.uniform(0, std::numbers::pi), tilt = random.uniform(-1, 1);
        const glm::dvec3 along(std::cos(turn), std::sin(turn), 0);
        const glm::dvec3 up = glm::normalize(glm::dvec3(-std::sin(turn) * tilt, std::cos(turn) * tilt, 1));
        std::vector<Light> lights;
        for (int k = 0; k < 20; ++k) {
            const double low = (k % 2 ? 1 : -1) * random.uniform(0.8, 1.4);  // mostly raking light
            lights.push_back(distant_light(Vec3(std::sin(low) * along + std::cos(low) * up)));
        }
        EXPECT_THAT(error_of([&] { require_enough_lights(lights, "set"); }),
                    HasSubstr("set: all lights lie in one plane (within 0.0 degrees)"))
            << "turned by " << turn << ", tilted by " << tilt;
    }
}

TEST(RequireEnoughLights, DrawsTheLineAtAboutOneDegreeOffThePlane) {
    const auto lights_off_the_plane = [](double degrees) {
        std::vector<Light> lights;
        for (int k = 0; k < 12; ++k) {
            const double low = (k - 5.5) / 5, off = (k / 2 % 2 ? 1 : -1) * degrees * std::numbers::pi / 180;
            lights.push_back(distant_light(Vec3(
                glm::dvec3(std::cos(off) * std::sin(low), std::sin(off), std::cos(off) * std::cos(low)))));
        }
        return lights;
    };
    EXPECT_THAT(error_of([&] { require_enough_lights(lights_off_the_plane(0.5), "set"); }),
                HasSubstr("in one plane (within 0.5 degrees)"));
    EXPECT_NO_THROW(require_enough_lights(lights_off_the_plane(1.5), "set"));
}

TEST(RequireEnoughLights, AcceptsDomesAndRingsOfOneElevation) {
    for (const double elevation : {10.0, 30.0, 60.0, 80.0}) {
        std::vector<Light> lights;
        for (int k = 0; k < 8; ++k) {
            const double e = elevation * std::numbers::pi / 180, turn = k * std::numbers::pi / 4;
            lights.push_back(distant_light(
                Vec3(glm::dvec3(std::cos(e) * std::cos(turn), std::cos(e) * std::sin(turn), std::sin(e)))));
        }
        EXPECT_NO_THROW(require_enough_lights(lights, "set")) << elevation;
    }
    EXPECT_NO_THROW(require_enough_lights(dome_lights(40), "set"));
}

// The first and the second number of a line become what the text says at their places.
TEST(LightAxes, AreSaidBySignsAndOrder) {
    const TestDir dir;
    const std::vector<Light> lights = dome_lights(5);
    write_test_stack(dir, lights);
    for (const char* text :
         {"x,y,z", "x,-y,z", "-x,y,z", "-x,-y,z", "y,x,z", "y,-x,z", "-y,x,z", "-y,-x,z"}) {
        const auto axes = light_axes_of(text);
        ASSERT_TRUE(axes) << text;
        EXPECT_EQ(in_words(*axes), text);
        const std::vector<Light> read = read_stack_calibration(dir.path(), {}, *axes).lights;
        ASSERT_EQ(read.size(), lights.size());
        const std::string_view said = text, first = said.substr(0, said.find(','));
        const std::string_view second = said.substr(first.size() + 1, said.rfind(',') - first.size() - 1);
        const auto of = [](std::string_view term, const Vec3& listed) {
            return (term.front() == '-' ? -1 : 1) * (term.back() == 'x' ? listed.x : listed.y);
        };
        for (std::size_t i = 0; i < lights.size(); ++i) {
            EXPECT_NEAR(read[i].direction.x, of(first, lights[i].direction), 1e-5) << text;
            EXPECT_NEAR(read[i].direction.y, of(second, lights[i].direction), 1e-5) << text;
            EXPECT_NEAR(read[i].direction.z, lights[i].direction.z, 1e-5) << text;
        }
    }
    for (const char* none : {"", "x", "x,x,z", "x,y,-z", "z,y,x", "x,y", "x, y, z", "x,y,z,"})
        EXPECT_FALSE(light_axes_of(none)) << none;
}

TEST(DataStack, OfAllRealSetsOpens) {
    TP_DATA(real, "real");
    for (const char* name : {"canvas", "coin", "door", "fresco", "icon", "leaf"}) {
        const Stack stack = open_stack(real / name);
        EXPECT_GE(stack.photos.size(), 45u) << name;
        EXPECT_NO_THROW(require_enough_lights(stack.lights(), name));
        StackReader reader(stack);
        const Band band = reader.read(stack.height() / 2, stack.height() / 2 + 1, Transfer{});
        float brightest = 0;
        for (int i = 0; i < band.photos(); ++i)
            for (int x = 0; x < band.width(); ++x)
                brightest = std::max(brightest, band.row(i, 1, band.y0())[x]);
        EXPECT_GT(brightest, 0.1f) << name;
        EXPECT_LE(brightest, 1.0f) << name;
    }
}

}  // namespace
}  // namespace tangi
