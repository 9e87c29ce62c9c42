// large_pictures_test.cpp: pictures that are sound, small on disk and too large for the memory that there
// is, wherever the program takes one.
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

constexpr int kLargeSide = 7000;
constexpr rlim_t kLimit = rlim_t{700} << 20;  // of which the program itself takes 300 MB

// 147 MB unpacked, 588 MB as the program holds it; some 70 kB on disk.
void write_large(const fs::path& path) {
    write_map(path, Image<float>(kLargeSide, kLargeSide, 0.5f), {.bits = 8});
}

void expect_refused(const std::vector<std::string>& arguments, const fs::path& file) {
    const Finished refused = tangipaint(arguments, {.memory = kLimit});
    EXPECT_TRUE(ended(refused, 1, {file.string() + ": ", "7000 x 7000 pixels takes", "GB are left"}));
    EXPECT_LT(refused.peak_kib, 400'000) << arguments.front();
}

TEST(CliLargePictures, AreRefusedBeforeTheyAreUnpacked) {
    const TestDir dir;
    fs::create_directories(dir / "maps");
    const fs::path map = dir / "maps" / "normals.png";
    write_large(map);
    EXPECT_LT(fs::file_size(map), 500'000u);
    fs::create_hard_link(map, dir / "maps" / "kd.png");
    expect_refused({"import", (dir / "maps").string(), "--out", (dir / "a.exr").string()},
                   dir / "maps" / "kd.png");
    fs::create_directories(dir / "photos");
    std::string lights = "8\n";
    for (int i = 0; i < 8; ++i) {
        const std::string name = fmt::format("{}.png", i);
        fs::create_hard_link(map, dir / "photos" / name);
        lights += fmt::format("{} {} {} 1\n", name, std::cos(i), std::sin(i));
    }
    write_bytes(dir / "photos" / "lights.lp", lights);
    expect_refused({"fit", (dir / "photos").string(), "--out", (dir / "b.exr").string()}, dir / "photos");
    const TinyStack stack;  // of which it cannot be the mask
    const Finished mask = tangipaint(
        {"fit", stack.path(), "--mask", map.string(), "--out", stack.out("a.exr")}, {.memory = kLimit});
    EXPECT_TRUE(ended(mask, 1, {map.string() + ": the mask is 7000 x 7000, the photographs are"}));
}

}  // namespace
}  // namespace tangi
