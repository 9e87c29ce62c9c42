// painting_file_test.cpp: paintings go to disk and come back bit for bit, or the Error says why not.
#include "surface/painting_file/painting_file.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surface/base/parallel.h"
#include "tests/support/surface/foreign_painting.h"
#include "tests/support/surface/painting_file_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

void expect_same_maps(const Surface& a, const Surface& b) {
    EXPECT_TRUE(images_identical(a.height_mm, b.height_mm));
    EXPECT_TRUE(images_identical(a.normal, b.normal));
    EXPECT_TRUE(images_identical(a.diffuse, b.diffuse));
    EXPECT_TRUE(images_identical(a.specular, b.specular));
    EXPECT_TRUE(images_identical(a.roughness, b.roughness));
    EXPECT_TRUE(images_identical(a.confidence, b.confidence));
}

// An EXR file of constant channels (0.5; the normal is a unit vector), one part for each name.
void write_exr(const std::filesystem::path& path, const std::vector<std::string>& parts,
               const std::vector<std::string>& channels) {
    std::vector<OIIO::ImageSpec> specs;
    for (const std::string& part : parts) {
        OIIO::ImageSpec spec(4, 3, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
        spec.channelnames = channels;
        spec.attribute("oiio:subimagename", part);
        specs.push_back(spec);
    }
    const auto output = OIIO::ImageOutput::create(path.string());
    std::vector<float> values(12 * channels.size(), 0.5f);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (channels[i % channels.size()] == "normal.Z") values[i] = std::sqrt(0.5f);
    ASSERT_TRUE(output->open(path.string(), static_cast<int>(specs.size()), specs.data()));
    for (std::size_t i = 0; i < specs.size(); ++i) {
        if (i > 0) {
            ASSERT_TRUE(output->open(path.string(), specs[i], OIIO::ImageOutput::AppendSubimage));
        }
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    }
    ASSERT_TRUE(output->close());
}

const std::vector<std::string> kChannels = {"height",    "normal.X",  "normal.Y", "normal.Z",  "diffuse.R",
                                            "diffuse.G", "diffuse.B", "specular", "roughness", "confidence"};

TEST(PaintingFile, RoundTripsBitForBit) {
    const TestDir dir;
    Surface s = random_surface(37, 301);  // more rows than are read at once
    s.height_mm(0, 0) = -0.0f;
    s.height_mm(1, 0) = std::numeric_limits<float>::denorm_min();
    s.height_mm(2, 0) = std::numeric_limits<float>::max();
    s.height_mm(3, 0) = std::numeric_limits<float>::lowest();
    s.confidence(4, 0) = 0;   // kept as it is where it can be relit
    s.mm_per_pixel = 0.0625;  // exact in a float, as the file holds it
    s.scale_known = true;
    s.reflectance_model = {.diffuse_roughness = 0.3, .second_lobe_weight = 0.6};
    s.provenance = R"({"program": "test", "note": "Größe, \"quoted\"\nsecond line"})";
    s.photography.transfer = {Transfer::Kind::gamma, 1 / 0.45};
    s.photography.white_level = 0.1 + 0.2;  // no short decimal
    Light near = near_light({100.1f, -200.2f, 300.3f}, "photos of may/img 1.jpg");
    near.gain = {0.1f, 1.7f, 3.3f};
    s.photography.photos = {{near, true}, {distant_light({0.1f, 0.2f, 0.9f}, "b"), false}};

    write_painting(dir / "a.exr", s);
    const Surface back = read_painting(dir / "a.exr");
    expect_same_maps(s, back);
    EXPECT_EQ(back.mm_per_pixel, s.mm_per_pixel);
    EXPECT_TRUE(back.scale_known);
    EXPECT_EQ(back.reflectance_model, s.reflectance_model);
    EXPECT_EQ(back.provenance, s.provenance);
    EXPECT_EQ(back.photography.transfer, s.photography.transfer);
    EXPECT_EQ(back.photography.white_level, s.photography.white_level);
    ASSERT_EQ(back.photography.photos.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto &there = back.photography.photos[i], &here = s.photography.photos[i];
        EXPECT_EQ(there.light.name, here.light.name);
        EXPECT_EQ(there.light.direction, here.light.direction);
        EXPECT_EQ(there.light.position_mm, here.light.position_mm);
        EXPECT_EQ(there.light.gain, here.light.gain);
        EXPECT_EQ(there.fitted, here.fitted);
    }
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"a.exr"});
}

TEST(PaintingFile, KeepsTheColoursOfLobes) {
    const TestDir dir;
    Surface s = random_surface(19, 23);
    const std::string white = hash_of(s);
    s.specular_colour = Image<Rgb>(19, 23, Rgb(1));
    Random random(2);
    for (Rgb& colour : s.specular_colour.pixels()) colour = {1, random.real(), random.real()};
    write_painting(dir / "a.exr", s);
    const Surface back = read_painting(dir / "a.exr");
    expect_same_maps(s, back);
    EXPECT_TRUE(images_identical(s.specular_colour, back.specular_colour));
    EXPECT_NE(hash_of(s), white);
    s.specular_colour(5, 7) = {1, 0.5f, 1.5f};
    s.confidence(5, 7) = 1;
    write_as_another_program(dir / "a.exr", s);
    EXPECT_THAT(error_of([&] { read_painting(dir / "a.exr"); }),
                testing::AllOf(HasSubstr("map 'lobe' holds (1, 0.5, 1.5)"), HasSubstr("pixel (5, 7)")));
}

TEST(PaintingFile, KeepsTheAxesOfLobes) {
    const TestDir dir;
    Surface s = random_surface(19, 23);
    const std::string isotropic = hash_of(s);
    s.lobe_axes = Image<LobeAxes>(19, 23);
    Random random(3);
    for (LobeAxes& axes : s.lobe_axes.pixels())
        axes = {static_cast<float>(random.real(0.01, 0.3)), static_cast<float>(random.real(-1.5, 1.5))};
    write_painting(dir / "a.exr", s);
    const Surface back = read_painting(dir / "a.exr");
    expect_same_maps(s, back);
    EXPECT_EQ(back.lobe_axes.pixels().size(), s.lobe_axes.pixels().size());
    EXPECT_TRUE(std::equal(back.lobe_axes.pixels().begin(), back.lobe_axes.pixels().end(),
                           s.lobe_axes.pixels().begin()));
    EXPECT_TRUE(back.specular_colour.empty());
    EXPECT_NE(hash_of(s), isotropic);
    s.lobe_axes(5, 7).roughness_v = 0;
    s.confidence(5, 7) = 1;
    write_as_another_program(dir / "a.exr", s);
    EXPECT_THAT(error_of([&] { read_painting(dir / "a.exr"); }),
                testing::AllOf(HasSubstr("map 'roughness.V' holds 0"), HasSubstr("pixel (5, 7)")));
    s.confidence(5, 7) = 0;
    write_as_another_program(dir / "a.exr", s);
    EXPECT_EQ(read_painting(dir / "a.exr").lobe_axes(5, 7), (LobeAxes{0.3f, 0})) << "not measured";
}

TEST(PaintingFile, RefusesALawThatIsNone) {
    const TestDir dir;
    Surface s(2, 2);
    s.reflectance_model.second_lobe_weight = 1.5;
    write_painting(dir / "a.exr", s);
    EXPECT_EQ(error_of([&] { read_painting(dir / "a.exr"); }),
              (dir / "a.exr").string() + ": second_lobe_weight = 1.5 is not from 0 to 1");
}

TEST(PaintingFile, KeepsAScaleToSevenDigits) {
    const TestDir dir;
    Surface s(2, 2);
    s.mm_per_pixel = 0.059;
    write_painting(dir / "a.exr", s);
    EXPECT_EQ(read_painting(dir / "a.exr").mm_per_pixel, 0.059);  // though it is a float in the file
    EXPECT_FALSE(read_painting(dir / "a.exr").scale_known);
}

TEST(PaintingFile, HasTheSameBytesFromAnyNumberOfThreads) {
    const TestDir dir;
    const Surface s = random_surface(64, 700);
    set_thread_count(1);
    write_painting(dir / "one.exr", s);
    set_thread_count(2);
    write_painting(dir / "two.exr", s);
    set_thread_count(0);
    EXPECT_TRUE(bytes_of(dir / "one.exr") == bytes_of(dir / "two.exr"));
}

TEST(PaintingFile, ShowsOiiotoolTheChannelsOfTheDesign) {
    if (std::system("oiiotool --help > /dev/null 2>&1") != 0)
        GTEST_SKIP() << "skipped: oiiotool is not installed";
    const TestDir dir;
    Surface s = random_surface(6, 4);
    s.mm_per_pixel = 0.25;
    write_painting(dir / "a.exr", s);
    const std::string out = (dir / "info.txt").string();
    ASSERT_EQ(std::system(fmt::format("oiiotool --info -v {} > {}", (dir / "a.exr").string(), out).c_str()),
              0);
    const std::string info = bytes_of(out);
    EXPECT_THAT(info, HasSubstr("6 x    4, 10 channel, float openexr"));
    for (const std::string& channel : kChannels) EXPECT_THAT(info, HasSubstr(channel));
    EXPECT_THAT(info, HasSubstr("mm_per_pixel: 0.25"));
    EXPECT_THAT(info, HasSubstr("\"dry\""));
    EXPECT_THAT(info, HasSubstr(fmt::format("dry_hash: \"{}\"", hash_of(s))));
}

TEST(PaintingFile, FindsTheDryPartAmongOthers) {
    const TestDir dir;
    write_exr(dir / "a.exr", {"wet", "dry", "fill"}, kChannels);
    const Surface s = read_painting(dir / "a.exr");
    EXPECT_TRUE(images_near(s.normal, Image<Vec3>(4, 3, Vec3(0.5f, 0.5f, std::sqrt(0.5f))), 0));
    EXPECT_TRUE(is_painting(dir / "a.exr"));
}

TEST(PaintingFile, ThatIsMissingIsAnError) {
    EXPECT_EQ(error_of([] { read_painting("/nowhere/a.exr"); }), "/nowhere/a.exr: no such file");
    EXPECT_FALSE(is_painting("/nowhere/a.exr"));
}

TEST(PaintingFile, ThatIsNoExrIsAnError) {
    const TestDir dir;
    for (const char* content : {"", "v", "\x76\x2f\x31\x01", "This is a text file, not an EXR file.\n"}) {
        write_bytes(dir / "a.exr", content);
        EXPECT_THAT(error_of([&] { read_painting(dir / "a.exr"); }),
                    StartsWith((dir / "a.exr").string() + ": is "));
        EXPECT_FALSE(is_painting(dir / "a.exr"));
    }
    EXPECT_THAT(error_of([&] { read_painting(dir.path()); }), StartsWith(dir.path().string() + ": "));
}

// The system gives no bytes of /proc/self/mem at its beginning (EIO), as of a disk that fails.
TEST(PaintingFile, OnADiskThatFailsIsNotCalledDamaged) {
    EXPECT_EQ(error_of([] { read_painting("/proc/self/mem"); }),
              "/proc/self/mem: cannot be read: Input/output error");
}

TEST(PaintingFile, TruncatedAnywhereIsAnError) {
    const TestDir dir;
    write_painting(dir / "a.exr", random_surface(9, 40));
    const std::string whole = bytes_of(dir / "a.exr");
    for (std::size_t length = 0; length < whole.size(); length += length < 900 ? 13 : 997) {
        write_bytes(dir / "cut.exr", whole.substr(0, length));
        EXPECT_THAT(error_of([&] { read_painting(dir / "cut.exr"); }),
                    AllOf(StartsWith((dir / "cut.exr").string() + ": is "), Not(HasSubstr("\"")),
                          Not(HasSubstr("bytes"))))
            << "cut at " << length << " of " << whole.size();
    }
    write_bytes(dir / "cut.exr", whole.substr(0, whole.size() - 1));
    EXPECT_NE(error_of([&] { read_painting(dir / "cut.exr"); }), "");
}

TEST(PaintingFile, WithoutPartDryIsAnError) {
    const TestDir dir;
    write_exr(dir / "a.exr", {"wet"}, kChannels);
    EXPECT_EQ(error_of([&] { read_painting(dir / "a.exr"); }),
              (dir / "a.exr").string() +
                  ": is an EXR file, but not a painting: it has no part 'dry'. Make one with: "
                  "tangipaint fit");
    EXPECT_FALSE(is_painting(dir / "a.exr"));
}

TEST(PaintingFile, WithoutOneOfItsChannelsIsAnError) {
    const TestDir dir;
    for (const std::string& missing : kChannels) {
        std::vector<std::string> channels;
        for (const std::string& name : kChannels)
            if (name != missing) channels.push_back(name);
        write_exr(dir / "a.exr", {"dry"}, channels);
        EXPECT_EQ(error_of([&] { read_painting(dir / "a.exr"); }),
                  fmt::format("{}: part 'dry' has no channel '{}'", (dir / "a.exr").string(), missing));
    }
}

TEST(PaintingFile, WithAnyBitOfAMapChangedIsAnError) {
    // One value of one map changed, the file rewritten with the old hash in place of its own.
    const TestDir dir;
    const Surface s = random_surface(8, 6);
    Surface other = s;
    other.roughness(3, 2) = std::nextafter(other.roughness(3, 2), 2.0f);
    write_painting(dir / "a.exr", other);
    std::string bytes = bytes_of(dir / "a.exr");
    const std::string old_hash = hash_of(s), new_hash = hash_of(other);
    ASSERT_NE(old_hash, new_hash);
    bytes.replace(bytes.find(new_hash), new_hash.size(), old_hash);
    write_bytes(dir / "a.exr", bytes);
    EXPECT_EQ(error_of([&] { read_painting(dir / "a.exr"); }),
              fmt::format("{}: the dry layer is not the one that was saved (hash {} expected, {} found)",
                          (dir / "a.exr").string(), old_hash, new_hash));
}

TEST(PaintingFile, ThatCannotBeRelitIsAnErrorThatNamesMapAndPixel) {
    const TestDir dir;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    infinite = std::numeric_limits<float>::infinity();
    const auto error_with = [&](const auto& change) {
        Surface s = random_surface(8, 6);
        change(s);
        // Ours is not written at all.
        EXPECT_THROW(write_painting(dir / "ours.exr", s), ContractError);
        EXPECT_FALSE(std::filesystem::exists(dir / "ours.exr"));
        write_as_another_program(dir / "a.exr", s);
        const std::string message = error_of([&] { read_painting(dir / "a.exr"); });
        EXPECT_THAT(message, StartsWith((dir / "a.exr").string() + ": map '"));
        EXPECT_THAT(message, HasSubstr("set confidence to 0 there"));
        return message;
    };
    const auto says = [](const std::string& what) { return HasSubstr(what + " at pixel (5, 3)"); };
    EXPECT_THAT(error_with([&](Surface& s) { s.height_mm(5, 3) = nan; }), HasSubstr("'height' holds nan at"));
    EXPECT_THAT(error_with([&](Surface& s) { s.normal(5, 3).y = nan; }), says("'normal.Y' holds nan"));
    EXPECT_THAT(error_with([&](Surface& s) { s.diffuse(5, 3).g = -infinite; }),
                says("'diffuse.G' holds -inf"));
    EXPECT_THAT(error_with([&](Surface& s) { s.specular(5, 3) = infinite; }), says("'specular' holds inf"));
    EXPECT_THAT(error_with([&](Surface& s) { s.roughness(5, 3) = nan; }), says("'roughness' holds nan"));
    EXPECT_THAT(error_with([&](Surface& s) { s.confidence(5, 3) = nan; }), says("'confidence' holds nan"));
    for (const float small : {0.0f, -0.2f, 1e-20f})
        EXPECT_THAT(error_with([&](Surface& s) { s.roughness(5, 3) = small; }),
                    says(fmt::format("'roughness' holds {}, less than 1e-06", small)));
    for (const Vec3 vector : {Vec3(0, 0, 1.02f), Vec3(0, 0, 0.98f), Vec3(1e30f, 0, 1e30f)})
        EXPECT_THAT(error_with([&](Surface& s) { s.normal(5, 3) = vector; }),
                    says("which is no unit vector"));
    for (const Vec3 vector : {Vec3(0), Vec3(0, 0, -1), Vec3(1, 0, 0)})
        EXPECT_THAT(error_with([&](Surface& s) { s.normal(5, 3) = vector; }), says("which points away"));
    // The first one is named, whichever thread meets its first.
    EXPECT_THAT(error_with([&](Surface& s) { s.specular(7, 5) = s.specular(5, 3) = s.specular(6, 3) = nan; }),
                says("'specular' holds nan"));
}

TEST(PaintingFile, OfAnotherProgramIsReadAsTheDocumentsSay) {
    const TestDir dir;
    Surface s = random_surface(8, 6);
    // Off by the rounding of half floats: normalised.
    const Vec3 unit = s.normal(1, 1);
    s.normal(1, 1) = 0.995f * unit;
    // Zeros, or not even numbers, where nothing was measured: as our own pixels that were not measured.
    s.confidence(2, 2) = s.confidence(3, 2) = 0;
    s.normal(2, 2) = Vec3(0);
    s.roughness(2, 2) = 0;
    s.height_mm(3, 2) = s.diffuse(3, 2).r = std::numeric_limits<float>::quiet_NaN();
    write_painting(dir / "a.exr", s);
    const Surface back = read_painting(dir / "a.exr");
    EXPECT_LE(glm::length(back.normal(1, 1) - unit), 1e-6f);
    EXPECT_EQ(back.height_mm(2, 2), s.height_mm(2, 2));
    EXPECT_EQ(back.height_mm(3, 2), 0);
    const Surface unmeasured(1, 1);
    for (const int x : {2, 3}) {
        EXPECT_EQ(back.normal(x, 2), unmeasured.normal(0, 0));
        EXPECT_EQ(back.diffuse(x, 2), unmeasured.diffuse(0, 0));
        EXPECT_EQ(back.specular(x, 2), unmeasured.specular(0, 0));
        EXPECT_EQ(back.roughness(x, 2), unmeasured.roughness(0, 0));
        EXPECT_EQ(back.confidence(x, 2), 0);
    }
}

TEST(PaintingFile, WithAnyByteDamagedIsAnErrorOrHoldsTheSameMaps) {
    const TestDir dir;
    const Surface s = random_surface(6, 5);
    write_painting(dir / "a.exr", s);
    const std::string whole = bytes_of(dir / "a.exr");
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); at += at < 900 ? 1 : 37) {  // every byte of the header
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 ? 1 : -128));
        write_bytes(dir / "b.exr", damaged);
        try {
            expect_same_maps(read_painting(dir / "b.exr"), s);
        } catch (const Error& error) {
            ++refused;
            ASSERT_THAT(error.what(), StartsWith((dir / "b.exr").string() + ": ")) << "byte " << at;
        }
    }
    EXPECT_GT(refused, 450);
}

}  // namespace
}  // namespace tangi
