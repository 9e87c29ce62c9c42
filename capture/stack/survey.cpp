#include "capture/stack/survey.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "capture/stack/duplicate_photos.h"
#include "capture/stack/stack_calibration.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

constexpr std::size_t kSurveyBandBytes = 64u << 20;
constexpr double kBlackLevel = 0.02;          // [1] of full scale
constexpr double kDarkest16 = 128.0 / 65535;  // [1] that lenses with their caps on show, in raw files

// Pixels of one axis by how far they are from its middle: 0 is the nearest on either side.
struct Axis {
    int length;

    int from_middle() const { return (length + 1) / 2; }
    int at(int m, bool mirrored) const {
        const int pixel = length / 2 + m;
        return mirrored ? length - 1 - pixel : pixel;
    }
    bool is_own_mirror(int m) const { return length % 2 == 1 && m == 0; }
};

std::uint32_t scattered(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7FEB352Du;
    x = (x ^ (x >> 15)) * 0x846CA68Bu;
    return x ^ (x >> 16);
}

// Where a cell comes in an order in which every beginning is spread evenly (the ordered dither of Bayer
// 1973).
std::uint32_t dithered(std::uint32_t x, std::uint32_t y) {
    std::uint32_t rank = 0;
    x += 2, y += 2;  // so that the first cells are as far from the picture's axes as from each other
    for (int bit = 0; bit < 6; ++bit, x >>= 1, y >>= 1) rank = rank << 2 | ((x ^ y) & 1) << 1 | (y & 1);
    return rank;
}

// `maximum` is that of the row.
void count_maximum(Survey::Photo& photo, std::span<const float> row, float maximum) {
    if (static_cast<double>(maximum) < photo.maximum) return;
    if (static_cast<double>(maximum) > photo.maximum) photo.at_maximum = 0;
    photo.maximum = static_cast<double>(maximum);
    photo.at_maximum += std::count(row.begin(), row.end(), maximum);
}

struct SamplePlace {
    glm::ivec2 pixel;
    std::uint32_t rank;
};

// Pixels on a jittered grid, so that the weave of a canvas is not sampled in step. What is chosen of a
// picture that is mirrored or turned by a quarter is mirrored and turned as well: the jitter is that of the
// cell that a cell has in the picture's first octant. Rows ascend.
std::vector<SamplePlace> sample_places(const Stack& stack, int wanted) {
    const double area = static_cast<double>(stack.width()) * stack.height();
    const int step = std::max(1, static_cast<int>(std::floor(std::sqrt(area / wanted))));
    const Axis across{stack.width()}, down{stack.height()};
    const auto in_cell = [step](const Axis& axis, int cell, std::uint32_t random) {
        const int first = cell * step, size = std::min(step, axis.from_middle() - first);
        return first + static_cast<int>(random % static_cast<unsigned>(size));
    };
    std::vector<SamplePlace> places;
    for (int cy = 0; cy * step < down.from_middle(); ++cy)
        for (int cx = 0; cx * step < across.from_middle(); ++cx) {
            const auto far = static_cast<std::uint32_t>(std::max(cx, cy)),
                       near = static_cast<std::uint32_t>(std::min(cx, cy));
            const std::uint32_t random = scattered(far << 16 | near);
            const std::uint32_t along_far = random >> 16,
                                along_near = far == near ? along_far : random & 0xFFFF;
            const int mx = in_cell(across, cx, cx >= cy ? along_far : along_near),
                      my = in_cell(down, cy, cx >= cy ? along_near : along_far);
            for (const bool up : {false, true})
                for (const bool left : {false, true}) {
                    if ((up && down.is_own_mirror(my)) || (left && across.is_own_mirror(mx))) continue;
                    const glm::ivec2 at(across.at(mx, left), down.at(my, up));
                    if (stack.mask.empty() || stack.mask(at.x, at.y))
                        places.push_back({at, dithered(far, near)});
                }
        }
    std::sort(places.begin(), places.end(), [](const SamplePlace& a, const SamplePlace& b) {
        return std::pair(a.pixel.y, a.pixel.x) < std::pair(b.pixel.y, b.pixel.x);
    });
    return places;
}

}  // namespace

std::vector<int> Survey::spread(int wanted) const {
    std::vector<int> chosen(positions.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    if (wanted >= sample_count()) return chosen;
    if (ranks.empty()) {
        const int step = sample_count() / std::max(wanted, 1);
        std::erase_if(chosen, [&](int k) { return k % step != 0; });
        return chosen;
    }
    std::vector<std::uint32_t> in_order = ranks;
    const auto last = in_order.begin() + std::max(wanted, 1) - 1;
    std::nth_element(in_order.begin(), last, in_order.end());
    std::erase_if(chosen, [&](int k) { return ranks[static_cast<std::size_t>(k)] > *last; });
    return chosen;
}

namespace {

// Sums over one row of one channel. Returns how many pixels hold nothing.
TP_VECTOR_CLONES
long add_row(const float* row, int width, float clipped, Survey::Photo& photo) {
    // In lanes: each waits for its own last addition only. A float's sum of a few hundred values is exact to
    // 1e-5.
    constexpr int kLanes = 16, kPixels = 256 * kLanes;
    float maxima[kLanes] = {};
    int beyond[kLanes] = {}, absent[kLanes] = {};
    for (int begin = 0; begin < width; begin += kPixels) {
        const int end = std::min(begin + kPixels, width);
        float sums[kLanes] = {};
        int x = begin;
        for (; x + kLanes <= end; x += kLanes)
            for (int i = 0; i < kLanes; ++i) {
                const float value = row[x + i] == row[x + i] ? row[x + i] : 0.0f;  // NaN holds nothing
                absent[i] += row[x + i] != row[x + i];
                sums[i] += value;
                maxima[i] = maxima[i] < value ? value : maxima[i];
                beyond[i] += value >= clipped;
            }
        for (; x < end; ++x) {
            const float value = row[x] == row[x] ? row[x] : 0.0f;
            absent[0] += row[x] != row[x];
            sums[0] += value;
            maxima[0] = std::max(maxima[0], value);
            beyond[0] += value >= clipped;
        }
        for (const float sum : sums) photo.mean += static_cast<double>(sum);
    }
    count_maximum(photo, {row, static_cast<std::size_t>(width)},
                  *std::max_element(std::begin(maxima), std::end(maxima)));
    photo.clipped += std::accumulate(std::begin(beyond), std::end(beyond), 0);
    return std::accumulate(std::begin(absent), std::end(absent), 0L);
}

// Sums over a band, by photograph; `missing` counts what holds nothing.
void add_band(const Band& band, int width, float clipped, Survey& result, std::vector<long>& missing) {
    parallel_for(0, band.photos(), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            for (int c = 0; c < band.channels(); ++c)
                for (int y = band.y0(); y < band.y1(); ++y)
                    missing[at] += add_row(band.row(i, c, y), width, clipped, result.photos[at]);
        }
    });
}

// Values of the samples from `next` on that the band has.
void take_samples(const Band& band, Survey& result, std::size_t& next) {
    const auto values = static_cast<std::size_t>(band.photos() * band.channels());
    for (; next < result.positions.size() && result.positions[next].y < band.y1(); ++next) {
        float* value = &result.values[next * values];
        for (int i = 0; i < band.photos(); ++i)
            for (int c = 0; c < band.channels(); ++c)
                *value++ = band.row(i, c, result.positions[next].y)[result.positions[next].x];
    }
}

}  // namespace

Survey survey(const Stack& stack, const SurveyOptions& options, const Progress& progress,
              const std::function<void(const Band&)>& seen) {
    const int photos = static_cast<int>(stack.photos.size()), channels = stack.channels;
    Survey result;
    result.photos.resize(static_cast<std::size_t>(photos));
    result.channels = channels;
    for (const SamplePlace& place : sample_places(stack, options.samples)) {
        result.positions.push_back(place.pixel);
        result.ranks.push_back(place.rank);
    }
    result.values.resize(result.positions.size() * static_cast<std::size_t>(photos * channels));

    const float clipped = stack.development ? stack.development->clipped : kClipped;
    StackReader reader(stack);
    const int rows = reader.rows_for(kSurveyBandBytes);
    std::vector<long> missing(static_cast<std::size_t>(photos));
    std::size_t next = 0;
    for (int y0 = 0; y0 < stack.height(); y0 += rows) {
        report(progress, "survey", y0 / static_cast<double>(stack.height()));
        const Band band = reader.read(y0, std::min(y0 + rows, stack.height()), Transfer{});
        if (seen) seen(band);
        add_band(band, stack.width(), clipped, result, missing);
        take_samples(band, result, next);
    }
    const double count = static_cast<double>(channels) * stack.width() * stack.height();
    for (std::size_t i = 0; i < result.photos.size(); ++i) {
        const double present = std::max(1.0, count - static_cast<double>(missing[i]));
        result.photos[i].mean /= present;
        result.photos[i].clipped /= present;
        result.photos[i].present = (count - static_cast<double>(missing[i])) / count;
        result.photos[i].without_number = reader.without_number(i);
        result.photos[i].transparent = reader.transparent(i);
    }
    report(progress, "survey", 1);
    return result;
}

void tell_pixels_without_number(Stack& stack, const Survey& survey) {
    TP_REQUIRE(stack.photos.size() == survey.photos.size(), "the survey is of this stack");
    const auto tell = [&](const char* what, long Survey::Photo::*pixels) {
        std::vector<std::string> told;
        for (std::size_t i = 0; i < stack.photos.size(); ++i)
            if (const long count = survey.photos[i].*pixels; count > 0)
                told.push_back(fmt::format("{} of {}", count, stack.photos[i].light.name));
        if (!told.empty())
            stack.warnings.push_back(fmt::format("{}: {}, and count as not photographed: {}",
                                                 stack.folder.string(), what, joined(told)));
    };
    tell("pixels hold no number that light can have (NaN, infinite)", &Survey::Photo::without_number);
    tell("pixels are transparent (alpha below one half)", &Survey::Photo::transparent);
}

void leave_out_black_photos(Stack& stack, Survey& survey, std::size_t fewest) {
    TP_REQUIRE(stack.photos.size() == survey.photos.size(), "the survey is of this stack");
    // Files of floats have no full scale, and those of 16 bits hold pictures that are much too dark: what is
    // black is so beside the other photographs.
    double brightest = 0;
    for (const Survey::Photo& photo : survey.photos) brightest = std::max(brightest, photo.maximum);
    const bool is_fine = stack.bits == 32 || (stack.bits == 16 && brightest > kDarkest16);
    const double black_level = is_fine ? kBlackLevel * std::min(brightest, 1.0) : kBlackLevel;
    std::vector<std::string> names, empty;
    std::vector<bool> keep;
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        const bool is_empty = survey.photos[i].present == 0;
        keep.push_back(!is_empty && survey.photos[i].maximum >= black_level);
        if (!keep.back()) (is_empty ? empty : names).push_back(stack.photos[i].light.name);
    }
    if (names.empty() && empty.empty()) return;
    const std::size_t black = names.size() + empty.size();

    const std::size_t all = keep.size();
    keep_photos(stack, survey, keep);
    const auto tell = [&](const std::vector<std::string>& of, const char* one, const char* several) {
        if (!of.empty())
            stack.warnings.push_back(fmt::format("{}: rejected {} photograph{} that {}: {}",
                                                 stack.folder.string(), of.size(), of.size() == 1 ? "" : "s",
                                                 of.size() == 1 ? one : several, fmt::join(of, ", ")));
    };
    tell(names, "is black", "are black");
    tell(empty, "has no pixel here with a number, or all of them are transparent",
         "have no pixel here with a number, or all of them are transparent");
    names.insert(names.end(), empty.begin(), empty.end());
    constexpr std::size_t of_a_fit = 4;
    const std::string needed = fmt::format("at least {} {} needed", fewest,
                                           fewest >= of_a_fit ? "under different lights are" : "is");
    if (stack.photos.empty())
        fail("{}: all {} photographs are black; {}", stack.folder.string(), all, needed);
    if (stack.photos.size() < fewest)
        fail("{}: {} of {} photographs are black ({}), which leaves {}; {}", stack.folder.string(), black,
             all, joined(names), stack.photos.size(), needed);
    if (fewest >= of_a_fit) require_enough_lights(stack.lights(), stack.folder.string());
}

}  // namespace tangi
