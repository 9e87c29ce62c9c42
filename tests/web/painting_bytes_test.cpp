// painting_bytes_test.cpp: a painting file in memory is read as read_painting() reads it from the disk, or
// refused.
#include "web/engine/painting_bytes.h"

#include <gmock/gmock.h>

#include "paint/canvas/canvas_hash.h"
#include "paint/files/canvas_file.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/viewer/viewer_support.h"
#include "web/engine/easel.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

std::string written(const Surface& surface) {
    const TestDir scratch;
    AtomicFile file(scratch / "painting.exr");
    write_painting(file, surface);
    return read_text_file(scratch / "painting.exr");
}

Canvas painting_of(const std::string& file, double memory_bytes = 0) {
    return painting_from_bytes(bytes_in(file), memory_bytes);
}

TEST(PaintingBytes, AreReadAsThePaintingsOfTheDesktop) {
    Surface plain = painted_surface(130, 77), rich = plain;
    rich.specular_colour = Image<Rgb>(130, 77, Rgb(1, 0.7f, 0.4f));
    rich.lobe_axes = Image<LobeAxes>(130, 77, LobeAxes{0.3f, 0.5f});
    for (const Surface& surface : {plain, rich}) {
        const Canvas canvas = painting_of(written(surface));
        const Surface& read = canvas.dry();
        EXPECT_EQ(hash_of(read), hash_of(surface));
        EXPECT_FLOAT_EQ(static_cast<float>(read.mm_per_pixel), static_cast<float>(surface.mm_per_pixel));
        EXPECT_EQ(read.scale_known, surface.scale_known);
        EXPECT_EQ(read.specular_colour.empty(), surface.specular_colour.empty());
    }
}

// The bytes of a file whose blocks are not packed further than `sorted` says.
std::string bytes_of(const PaintingToSave& painting) {
    const std::string head = painting.head();
    std::string places, blocks;
    const auto put = [](std::string& to, auto value) {
        to.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (std::size_t i = 0; i < painting.blocks(); ++i) {
        const PaintingToSave::Block block = painting.block(i, false);
        put(places, std::uint64_t{head.size() + 8 * painting.blocks() + blocks.size()});
        put(blocks, std::int32_t{block.part});
        put(blocks, std::int32_t{block.y});
        put(blocks, static_cast<std::int32_t>(block.bytes.size()));
        blocks += block.bytes;
    }
    return head + places + blocks;
}

// With paint, wet and dry, on a new support and on a painting that was painted on before: as the desk reads
// it, and as it is read here.
TEST(PaintingBytes, OfPaintAreThoseOfTheCanvas) {
    const TestDir scratch;
    const auto paint = [](Easel& easel, const char* name) {
        easel.apply(
            fmt::format(R"({{"event":"stroke","brush":{{"preset":"flat"}},"paint":{{"{}":1}}}})", name));
        for (const int x : {-4, 4})
            easel.apply(fmt::format(R"({{"event":"point","t":{},"x":{},"y":1}})", x + 4, x));
        easel.apply(R"({"event":"end"})");
    };
    const auto read_hash = [&](const std::string& bytes) {
        write_text_file(scratch / "painting.exr", bytes);
        const Canvas canvas = read_canvas(scratch / "painting.exr");
        return hash_of(canvas, hash_of(canvas.dry()));
    };
    Easel easel(painted_surface(130, 77));
    paint(easel, "Titanium White");
    easel.apply(R"({"event":"dry","layer":"first"})");
    paint(easel, "Bone Black");
    const std::string saved = bytes_of({easel.session().canvas(), {}});
    EXPECT_EQ(read_hash(saved), easel.hash());
    Easel next(painting_of(saved));
    EXPECT_EQ(next.hash(), easel.hash());
    EXPECT_EQ(next.look_hash(), easel.look_hash());
    paint(next, "Diarylide Yellow");
    EXPECT_EQ(read_hash(bytes_of({next.session().canvas(), bytes_in(saved)})), next.hash());
    EXPECT_NE(next.hash(), easel.hash());
}

// Files of hundreds of megabytes are opened on devices that have not the memory for them.
TEST(PaintingBytes, AreReadAPartAtATime) {
    const std::string file = written(painted_surface(130, 600));
    std::size_t most = 0, all = 0;
    const ByteSource source{file.size(), [&](std::uint64_t at, std::span<char> to) {
                                ASSERT_LE(at + to.size(), file.size());
                                file.copy(to.data(), to.size(), at);
                                most = std::max(most, to.size());
                                all += to.size();
                            }};
    EXPECT_EQ(painting_from_bytes(source).height(), 600);
    EXPECT_LT(most, file.size() / 5);
    EXPECT_LT(all, file.size() + (std::size_t(1) << 17)) << "nothing is read twice but the head";
    const ByteSource broken{file.size(), [&](std::uint64_t at, std::span<char> to) {
                                if (at + to.size() > file.size() / 2) fail("the device is gone");
                                file.copy(to.data(), to.size(), at);
                            }};
    EXPECT_THROW(painting_from_bytes(broken), Error);
}

TEST(PaintingBytes, OfMorePixelsThanMemoryHoldsAreRefused) {
    const std::string file = written(painted_surface(60, 40));
    EXPECT_EQ(painting_of(file, 60 * 40 * kBytesOfPixel + 1).width(), 60);
    EXPECT_THROW(painting_of(file, 60 * 40 * kBytesOfPixel - 1), Error);
    EXPECT_THROW(make_ground({{"width_mm", 40}, {"height_mm", 30}, {"pixel_mm", 1}, {"memory_bytes", 1e4}}),
                 Error);
}

TEST(PaintingBytes, ThatAreDamagedAreRefused) {
    const std::string whole = written(painted_surface(60, 40));
    EXPECT_THROW(painting_of("no painting at all"), Error);
    for (std::size_t part = 1; part < 12; ++part)
        EXPECT_THROW(painting_of(whole.substr(0, whole.size() * part / 12)), Error);
    int refused = 0;
    for (std::size_t at = whole.size() / 2; at < whole.size(); at += 997) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
        try {
            painting_of(damaged);
        } catch (const Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0) << "maps that are not those that were saved are noticed";
}

}  // namespace
}  // namespace tangi
