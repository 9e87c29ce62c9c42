// memory_budget_test.cpp: pictures that are sound, small on disk and larger than the memory are
// refused before memory for them is asked for.
#include "surface/image/memory_budget.h"

#include <gmock/gmock.h>

#include <limits>

#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_header.h"
#include "tests/support/capture/picture_metadata.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

void write_below(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    write_bytes(path, text);
}

// A system with 8 GB of which 3 are free, and 1 GB of swap.
void write_meminfo(const fs::path& root) {
    write_below(root / "proc/meminfo",
                "MemTotal:        8000000 kB\nMemFree:          100000 kB\nMemAvailable:    3000000 kB\n"
                "SwapTotal:       2000000 kB\nSwapFree:        1000000 kB\n");
}

TEST(MemoryBudget, IsWhatTheSystemHas) {
    const TestDir dir;
    write_meminfo(dir.path());
    EXPECT_DOUBLE_EQ(memory_left(dir.path()), 4e6 * 1024);
}

TEST(MemoryBudget, IsTheLeastOfAllControlGroups) {
    const TestDir dir;
    write_meminfo(dir.path());
    const fs::path groups = dir / "sys/fs/cgroup";
    write_below(dir / "proc/self/cgroup", "0::/outer/inner\n");
    write_below(groups / "outer/memory.max", "1000000000\n");
    write_below(groups / "outer/memory.current", "600000000\n");
    write_below(groups / "outer/memory.stat", "anon 1\ninactive_file 50000000\n");
    write_below(groups / "outer/inner/memory.max", "max\n");
    write_below(groups / "outer/inner/memory.current", "600000000\n");
    EXPECT_DOUBLE_EQ(memory_left(dir.path()), 450e6);
    // Of the first version; a container sees its own as the root.
    write_below(dir / "proc/self/cgroup", "5:cpu:/\n4:memory,hugetlb:/docker/4711\n");
    write_below(groups / "memory/memory.limit_in_bytes", "2000000000\n");
    write_below(groups / "memory/memory.usage_in_bytes", "1800000000\n");
    write_below(groups / "memory/memory.stat", "total_inactive_file 100000000\n");
    EXPECT_DOUBLE_EQ(memory_left(dir.path()), 300e6);
    write_below(groups / "memory/memory.usage_in_bytes", "2200000000\n");
    EXPECT_EQ(memory_left(dir.path()), 0);
}

TEST(MemoryBudget, IsEndlessWhereNothingIsKnown) {
    const TestDir dir;
    EXPECT_EQ(memory_left(dir.path()), std::numeric_limits<double>::infinity());
}

TEST(MemoryBudget, NamesTheFileAndWhatItTakes) {
    EXPECT_NO_THROW(require_memory("a.png", 1e6, "its picture"));
    EXPECT_THAT(error_of([] { require_memory("b/a.png", 1e18, "its picture of 9 x 9 pixels"); }),
                AllOf(HasSubstr("b/a.png: its picture of 9 x 9 pixels takes 1000000000.0 GB of memory, and "),
                      HasSubstr("are left; reduce it, or cut it in parts"), HasSubstr("ulimit -v")));
}

// What a library holds at once: the whole picture of interlaced files and of scans one behind the other.
TEST(MemoryBudget, OfWhatIsUnpackedAtOnceIsToldByTheHeader) {
    const TestDir dir;
    const auto held = [&](const std::string& name, const std::string& bytes, PictureFormat format) {
        write_bytes(dir / name, bytes);
        return picture_header(FileBytes(dir / name), format).held;
    };
    write_picture_8bit(dir / "a.png", Image<Rgb>(300, 200, Rgb(0.5f)));
    std::string png = bytes_of(dir / "a.png");
    EXPECT_EQ(held("a.png", png, PictureFormat::png), 0);
    png[28] = '\1';  // interlaced
    EXPECT_EQ(held("b.png", png, PictureFormat::png), 300 * 200 * 3);
    EXPECT_EQ(held("a.tif", tiff_with(300, 200, "", ""), PictureFormat::tiff), 300 * 200 * 3);
}

// Sixty files that are open at once need what all of them unpack.
TEST(MemoryBudget, IsClaimedByAllThatIsOpen) {
    const double most = std::min(memory_left(), 1e15) * 0.6;
    MemoryClaim first("a.jpg", most, "what must be unpacked of it at once");
    EXPECT_THAT(
        error_of([&] { MemoryClaim("b.jpg", most, "what must be unpacked of it at once"); }),
        AllOf(HasSubstr(
                  "b.jpg: what must be unpacked of it at once, and of the other files that are open, takes"),
              HasSubstr("GB are left")));
    first.give_back();
    MemoryClaim second("b.jpg", most, "what"), moved = std::move(second);
    EXPECT_NE(error_of([&] { MemoryClaim("c.jpg", most, "what"); }), "");
    moved = MemoryClaim();
    MemoryClaim third("c.jpg", most, "what");
}

}  // namespace
}  // namespace tangi
