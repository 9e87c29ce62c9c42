#include "capture/registration/sharpening.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "capture/stack/survey.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr int kSide = 8, kStep = 4;  // [pixels] of blocks: a wave of 8 pixels fits, few shadows are as near
constexpr int kArea = kSide * kSide;
constexpr int kMostPhotos = 24, kFewestMixed = 8, kFewestBlocks = 20, kMostBlocks = 4000;
constexpr int kGrid = 8;                      // [pixels] of JPEG
constexpr double kQuietest = 0.1;             // [1] of the blocks
constexpr float kCutOff = 0.003f;             // [1] stored: below, noise is cut off at black
constexpr double kSuspected = 3, kFound = 4;  // [standard errors]
constexpr double kGridShows = 5;              // [standard deviations] of steps between pixels, by chance
// [1] Times the variance of JPEG's rounding, at most: noise of more than that is the sensor's.
constexpr double kAboveRounding = 4;

using Block = Eigen::Matrix<double, Eigen::Dynamic, kArea, Eigen::RowMajor>;

// Power of a block's noise: [variance as stored] and, over that, in low and middle frequencies.
struct Power {
    double variance = 0, low = 0, middle = 0;
};

// What the noise of a block is like.
struct NoiseBlock {
    Power measured, white;                        // `white`: of noise that is, in photographs like these
    std::array<double, kGrid> steps{}, counts{};  // squares of steps into a column of this phase, as variance
};

// [1] Hann's window, times the waves of each frequency that is looked at.
struct Waves {
    Eigen::Matrix<double, kArea, Eigen::Dynamic> low, middle;

    Waves() {
        std::vector<std::array<double, 2>> lows, middles;
        for (int v = -kSide / 2; v < kSide / 2; ++v)
            for (int u = 0; u <= kSide / 2; ++u) {
                const double f = std::hypot(u, v) / kSide;
                if (f > 0.08 && f < 0.2) lows.push_back({u * 1.0, v * 1.0});
                if (f >= 0.27 && f < 0.45) middles.push_back({u * 1.0, v * 1.0});
            }
        low = of(lows);
        middle = of(middles);
    }
    // Power of a picture in these, mean of the waves.
    static double power(const Eigen::RowVectorXd& waves) {
        return waves.squaredNorm() / static_cast<double>(waves.size());
    }

private:
    static Eigen::Matrix<double, kArea, Eigen::Dynamic> of(const std::vector<std::array<double, 2>>& places) {
        Eigen::Matrix<double, kArea, Eigen::Dynamic> waves(kArea, 2 * static_cast<long>(places.size()));
        const auto hann = [](int i) {
            return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 1) / (kSide + 1));
        };
        for (long k = 0; k < static_cast<long>(places.size()); ++k)
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x) {
                    const auto& [u, v] = places[static_cast<std::size_t>(k)];
                    const double phase = 2 * std::numbers::pi * (u * x + v * y) / kSide;
                    waves(y * kSide + x, 2 * k) = hann(x) * hann(y) * std::cos(phase);
                    waves(y * kSide + x, 2 * k + 1) = hann(x) * hann(y) * std::sin(phase);
                }
        return waves;
    }
};

// The photographs of a block that are neither dark nor clipped, less their means.
Block usable_block(const AlignmentWindow& window, const std::vector<std::size_t>& photos, int x0, int y0) {
    Block block(static_cast<long>(photos.size()), kArea);
    long rows = 0;
    for (const std::size_t i : photos) {
        bool usable = true;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float value = window.pictures[i](x0 + x, y0 + y);
                usable = usable && value > kCutOff && value < kClipped;
                block(rows, y * kSide + x) = static_cast<double>(value);
            }
        if (!usable) continue;
        block.row(rows).array() -= block.row(rows).mean();
        ++rows;
    }
    block.conservativeResize(rows, kArea);
    return block;
}

// [][component] The principal components of a block, weakest first.
Eigen::MatrixXd components_of(const Block& block) {
    return symmetric_eigen(block * block.transpose() / kArea).vectors;
}

Block weak_part(const Eigen::MatrixXd& components, const Block& block) {
    return components.leftCols(block.rows() / 2).transpose() * block;
}

Power power_of(const Block& noise, const Waves& waves) {
    Power power;
    power.variance = noise.squaredNorm() / static_cast<double>(noise.size());
    if (!(power.variance > 0)) return power;
    const double all = static_cast<double>(noise.rows()) * power.variance;
    for (long k = 0; k < noise.rows(); ++k) {
        power.low += Waves::power(noise.row(k) * waves.low) / all;
        power.middle += Waves::power(noise.row(k) * waves.middle) / all;
    }
    return power;
}

// Independent, of variance 1; close to normal, and the same everywhere.
Block white_noise(long rows, std::mt19937_64& random) {
    constexpr double kParts = 4;  // of 16 bits, each uniform
    Block noise(rows, kArea);
    for (long k = 0; k < noise.size(); ++k) {
        double sum = 0;
        for (std::uint64_t bits = random(), i = 0; i < 4; ++i, bits >>= 16)
            sum += static_cast<double>(bits & 0xFFFF) / 0xFFFF - 0.5;
        noise.data()[k] = sum / std::sqrt(kParts / 12);
    }
    for (long k = 0; k < rows; ++k) noise.row(k).array() -= noise.row(k).mean();
    return noise;
}

// Of the strong components and white noise that leaves as much in the weak ones.
Power power_of_white(const Eigen::MatrixXd& components, const Block& block, double variance,
                     const Waves& waves, std::mt19937_64& random) {
    const auto strong = components.rightCols(block.rows() - block.rows() / 2);
    const Block picture = strong * (strong.transpose() * block);
    double sigma = std::sqrt(variance);
    Power power;
    for (int round = 0; round < 2; ++round) {
        if (round > 0 && power.variance > 0) sigma *= std::sqrt(variance / power.variance);
        const Block made = picture + sigma * white_noise(block.rows(), random);
        power = power_of(weak_part(components_of(made), made), waves);
    }
    return power;
}

NoiseBlock noise_of(const Block& block, int x0, const Waves& waves, std::mt19937_64& random) {
    const Eigen::MatrixXd components = components_of(block);
    const Block noise = weak_part(components, block);
    NoiseBlock result;
    result.measured = power_of(noise, waves);
    if (!(result.measured.variance > 0)) return result;
    result.white = power_of_white(components, block, result.measured.variance, waves, random);
    for (long k = 0; k < noise.rows(); ++k)
        for (int y = 0; y < kSide; ++y)
            for (int x = 1; x < kSide; ++x) {
                const auto phase = static_cast<std::size_t>((x0 + x) % kGrid);
                const double step = noise(k, y * kSide + x) - noise(k, y * kSide + x - 1);
                result.steps[phase] += step * step / result.measured.variance;
                result.counts[phase] += 1;
            }
    return result;
}

struct BlockPlace {
    const AlignmentWindow* window;
    int x, y;
};

std::vector<NoiseBlock> noise_blocks(const PictureCollector& collected) {
    std::vector<BlockPlace> places;
    for (const AlignmentWindow* window : collected.in_full())
        for (int y = 0; y + kSide <= window->pictures[0].height(); y += kStep)
            for (int x = 0; x + kSide <= window->pictures[0].width(); x += kStep)
                places.push_back({window, x, y});
    const std::size_t step = places.size() / kMostBlocks + 1;
    std::vector<std::size_t> photos;
    const auto all = static_cast<std::size_t>(collected.photos());
    const std::size_t wanted = std::min<std::size_t>(all, kMostPhotos);
    for (std::size_t i = 0; i < wanted; ++i) photos.push_back(i * all / wanted);
    std::vector<NoiseBlock> blocks(places.size() / step + 1);
    const Waves waves;
    parallel_for(0, static_cast<int>(blocks.size()), 16, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
            if (k * step >= places.size()) continue;
            const BlockPlace& place = places[k * step];
            const Block block = usable_block(*place.window, photos, place.x, place.y);
            const int column = static_cast<int>(place.window->origin.x - collected.grid().corner.x) + place.x;
            if (block.rows() >= kFewestMixed) {
                std::mt19937_64 random(k);
                blocks[k] = noise_of(block, column, waves, random);
            }
        }
    });
    std::erase_if(blocks, [](const NoiseBlock& block) {
        return !(block.measured.variance > 0 && block.white.variance > 0);
    });
    return blocks;
}

// Whether steps into columns of one phase are larger than into others that are as far from the mosaic of a
// sensor, which has a grid of 2 pixels.
bool grid_shows(const std::vector<NoiseBlock>& blocks) {
    std::array<double, kGrid> steps{}, counts{};
    for (const NoiseBlock& block : blocks)
        for (std::size_t i = 0; i < kGrid; ++i) {
            steps[i] += block.steps[i];
            counts[i] += block.counts[i];
        }
    for (std::size_t i = 0; i < kGrid; ++i) {
        double sum = 0, count = 0;
        for (std::size_t k = i % 2; k < kGrid; k += 2) {
            sum += steps[k];
            count += counts[k];
        }
        if (!(counts[i] > 0) || !(sum > 0)) return false;
        // A square of normal noise has twice the square of its mean as variance; blocks overlap by half.
        const double expected = sum / count, independent = counts[i] * kStep * kStep / kArea;
        if (std::abs(steps[i] / counts[i] / expected - 1) > kGridShows * std::sqrt(2 / independent))
            return true;
    }
    return false;
}

// A ratio of means over blocks, with its standard error by their scatter; 0 where there is nothing.
struct MiddleOverLow {
    double ratio = 0, error = 0;

    MiddleOverLow(const std::vector<NoiseBlock>& blocks, Power NoiseBlock::*of) {
        double low = 0, middle = 0, squares = 0;
        for (const NoiseBlock& block : blocks) {
            low += (block.*of).low;
            middle += (block.*of).middle;
        }
        if (!(low > 0)) return;
        ratio = middle / low;
        for (const NoiseBlock& block : blocks)
            squares += std::pow((block.*of).middle - ratio * (block.*of).low, 2);
        error = std::sqrt(squares) / low;
    }
};

}  // namespace

static bool exceeds_white(const Sharpening& s, double errors) {
    return !s.compressed && s.blocks >= kFewestBlocks && s.ratio - errors * s.error > 1;
}

bool Sharpening::suspected() const { return exceeds_white(*this, kSuspected); }

bool Sharpening::found() const { return exceeds_white(*this, kFound); }

Sharpening find_sharpening(const PictureCollector& collected, double rounding) {
    if (collected.photos() < kFewestMixed) return {};
    std::vector<NoiseBlock> blocks = noise_blocks(collected);
    const auto quiet = std::min(
        blocks.size(),
        std::max<std::size_t>(kFewestBlocks,
                              static_cast<std::size_t>(kQuietest * static_cast<double>(blocks.size()))));
    std::stable_sort(blocks.begin(), blocks.end(), [](const NoiseBlock& a, const NoiseBlock& b) {
        return a.measured.variance < b.measured.variance;
    });
    blocks.resize(quiet);
    Sharpening result;
    result.blocks = static_cast<int>(quiet);
    const MiddleOverLow measured(blocks, &NoiseBlock::measured), white(blocks, &NoiseBlock::white);
    if (!(measured.ratio > 0) || !(white.ratio > 0)) return result;
    result.ratio = measured.ratio / white.ratio;
    result.error = result.ratio * std::hypot(measured.error / measured.ratio, white.error / white.ratio);
    result.compressed =
        grid_shows(blocks) || blocks[quiet / 2].measured.variance < kAboveRounding * rounding * rounding;
    return result;
}

std::string says_sharpened(const Sharpening& sharpening) {
    if (!sharpening.suspected()) return {};
    return fmt::format(
        "the photographs {}: their noise has {:.2f} ± {:.2f} times the power in waves of 3 pixels that it "
        "has in waves of 8, and no lens or sensor does that. Fine relief comes out too steep by as much; "
        "export them without sharpening (and without clarity or texture)",
        sharpening.found() ? "are sharpened" : "seem to be sharpened", sharpening.ratio, sharpening.error);
}

nlohmann::json to_json(const Sharpening& sharpening) {
    return {{"found", sharpening.found()},           {"suspected", sharpening.suspected()},
            {"noise_power_ratio", sharpening.ratio}, {"error", sharpening.error},
            {"blocks", sharpening.blocks},           {"compressed", sharpening.compressed}};
}

}  // namespace tangi
