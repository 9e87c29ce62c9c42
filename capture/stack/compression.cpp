#include "capture/stack/compression.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

namespace tangi {

namespace {

constexpr int kFineQuality = 95;
constexpr std::size_t kCells = 64;        // of a table
constexpr double kSumOfQuality50 = 3690;  // of table K.1

// [bytes of a segment] The sum of the table number 0, if it is in there.
std::optional<double> sum_of_brightness_table(const std::vector<unsigned char>& tables) {
    for (std::size_t at = 0; at < tables.size();) {
        const bool is_wide = tables[at] >> 4 != 0;
        const std::size_t bytes = kCells * (is_wide ? 2 : 1);
        if (at + 1 + bytes > tables.size()) return {};
        if ((tables[at] & 15) == 0) {
            double sum = 0;
            for (std::size_t i = 0; i < kCells; ++i)
                sum += is_wide ? 256 * tables[at + 1 + 2 * i] + tables[at + 2 + 2 * i] : tables[at + 1 + i];
            return sum;
        }
        at += 1 + bytes;
    }
    return {};
}

}  // namespace

std::optional<int> jpeg_quality(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    unsigned char head[4] = {};
    if (!stream.read(reinterpret_cast<char*>(head), 2) || head[0] != 0xFF || head[1] != 0xD8) return {};
    constexpr unsigned char kTables = 0xDB, kScan = 0xDA;
    while (stream.read(reinterpret_cast<char*>(head), 4) && head[0] == 0xFF && head[1] != kScan) {
        const int length = 256 * head[2] + head[3] - 2;
        if (length < 0) return {};
        std::vector<unsigned char> segment(static_cast<std::size_t>(length));
        if (!stream.read(reinterpret_cast<char*>(segment.data()), length)) return {};
        if (head[1] != kTables) continue;
        if (const auto sum = sum_of_brightness_table(segment)) {
            const double percent = 100 * *sum / kSumOfQuality50;
            const double quality = percent <= 100 ? (200 - percent) / 2 : 5000 / percent;
            return static_cast<int>(std::clamp(std::lround(quality), 1L, 100L));
        }
    }
    return {};
}

static std::optional<int> least_quality(const Stack& stack) {
    std::optional<int> least;
    for (const StackPhoto& photo : stack.photos)
        if (const auto quality = jpeg_quality(photo.path); quality && (!least || *quality < *least))
            least = quality;
    return least;
}

double rounding_of_jpeg(const Stack& stack) {
    const std::optional<int> least = least_quality(stack);
    if (!least) return 0;
    const double percent = *least >= 50 ? 200 - 2 * *least : 5000.0 / *least;
    const double step = std::max(kSumOfQuality50 * percent / 100 / static_cast<double>(kCells), 1.0);
    return step / std::sqrt(12) / 255;
}

void warn_of_compression(Stack& stack) {
    const std::optional<int> least = least_quality(stack);
    if (!least || *least >= kFineQuality) return;
    stack.warnings.push_back(fmt::format(
        "{}: the photographs are JPEG of quality {}: what compression does to relief of some pixels is "
        "in no stated error; TIFF, raw or JPEG of quality 95 and more show more",
        stack.folder.string(), *least));
}

}  // namespace tangi
