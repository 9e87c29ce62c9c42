// exr_parallel_reader_test.cpp: blocks of rows unpacked by us hold what OpenEXR reads from them, bit for bit.
#include "surface/painting_file/exr_parallel_reader.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kOddWidth = 37, kOddHeight = 61;  // no whole number of blocks, nor of vectors

// Rows that are noise cannot be packed, even ones can; both kinds of blocks.
void write_a_painting(const std::filesystem::path& path) {
    Random random(3);
    Surface s(kOddWidth, kOddHeight);
    for (int y = 0; y < kOddHeight; ++y)
        for (int x = 0; x < kOddWidth; ++x) {
            s.height_mm(x, y) = y < 20 ? static_cast<float>(random.real(-1, 1)) : 0.5f;
            s.diffuse(x, y) = {0.001f * static_cast<float>(x), 0.25f, static_cast<float>(random.real(0, 1))};
            s.confidence(x, y) = 1;
        }
    write_painting(path, s);
}

std::vector<float> by_openexr(const std::filesystem::path& path, const std::string& channel) {
    PartInfo info;
    info.name = "dry";
    info.width = kOddWidth;
    info.height = kOddHeight;
    info.channels = {channel};
    std::vector<float> values;
    read_painting_part(path, info, [&](int y0, int y1, std::span<const float* const> planes) {
        values.insert(values.end(), planes[0], planes[0] + (y1 - y0) * kOddWidth);
    });
    return values;
}

TEST(ScanBlocks, AreWhatOpenExrReads) {
    const TestDir dir;
    write_a_painting(dir / "a.exr");
    std::vector<float> height(kOddWidth * kOddHeight), colour(3 * kOddWidth * kOddHeight);
    const std::vector<FloatPlane> planes = {
        {"height", height.data(), 1}, {"diffuse.R", colour.data(), 3}, {"diffuse.B", colour.data() + 2, 3}};
    std::vector<std::atomic<int>> seen(kOddHeight);
    ASSERT_TRUE(read_scan_blocks(dir / "a.exr", "dry", planes, [&](int y0, int y1) {
        for (int y = y0; y < y1; ++y) ++seen[static_cast<std::size_t>(y)];
    }));
    for (const auto& times : seen) EXPECT_EQ(times, 1);
    EXPECT_EQ(height, by_openexr(dir / "a.exr", "height"));
    const auto red = by_openexr(dir / "a.exr", "diffuse.R"), blue = by_openexr(dir / "a.exr", "diffuse.B");
    for (std::size_t i = 0; i < red.size(); ++i) {
        ASSERT_EQ(colour[3 * i], red[i]);
        ASSERT_EQ(colour[3 * i + 1], 0) << "not asked for";
        ASSERT_EQ(colour[3 * i + 2], blue[i]);
    }
}

TEST(ScanBlocks, LeavesWhatIsPackedOtherwise) {
    const TestDir dir;
    for (const char* compression : {"piz", "none", "zips"}) {
        OIIO::ImageSpec spec(8, 6, 1, OIIO::TypeDesc::FLOAT);
        spec.channelnames = {"height"};
        spec.attribute("compression", compression);
        spec.attribute("oiio:subimagename", "dry");
        const auto output = OIIO::ImageOutput::create("a.exr");
        ASSERT_TRUE(output->open((dir / "a.exr").string(), 1, &spec));
        const std::vector<float> written(48, 0.25f);
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, written.data()));
        output->close();
        std::vector<float> values(48);
        const std::vector<FloatPlane> planes = {{"height", values.data(), 1}};
        const bool ours = std::string(compression) == "zips";
        EXPECT_EQ(read_scan_blocks(dir / "a.exr", "dry", planes, [](int, int) {}), ours) << compression;
        EXPECT_EQ(values, ours ? written : std::vector<float>(48)) << compression;
        const std::vector<FloatPlane> missing = {{"width", values.data(), 1}};
        EXPECT_FALSE(read_scan_blocks(dir / "a.exr", "dry", missing, [](int, int) {}));
    }
}

TEST(ScanBlocks, DamageIsAnError) {
    const TestDir dir;
    write_a_painting(dir / "a.exr");
    std::string bytes = bytes_of(dir / "a.exr");
    for (std::size_t i = bytes.size() - 60; i < bytes.size() - 20; ++i)
        bytes[i] = static_cast<char>(~bytes[i]);
    write_bytes(dir / "bad.exr", bytes);
    std::vector<float> values(kOddWidth * kOddHeight);
    const std::vector<FloatPlane> planes = {{"height", values.data(), 1}};
    EXPECT_THROW(read_scan_blocks(dir / "bad.exr", "dry", planes, [](int, int) {}), std::runtime_error);
    EXPECT_THAT(error_of([&] { read_painting(dir / "bad.exr"); }),
                testing::HasSubstr("bad.exr: is damaged: its rows 48 to 60 cannot be unpacked; copy"));
}

}  // namespace
}  // namespace tangi
