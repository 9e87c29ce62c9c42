#include "capture/survey.h"

#include <algorithm>
#include <cmath>

#include "capture/stray_photos.h"
#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr std::size_t kBandBytes = 64u << 20;
constexpr double kBlack = 0.02;  // [1] of full scale

// Pixels on a jittered grid, so that the weave of a canvas is not sampled in step. Rows ascend.
std::vector<glm::ivec2> sample_positions(const Stack& stack, int wanted) {
    const double area = static_cast<double>(stack.width()) * stack.height();
    const int step = std::max(1, static_cast<int>(std::floor(std::sqrt(area / wanted))));
    std::vector<glm::ivec2> positions;
    std::uint32_t state = 0x9E3779B9u;
    for (int y = 0; y < stack.height(); y += step)
        for (int x = 0; x < stack.width(); x += step) {
            state = state * 1664525u + 1013904223u;
            const int px =
                std::min(x + static_cast<int>((state >> 8) % static_cast<unsigned>(step)), stack.width() - 1);
            if (stack.mask.empty() || stack.mask(px, y)) positions.emplace_back(px, y);
        }
    return positions;
}

}  // namespace

Survey survey(const Stack& stack, const SurveyOptions& options, const Progress& progress,
              const std::function<void(const Band&)>& seen) {
    const int photos = static_cast<int>(stack.photos.size()), channels = stack.channels;
    Survey result;
    result.photos.resize(static_cast<std::size_t>(photos));
    result.channels = channels;
    result.positions = sample_positions(stack, options.samples);
    result.values.resize(result.positions.size() * static_cast<std::size_t>(photos * channels));

    const float clipped = stack.development ? stack.development->clipped : kClipped;
    StackReader reader(stack);
    const int rows = reader.rows_for(kBandBytes);
    std::vector<long> missing(static_cast<std::size_t>(photos));
    std::size_t next = 0;
    for (int y0 = 0; y0 < stack.height(); y0 += rows) {
        report(progress, "survey", y0 / static_cast<double>(stack.height()));
        const int y1 = std::min(y0 + rows, stack.height());
        const Band band = reader.read(y0, y1, Transfer{});
        if (seen) seen(band);
        parallel_for(0, photos, 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                Survey::Photo& photo = result.photos[static_cast<std::size_t>(i)];
                for (int c = 0; c < channels; ++c)
                    for (int y = y0; y < y1; ++y) {
                        // In registers: neighbours of other threads' numbers are slow to write to.
                        double sum = 0;
                        float maximum = 0;
                        int beyond = 0, absent = 0;
                        const float* row = band.row(i, c, y);
                        for (int x = 0; x < stack.width(); ++x) {
                            const bool there = !std::isnan(row[x]);
                            const float value = there ? row[x] : 0.0f;
                            absent += !there;
                            sum += value;
                            maximum = std::max(maximum, value);
                            beyond += value >= clipped;
                        }
                        photo.mean += sum;
                        photo.maximum = std::max<double>(photo.maximum, maximum);
                        photo.clipped += beyond;
                        missing[static_cast<std::size_t>(i)] += absent;
                    }
            }
        });
        for (; next < result.positions.size() && result.positions[next].y < y1; ++next) {
            float* value = &result.values[next * static_cast<std::size_t>(photos * channels)];
            for (int i = 0; i < photos; ++i)
                for (int c = 0; c < channels; ++c)
                    *value++ = band.row(i, c, result.positions[next].y)[result.positions[next].x];
        }
    }
    const double count = static_cast<double>(channels) * stack.width() * stack.height();
    for (std::size_t i = 0; i < result.photos.size(); ++i) {
        const double present = std::max(1.0, count - static_cast<double>(missing[i]));
        result.photos[i].mean /= present;
        result.photos[i].clipped /= present;
    }
    report(progress, "survey", 1);
    return result;
}

void leave_out_black_photos(Stack& stack, Survey& survey) {
    TP_REQUIRE(stack.photos.size() == survey.photos.size(), "the survey is of this stack");
    // Files of floats have no full scale: what is black is so beside the other photographs.
    double brightest = 0;
    for (const Survey::Photo& photo : survey.photos) brightest = std::max(brightest, photo.maximum);
    const double black_level = stack.bits == 32 ? kBlack * std::min(brightest, 1.0) : kBlack;
    std::string names;
    int black = 0;
    std::vector<bool> keep;
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        keep.push_back(survey.photos[i].maximum >= black_level);
        if (!keep.back()) names += (black++ ? ", " : "") + stack.photos[i].light.name;
    }
    if (black == 0) return;

    const std::size_t all = keep.size();
    keep_photos(stack, survey, keep);
    stack.warnings.push_back(fmt::format("{}: left out {} photograph{} that {} black: {}",
                                         stack.folder.string(), black, black == 1 ? "" : "s",
                                         black == 1 ? "is" : "are", names));
    if (stack.photos.size() < 4)
        fail(
            "{}: {} of {} photographs are black ({}), which leaves {}; at least 4 under different lights are "
            "needed",
            stack.folder.string(), black, all, names, stack.photos.size());
    require_enough_lights(stack.lights(), stack.folder.string());
}

}  // namespace tangi
