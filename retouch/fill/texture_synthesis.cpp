#include "retouch/fill/texture_synthesis.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "retouch/fill/fill.h"
#include "surface/base/error.h"
#include "surface/base/noise.h"

namespace tangi {

namespace {

constexpr int kCoarsestDepth_px =
    3;  // of the hole, in patches' half sides: from there on, all is in one reach
constexpr int kSearches = 2, kVotes = 5, kMeans = 2;
constexpr float kFar = std::numeric_limits<float>::max();

struct Point {
    int x = 0, y = 0;
};

class Chance {
public:
    explicit Chance(std::uint64_t seed) : seed_(seed) {}
    // 0 .. count - 1
    int below(int count) {
        return static_cast<int>(procedural::hash(seed_, drawn_++) % static_cast<std::uint64_t>(count));
    }

private:
    std::uint64_t seed_, drawn_ = 0;
};

// One level of the pyramid.
struct Level {
    std::vector<Image<float>> values;
    Mask hole, usable;

    int width() const { return hole.width(); }
    int height() const { return hole.height(); }
};

// Half the size: of what is known the mean; a hole where there is any, to take from where all four may be.
Level halved(const Level& fine, const std::vector<SynthesisChannel>& channels) {
    const int w = (fine.width() + 1) / 2, h = (fine.height() + 1) / 2;
    Level coarse{std::vector<Image<float>>(fine.values.size(), Image<float>(w, h)), Mask(w, h), Mask(w, h)};
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            float hole = 0, usable = 1;
            int known = 0, all = 0;
            std::vector<float> of_known(fine.values.size()), of_all(fine.values.size());
            for (int k = 0; k < 4; ++k) {
                const int u = 2 * x + k % 2, v = 2 * y + k / 2;
                if (u >= fine.width() || v >= fine.height()) continue;
                const bool in = fine.hole(u, v) >= 0.5f;
                hole = std::max(hole, fine.hole(u, v));
                usable = std::min(usable, fine.usable(u, v));
                ++all, known += in ? 0 : 1;
                for (std::size_t c = 0; c < of_all.size(); ++c) {
                    of_all[c] += fine.values[c](u, v);
                    if (!in) of_known[c] += fine.values[c](u, v);
                }
            }
            coarse.hole(x, y) = hole, coarse.usable(x, y) = usable;
            for (std::size_t c = 0; c < of_all.size(); ++c)
                coarse.values[c](x, y) = known == 0 || channels[c].guide
                                             ? of_all[c] / static_cast<float>(all)
                                             : of_known[c] / static_cast<float>(known);
        }
    return coarse;
}

// The search for the nearest patches at one level.
class Field {
public:
    Field(Level& level, const std::vector<SynthesisChannel>& channels, int radius, Chance& chance)
        : level_(level), channels_(channels), radius_(radius), chance_(chance) {
        const int w = level.width(), h = level.height(), side = 2 * radius + 1;
        source_ = Image<int>(w, h);
        where_ = Image<int>(w, h, -1);
        // Sums over rectangles tell where a patch is whole, and where it touches the hole.
        const auto sums = [&](const auto& counts) {
            Image<int> sum(w + 1, h + 1);
            for (int y = 0; y < h; ++y)
                for (int x = 0; x < w; ++x)
                    sum(x + 1, y + 1) = sum(x, y + 1) + sum(x + 1, y) - sum(x, y) + (counts(x, y) ? 1 : 0);
            return sum;
        };
        const Image<int> good =
            sums([&](int x, int y) { return level.usable(x, y) >= 0.5f && level.hole(x, y) < 0.5f; });
        const Image<int> holes = sums([&](int x, int y) { return level.hole(x, y) >= 0.5f; });
        for (int y = radius; y + radius < h; ++y)
            for (int x = radius; x + radius < w; ++x) {
                const auto count = [&](const Image<int>& sum) {
                    return sum(x + radius + 1, y + radius + 1) - sum(x - radius, y + radius + 1) -
                           sum(x + radius + 1, y - radius) + sum(x - radius, y - radius);
                };
                if (count(good) == side * side) source_(x, y) = 1, sources_.push_back({x, y});
                if (count(holes) > 0)
                    where_(x, y) = static_cast<int>(targets_.size()), targets_.push_back({x, y});
            }
        // What is near to the rim is surer (Wexler, Shechtman, Irani 2007: 1.3 to the power of the distance).
        const Image<float> depth = distance_inside_px(level.hole);
        for (const Point& t : targets_) sure_.push_back(std::pow(1.3f, -std::max(depth(t.x, t.y), 0.0f)));
        from_.resize(targets_.size());
        distance_.assign(targets_.size(), kFar);
    }

    bool possible() const { return !sources_.empty() && !targets_.empty(); }

    // From chance, or from the level that is coarser by two.
    void begin(const Field* coarse) {
        for (std::size_t i = 0; i < targets_.size(); ++i) {
            Point s{-1, -1};
            if (coarse) {
                const Point t = targets_[i];
                const int u = std::min(t.x / 2, coarse->where_.width() - 1),
                          v = std::min(t.y / 2, coarse->where_.height() - 1);
                if (const int there = coarse->where_(u, v); there >= 0) {
                    const Point c = coarse->from_[static_cast<std::size_t>(there)];
                    s = {2 * c.x + t.x % 2, 2 * c.y + t.y % 2};
                }
            }
            if (!is_source(s))
                s = sources_[static_cast<std::size_t>(chance_.below(static_cast<int>(sources_.size())))];
            from_[i] = s;
        }
    }

    void search() {
        for (std::size_t i = 0; i < targets_.size(); ++i)
            distance_[i] = distance(targets_[i], from_[i], kFar);
        const auto count = static_cast<std::ptrdiff_t>(targets_.size());
        for (int pass = 0; pass < kSearches; ++pass) {
            const int step = pass % 2 == 0 ? -1 : 1;  // neighbours that were looked at before
            for (std::ptrdiff_t k = 0; k < count; ++k) {
                const auto i = static_cast<std::size_t>(step < 0 ? k : count - 1 - k);
                const Point t = targets_[i];
                follow(i, {t.x + step, t.y}, {-step, 0});
                follow(i, {t.x, t.y + step}, {0, -step});
                for (int reach = std::max(level_.width(), level_.height()); reach >= 1; reach /= 2)
                    attempt(i, {from_[i].x + chance_.below(2 * reach + 1) - reach,
                                from_[i].y + chance_.below(2 * reach + 1) - reach});
            }
        }
    }

    // Every pixel of the hole becomes the mean of what the patches over it say; the better they fit, the more
    // they count.
    void vote() {
        std::vector<float> sorted = distance_;
        const std::size_t quartile = sorted.size() * 3 / 4;
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(quartile),
                         sorted.end());
        const float spread = std::max(sorted[quartile], 1e-6f);
        std::vector<float> weight(distance_.size());
        for (std::size_t i = 0; i < weight.size(); ++i)
            weight[i] = sure_[i] * (std::exp(-distance_[i] / (2 * spread)) + 1e-6f);
        std::vector<Image<float>> before = level_.values;
        for (int y = 0; y < level_.height(); ++y)
            for (int x = 0; x < level_.width(); ++x) {
                if (level_.hole(x, y) < 0.5f) continue;
                std::vector<float> sum(before.size());
                float weights = 0;
                for (int dy = -radius_; dy <= radius_; ++dy)
                    for (int dx = -radius_; dx <= radius_; ++dx) {
                        const int u = x + dx, v = y + dy;
                        if (u < 0 || v < 0 || u >= level_.width() || v >= level_.height() || where_(u, v) < 0)
                            continue;
                        const auto i = static_cast<std::size_t>(where_(u, v));
                        const float w = weight[i];
                        for (std::size_t c = 0; c < sum.size(); ++c)
                            sum[c] += w * before[c](from_[i].x - dx, from_[i].y - dy);
                        weights += w;
                    }
                for (std::size_t c = 0; c < sum.size(); ++c)
                    if (!channels_[c].guide && weights > 0) level_.values[c](x, y) = sum[c] / weights;
            }
    }

    // Means make the hole one piece, but blurred, and patches that are like it blurred again: from then on,
    // every pixel is the one in the middle of its own nearest patch.
    void take() {
        const std::vector<Image<float>> before = level_.values;
        for (std::size_t i = 0; i < targets_.size(); ++i) {
            const Point t = targets_[i], s = from_[i];
            if (level_.hole(t.x, t.y) < 0.5f) continue;
            for (std::size_t c = 0; c < before.size(); ++c)
                if (!channels_[c].guide) level_.values[c](t.x, t.y) = before[c](s.x, s.y);
        }
    }

private:
    bool is_source(const Point& p) const {
        return p.x >= 0 && p.y >= 0 && p.x < source_.width() && p.y < source_.height() &&
               source_(p.x, p.y) > 0;
    }
    float distance(const Point& t, const Point& s, float enough) const {
        float sum = 0;
        const auto side = static_cast<std::size_t>(2 * radius_ + 1);
        for (int dy = -radius_; dy <= radius_ && sum < enough; ++dy)
            for (const Image<float>& values : level_.values) {
                const float* a = &values(t.x - radius_, t.y + dy);
                const float* b = &values(s.x - radius_, s.y + dy);
                for (std::size_t k = 0; k < side; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
            }
        return sum;
    }
    void attempt(std::size_t i, const Point& s) {
        if (!is_source(s)) return;
        if (const float d = distance(targets_[i], s, distance_[i]); d < distance_[i])
            distance_[i] = d, from_[i] = s;
    }
    // What is right for the neighbour is likely right for the pixel, one step on.
    void follow(std::size_t i, const Point& neighbour, const Point& step) {
        const int there = where_(neighbour.x, neighbour.y);
        if (there < 0) return;
        const Point s = from_[static_cast<std::size_t>(there)];
        attempt(i, {s.x + step.x, s.y + step.y});
    }

    Level& level_;
    const std::vector<SynthesisChannel>& channels_;
    int radius_;
    Chance& chance_;
    Image<int> source_, where_;  // whether a patch may be taken; the number of a target, or -1
    std::vector<Point> sources_, targets_, from_;
    std::vector<float> distance_, sure_;
};

}  // namespace

bool synthesise_into(std::vector<SynthesisChannel>& channels, const Mask& hole, const Mask& usable,
                     const SynthesisOptions& options, const Progress& progress) {
    TP_REQUIRE(!channels.empty() && hole.region() == usable.region(),
               "channels and masks are of one picture");
    TP_REQUIRE(options.patch_px % 2 == 1 && options.patch_px >= 3, "a patch has an odd side");
    const int radius = options.patch_px / 2;
    std::vector<Level> levels(1);
    levels[0].hole = hole, levels[0].usable = usable;
    for (const SynthesisChannel& channel : channels) {
        TP_REQUIRE(channel.values.region() == hole.region(), "channels and masks are of one picture");
        levels[0].values.push_back(channel.values);
    }
    Chance chance(options.seed);
    if (!Field(levels[0], channels, radius, chance).possible()) return false;
    const auto deepest = [](const Mask& mask) {
        const Image<float> depth = distance_inside_px(mask);
        return *std::max_element(depth.pixels().begin(), depth.pixels().end());
    };
    while (deepest(levels.back().hole) > static_cast<float>(kCoarsestDepth_px * radius)) {
        Level coarse = halved(levels.back(), channels);
        if (!Field(coarse, channels, radius, chance).possible()) break;
        levels.push_back(std::move(coarse));
    }
    for (std::size_t c = 0; c < channels.size(); ++c)
        if (!channels[c].guide) solve_membrane(levels.back().values[c], levels.back().hole);
    std::vector<Field> fields;
    fields.reserve(levels.size());
    for (std::size_t i = levels.size(); i-- > 0;) {
        fields.emplace_back(levels[i], channels, radius, chance);
        Field& field = fields.back();
        field.begin(fields.size() > 1 ? &fields[fields.size() - 2] : nullptr);
        if (fields.size() > 1) field.vote();  // what the coarser level found, at this one's sharpness
        for (int vote = 0; vote < kVotes; ++vote) {
            report(progress, "synthesise texture",
                   (static_cast<double>(levels.size() - 1 - i) + vote / static_cast<double>(kVotes)) /
                       static_cast<double>(levels.size()));
            field.search();
            vote < kMeans ? field.vote() : field.take();
        }
    }
    for (std::size_t c = 0; c < channels.size(); ++c) channels[c].values = std::move(levels[0].values[c]);
    return true;
}

}  // namespace tangi
