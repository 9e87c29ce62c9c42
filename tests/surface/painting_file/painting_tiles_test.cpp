// painting_tiles_test.cpp: a painting as a folder of tiles is the painting bit for bit; what is torn or
// damaged in it is named, and made whole by running again.
#include "surface/painting_file/painting_tiles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>

#include "surface/file/output_set.h"
#include "surface/maps/reduced_surface.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_output.h"
#include "tests/support/surface/painting_file_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Two columns and two rows of tiles, of odd sizes.
constexpr int kWide = kPaintingTile + 77, kTall = kPaintingTile + 35;

// Every pixel is another, in numbers that pack quickly.
Surface tileable_surface(int width = kWide, int height = kTall) {
    Surface s(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = static_cast<float>(x) / 1024, v = static_cast<float>(y) / 1024;
            s.height_mm(x, y) = u - v;
            s.normal(x, y) = normal_of({u / 4, v / 8});
            s.diffuse(x, y) = {u / 2, v / 2, 0.25f};
            s.specular(x, y) = (x / 64 + y / 64) % 2 == 0 ? 0.03125f : 0.0625f;
            s.roughness(x, y) = 0.125f + v / 16;
            s.confidence(x, y) = (x + y) % 511 == 0 ? 0.0f : 1.0f;
        }
    s.mm_per_pixel = kept_scale_mm(0.05);
    s.scale_known = true;
    s.reflectance_model.diffuse_roughness = 0.25;
    s.photography.white_level = 0.75;
    s.photography.photos.push_back({distant_light({0.5f, 0.5f, 0.7071f})});
    s.provenance = R"({"command":"fit","program":"tangipaint"})";
    return s;
}

void expect_same_surface(const Surface& a, const Surface& b) {
    EXPECT_TRUE(images_identical(a.height_mm, b.height_mm));
    EXPECT_TRUE(images_identical(a.normal, b.normal));
    EXPECT_TRUE(images_identical(a.diffuse, b.diffuse));
    EXPECT_TRUE(images_identical(a.specular, b.specular));
    EXPECT_TRUE(images_identical(a.roughness, b.roughness));
    EXPECT_TRUE(images_identical(a.confidence, b.confidence));
    EXPECT_TRUE(images_identical(a.specular_colour, b.specular_colour));
    EXPECT_EQ(a.lobe_axes.size(), b.lobe_axes.size());
    EXPECT_TRUE(std::ranges::equal(a.lobe_axes.pixels(), b.lobe_axes.pixels()));
}

// A part of halves that only the first tile has anything of.
PartToWrite part_in_corner(int width, int height) {
    return {{"errors", width, height, {"slope"}, {{"unit", "1"}}, true},
            [width](int y0, int y1, std::span<float* const> rows) {
                for (int y = y0; y < std::min(y1, 4); ++y)
                    for (int x = 0; x < 5; ++x) rows[0][(y - y0) * width + x] = 0.5f + static_cast<float>(y);
            }};
}

PartToWrite palette_part(int side, const char* name = "palette") {
    return {{name, side, side, {"volume"}, {}, false}, [side](int y0, int y1, std::span<float* const> rows) {
                std::fill_n(rows[0], (y1 - y0) * side, 0.125f);
            }};
}

void write_with_parts(const fs::path& file, const Surface& s) {
    AtomicFile atomic(file);
    // In an order that is neither that of their names nor that of their sizes.
    const std::vector<PartToWrite> parts = {palette_part(6), part_in_corner(s.width(), s.height()),
                                            palette_part(3, "card")};
    write_painting(atomic, s, parts);
}

void flip_bit(const fs::path& file, std::size_t from_the_end) {
    std::string bytes = bytes_of(file);
    bytes[bytes.size() - from_the_end] = static_cast<char>(bytes[bytes.size() - from_the_end] ^ 0x10);
    write_bytes(file, bytes);
}

TEST(PaintingTiles, AFileAsTilesAndBackIsTheSameBitForBit) {
    const TestDir dir;
    const fs::path file = dir / "a.exr", folder = dir / "a.tangi", back = dir / "b.exr";
    const Surface s = tileable_surface();
    write_with_parts(file, s);
    write_tiles(*open_painting(file), folder);
    EXPECT_THAT(names_in(dir.path()), ElementsAre("a.exr", "a.tangi"));
    EXPECT_THAT(names_in(folder / "0"), ElementsAre("0_0.exr", "0_1.exr", "1_0.exr", "1_1.exr"));
    EXPECT_THAT(names_in(folder / "1"), ElementsAre("0_0.exr"));

    const Surface read = read_painting(folder);
    expect_same_surface(read, s);
    EXPECT_EQ(read.mm_per_pixel, s.mm_per_pixel);
    EXPECT_TRUE(read.scale_known);
    EXPECT_EQ(read.reflectance_model.diffuse_roughness, 0.25);
    EXPECT_EQ(read.photography.photos.size(), 1u);
    EXPECT_EQ(read.provenance, s.provenance);
    EXPECT_EQ(open_painting(folder)->header().dry_hash, hash_of(s));

    write_file(*open_painting(folder), back);
    expect_same_surface(read_painting(back), s);
    EXPECT_EQ(bytes_of(back), bytes_of(file));
}

// What `fit` and `mosaic` write: whichever form its name asks for, it is the same painting.
TEST(PaintingOutputs, AreOnePaintingInEitherForm) {
    const TestDir dir;
    const Surface s = tileable_surface();
    for (const char* name :
         {"a.exr", "a.tangi", "a.tangi"}) {  // the last one takes the place of the one before
        PaintingOutput output(dir / name);
        output.fill(s, {palette_part(6), part_in_corner(s.width(), s.height())});
        AtomicFile page(dir / "a.html");
        page.write("page");
        OutputSet set;
        output.add_to(set);
        set.add(page);
        set.commit();
    }
    EXPECT_THAT(names_in(dir.path()), ElementsAre("a.exr", "a.html", "a.tangi"));
    expect_same_surface(read_painting(dir / "a.tangi"), s);
    write_file(*open_painting(dir / "a.tangi"), dir / "b.exr");
    EXPECT_EQ(bytes_of(dir / "b.exr"), bytes_of(dir / "a.exr"));
}

TEST(PaintingOutputs, TakeTheTilesThatARunLeftBehind) {
    const TestDir dir;
    const fs::path target = dir / "a.tangi", tile = PaintingTilesWriter::partial_of(target) / "0" / "1_0.exr";
    const Surface s = tileable_surface();
    PaintingOutput(target).fill(s, {});  // stopped before its place
    const auto written = fs::last_write_time(tile);
    PaintingOutput again(target);
    again.fill(s, {});
    EXPECT_EQ(fs::last_write_time(tile), written);
    OutputSet set;
    again.add_to(set);
    set.commit();
    EXPECT_THAT(names_in(dir.path()), ElementsAre("a.tangi"));
    expect_same_surface(read_painting(target), s);
}

TEST(PaintingTiles, PartsComeThroughAndEmptyOnesTakeNoRoom) {
    const TestDir dir;
    const fs::path file = dir / "a.exr", folder = dir / "a.tangi";
    write_with_parts(file, tileable_surface());
    write_tiles(*open_painting(file), folder);
    EXPECT_EQ(painting_parts(folder / "0" / "1_1.exr").size(), 0u);
    const auto parts = painting_parts(folder);
    ASSERT_EQ(parts.size(), 3u);
    for (const PartInfo& part : painting_parts(file)) {
        const auto planes = [&](const fs::path& path) {
            Image<float> plane(part.width, part.height);
            read_painting_part(path, part, [&](int y0, int y1, std::span<const float* const> rows) {
                std::copy_n(rows[0], (y1 - y0) * part.width, plane.row(y0).data());
            });
            return plane;
        };
        EXPECT_TRUE(images_identical(planes(folder), planes(file))) << part.name;
    }
}

TEST(PaintingTiles, ColouredAndAnisotropicLobesComeThrough) {
    const TestDir dir;
    Surface s = tileable_surface(kPaintingTile + 1, 5);
    s.specular_colour = Image<Rgb>(s.width(), s.height(), Rgb(1, 0.5f, 0.25f));
    s.lobe_axes = Image<LobeAxes>(s.width(), s.height(), {0.25f, 0.5f});
    PaintingTilesWriter writer(dir / "a.tangi", s.width(), s.height(), "test");
    for (const int i : writer.missing()) {
        const PaintingTile tile = writer.grid().tile(i);
        writer.write(tile, cut(s, writer.grid().region(tile)));
    }
    writer.finish(header_of(s));
    expect_same_surface(read_painting(dir / "a.tangi"), s);
    EXPECT_FALSE(open_painting(dir / "a.tangi")->read({0, 0, 512, 3}, 1).lobe_axes.empty());
}

// By whoever reads: levels of a file are made when they are asked for, those of a folder lie there.
TEST(PaintingTiles, EveryReaderGivesTheSameRectanglesAtEveryLevel) {
    const TestDir dir;
    const fs::path file = dir / "a.exr", folder = dir / "a.tangi";
    const auto s = std::make_shared<Surface>(tileable_surface());
    write_painting(file, *s);
    const auto by_file = open_painting(file, 0), by_surface = reader_of(s);
    write_tiles(*by_file, folder);
    const auto by_tiles = open_painting(folder, 0);
    ASSERT_EQ(by_tiles->levels(), 2);
    const Surface half = halved(*s);
    for (const auto& [region, level] : {std::pair(Region{1000, 1010, 1050, 1030}, 0),
                                        {Region{0, 0, 1, 1}, 0},
                                        {Region{500, 3, 551, 530}, 1}}) {
        const Surface expected = cut(level == 0 ? *s : half, region);
        for (const auto& reader : {by_file, by_surface, by_tiles}) {
            const Surface found = reader->read(region, level);
            expect_same_surface(found, expected);
            EXPECT_TRUE(images_identical(reader->read_heights(region, level), expected.height_mm));
            EXPECT_DOUBLE_EQ(found.mm_per_pixel, s->mm_per_pixel * (1 << level));
        }
    }
    const Surface part = by_tiles->read({1000, 1010, 1050, 1030});
    EXPECT_EQ(part.point_mm(3, 4), s->point_mm(1003, 1014));
    const Surface coarse = by_tiles->read({500, 505, 501, 506}, 1);  // the middle of four pixels
    const Vec3 middle = (s->point_mm(1000, 1010) + s->point_mm(1001, 1011)) / 2.0f;
    EXPECT_NEAR(coarse.point_mm(0, 0).x, middle.x, 1e-5);
    EXPECT_NEAR(coarse.point_mm(0, 0).y, middle.y, 1e-5);
}

TEST(PaintingTiles, ALargeOneHasAnOverview) {
    const TestDir dir;
    write_painting(dir / "a.exr", tileable_surface());
    write_tiles(*open_painting(dir / "a.exr"), dir / "a.tangi");
    const auto overview = read_overview(dir / "a.tangi");
    ASSERT_TRUE(overview);
    EXPECT_EQ(overview->width, kWide);
    EXPECT_EQ(overview->surface.width(), (kWide + 1) / 2);
}

// What a test writes tile by tile.
class TornTiles : public testing::Test {
protected:
    void write_missing() {
        PaintingTilesWriter writer = tiles();
        for (const int i : writer.missing()) {
            const PaintingTile tile = writer.grid().tile(i);
            writer.write(tile, cut(surface_, writer.grid().region(tile)));
            ++written_;
        }
        writer.finish(header_of(surface_));
    }
    PaintingTilesWriter tiles() const { return {folder_, surface_.width(), surface_.height(), "torn tiles"}; }

    // What reading says; then running again makes only that tile, and the painting is whole.
    void expect_repaired_by_running_again(int tiles, const testing::Matcher<std::string>& said) {
        EXPECT_THAT(error_of([&] { read_painting(folder_); }), said);
        written_ = 0;
        write_missing();
        EXPECT_EQ(written_, tiles);
        expect_same_surface(read_painting(folder_), surface_);
        EXPECT_THAT(names_in(dir_.path()), ElementsAre("a.tangi"));
    }

    const TestDir dir_;
    const fs::path folder_ = dir_ / "a.tangi";
    const Surface surface_ = tileable_surface(kPaintingTile + 9, 40);
    int written_ = 0;
};

TEST_F(TornTiles, AMissingOneIsNamed) {
    write_missing();
    fs::remove(folder_ / "0" / "1_0.exr");
    expect_repaired_by_running_again(1,
                                     AllOf(HasSubstr("1_0.exr: this tile is missing"), HasSubstr("again")));
}

TEST_F(TornTiles, AFlippedBitIsNamed) {
    write_missing();
    flip_bit(folder_ / "0" / "0_0.exr", 2000);
    expect_repaired_by_running_again(1, AllOf(HasSubstr("0_0.exr"), HasSubstr("again")));
}

TEST_F(TornTiles, AHalfWrittenOneIsNamed) {
    write_missing();
    fs::resize_file(folder_ / "0" / "0_0.exr", fs::file_size(folder_ / "0" / "0_0.exr") / 2);
    expect_repaired_by_running_again(1,
                                     AllOf(HasSubstr("0_0.exr"), HasSubstr("damaged"), HasSubstr("again")));
}

TEST_F(TornTiles, AMissingDescriptionIsNamed) {
    write_missing();
    fs::remove(folder_ / "painting.json");
    EXPECT_THAT(error_of([&] { read_painting(folder_); }),
                AllOf(HasSubstr("painting.json is missing"), HasSubstr("again")));
}

TEST_F(TornTiles, AChangedDescriptionIsNamed) {
    write_missing();
    std::string words = read_text_file(folder_ / "painting.json");
    const std::string scale = "\"mm_per_pixel\": 0.05";
    words.replace(words.find(scale), scale.size(), "\"mm_per_pixel\": 0.06");
    write_bytes(folder_ / "painting.json", words);
    expect_repaired_by_running_again(0, AllOf(HasSubstr("painting.json"), HasSubstr("again")));
}

// Tiles of two paintings of one size: each is sound by itself.
TEST_F(TornTiles, ATileOfAnotherPaintingIsNamed) {
    write_missing();
    Surface other = surface_;
    other.height_mm(3, 3) += 1;
    PaintingTilesWriter writer(dir_ / "b.tangi", other.width(), other.height(), "another");
    for (const int i : writer.missing())
        writer.write(writer.grid().tile(i), cut(other, writer.grid().region(writer.grid().tile(i))));
    writer.finish(header_of(other));
    fs::copy_file(dir_ / "b.tangi" / "0" / "0_0.exr", folder_ / "0" / "0_0.exr",
                  fs::copy_options::overwrite_existing);
    fs::remove_all(dir_ / "b.tangi");
    expect_repaired_by_running_again(1, AllOf(HasSubstr("0_0.exr"), HasSubstr("is not the tile")));
}

TEST_F(TornTiles, AnUnfinishedOneSaysSoAndGoesOn) {
    PaintingTilesWriter writer = tiles();
    writer.write({0, 1, 0}, cut(surface_, writer.grid().region({0, 1, 0})));
    EXPECT_THAT(error_of([&] { read_painting(folder_); }),
                AllOf(HasSubstr("is not finished"), HasSubstr("again")));
    EXPECT_THAT(error_of([&] { writer.finish(header_of(surface_)); }),
                AllOf(HasSubstr("1 of 2 tiles"), HasSubstr("0_0.exr"), HasSubstr("same command")));
    write_missing();
    EXPECT_EQ(written_, 1);
    expect_same_surface(read_painting(folder_), surface_);
}

TEST_F(TornTiles, AFullDiskLeavesWhatThereWas) {
    write_missing();
    PaintingTilesWriter writer(folder_, surface_.width(), surface_.height(), "newer");
    {
        const FullDisk disk(2000);
        EXPECT_THAT(error_of([&] { writer.write({}, cut(surface_, writer.grid().region({}))); }),
                    AllOf(HasSubstr("0_0.exr"), HasSubstr("cannot be written")));
    }
    EXPECT_EQ(writer.state({}), TileState::missing);
    expect_same_surface(read_painting(folder_), surface_);
}

TEST_F(TornTiles, OneOfOtherWordsIsMadeAnewAndReplacesTheOlder) {
    write_missing();
    Surface newer = surface_;
    newer.height_mm(0, 0) = 7;
    PaintingTilesWriter writer(folder_, newer.width(), newer.height(), "newer");
    EXPECT_EQ(writer.missing().size(), 2u);
    for (const int i : writer.missing())
        writer.write(writer.grid().tile(i), cut(newer, writer.grid().region(writer.grid().tile(i))));
    expect_same_surface(read_painting(folder_), surface_);
    writer.finish(header_of(newer));
    expect_same_surface(read_painting(folder_), newer);
    EXPECT_THAT(names_in(dir_.path()), ElementsAre("a.tangi"));
}

TEST_F(TornTiles, AFolderOfOtherThingsIsNotTouched) {
    fs::create_directory(folder_);
    write_bytes(folder_ / "diary.txt", "mine");
    EXPECT_THAT(error_of([&] { tiles(); }), HasSubstr("is no painting of tiles"));
    EXPECT_EQ(bytes_of(folder_ / "diary.txt"), "mine");
}

constexpr const char* kFolderOfAnother = "TANGI_TEST_TILES";

// What the test below runs as a process of its own: threads do not survive a fork.
TEST_F(TornTiles, WhichAnotherProcessWrites) {
    const char* folder = std::getenv(kFolderOfAnother);
    if (!folder) GTEST_SKIP() << "is run by TwoProcessesWriteOne";
    PaintingTilesWriter writer(folder, surface_.width(), surface_.height(), "torn tiles");
    for (const int i : {0, 1})
        writer.write(writer.grid().tile(i), cut(surface_, writer.grid().region(writer.grid().tile(i))));
}

// One tile is written by both.
TEST_F(TornTiles, TwoProcessesWriteOne) {
    const pid_t child = ::fork();
    if (child == 0) {
        ::setenv(kFolderOfAnother, folder_.c_str(), 1);
        ::execl("/proc/self/exe", "another", "--gtest_filter=TornTiles.WhichAnotherProcessWrites", nullptr);
        ::_exit(1);
    }
    PaintingTilesWriter writer = tiles();
    writer.write({0, 1, 0}, cut(surface_, writer.grid().region({0, 1, 0})));
    int status = -1;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
    EXPECT_TRUE(writer.missing().empty());
    writer.finish(header_of(surface_));
    expect_same_surface(read_painting(folder_), surface_);
}

}  // namespace
}  // namespace tangi
