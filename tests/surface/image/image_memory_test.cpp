// image_memory_test.cpp: images that are on disk are images all the same, and do not fill the memory.
#include "surface/image/image_memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <mutex>
#include <thread>

#include "surface/base/parallel.h"
#include "surface/image/image.h"

namespace tangi {
namespace {

struct LimitedImages {
    explicit LimitedImages(std::size_t bytes) { limit_image_memory(bytes); }
    ~LimitedImages() { limit_image_memory(kNoImageLimit); }
};

double megabytes_of_files() {
    std::ifstream file("/proc/self/statm");
    double all = 0, resident = 0, shared = 0;
    file >> all >> resident >> shared;
    return shared * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

// 32 MB each: beyond what counts as large.
Image<float> numbered(int first) {
    Image<float> image(4096, 2048);
    for (std::size_t i = 0; i < image.size(); ++i)
        image.pixels()[i] = static_cast<float>(first) + static_cast<float>(i);
    return image;
}

TEST(ImageMemory, KeepsPixelsThatAreOnDisk) {
    const LimitedImages limited(1 << 20);
    EXPECT_TRUE(images_go_to_disk(32 << 20));
    const Image<float> image = numbered(3);
    Image<float> copy = image;
    const Image<float> moved = std::move(copy);
    EXPECT_EQ(moved(5, 7), image(5, 7));
    EXPECT_EQ(moved(4095, 2047), 3 + 4096.0f * 2048 - 1);
}

TEST(ImageMemory, HoldsAllOfThemWithoutALimit) { EXPECT_FALSE(images_go_to_disk(1e15)); }

TEST(ImageMemory, HoldsFewPagesOfManyImages) {
    const LimitedImages limited(64 << 20);
    const double before = megabytes_of_files();
    std::vector<Image<float>> images;
    double most = 0;
    for (int i = 0; i < 12; ++i) {
        images.push_back(numbered(i));
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        most = std::max(most, megabytes_of_files() - before);
    }
    EXPECT_LT(most, 12 * 32 / 2);
    for (int i = 0; i < 12; ++i)
        EXPECT_EQ(images[static_cast<std::size_t>(i)](11, 0), static_cast<float>(i) + 11);
}

TEST(ImageMemory, LoopsHoldFewPagesOfManyImages) {
    const double before = megabytes_of_files(), more = 64;  // half of the limit is for pages of files
    const LimitedImages limited(static_cast<std::size_t>(2 * (before + more)) << 20);
    std::vector<Image<float>> held, images;
    while (!images_go_to_disk(32 << 20)) held.push_back(numbered(0));
    for (int i = 0; i < 12; ++i) images.push_back(numbered(i));
    std::mutex mutex;
    double most = 0;
    parallel_for(0, images[0].height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (Image<float>& image : images)
                for (int x = 0; x < image.width(); ++x) image(x, y) += 1;
        const std::lock_guard lock(mutex);
        most = std::max(most, megabytes_of_files() - before);
    });
    EXPECT_LT(most, more + 32);
    EXPECT_EQ(images[7](5, 2047), 7 + 4096.0f * 2047 + 5 + 1);
}

}  // namespace
}  // namespace tangi
