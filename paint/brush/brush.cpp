#include "paint/brush/brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "paint/exchange/transfer.h"
#include "surface/base/error.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

// What is narrower than three pixels meets more or fewer of them as its place between them has it.
constexpr double kLeastHalf_px = 1.5;

}  // namespace

Brush::Brush(const BrushSettings& settings, double mm_per_pixel, std::uint64_t seed)
    : settings_(settings), mm_per_pixel_(mm_per_pixel), seed_(seed), loads_(1, 1, 1) {
    validate(settings);
    TP_REQUIRE(mm_per_pixel > 0, "pixels have a size");
    width_px_ = settings.size_mm / mm_per_pixel;
    thickness_px_ = width_px_ * settings.thickness;
    half_width_px_ = std::max(width_px_ / 2, kLeastHalf_px);
    half_thickness_px_ = std::max(thickness_px_ / 2, kLeastHalf_px);
    if (half_width_px_ > width_px_ / 2 || half_thickness_px_ > thickness_px_ / 2)
        coverage_ = width_px_ * thickness_px_ / (4 * half_width_px_ * half_thickness_px_);
    const double widest = (1 + settings.splay) * portable::hypot(half_width_px_, half_thickness_px_);
    if (widest > 2000)
        fail("a brush of {} mm is {} pixels wide here; at most 2800 can be painted with", settings.size_mm,
             std::lround(2 * half_width_px_));
    disc_ = static_cast<int>(std::ceil(widest)) + 2;
    half_ = disc_ + kMargin + 2;
    const auto cells = [&](double half_px) {
        return static_cast<int>(std::ceil((half_px + 2) * (1 + settings.splay))) + 4;
    };
    loads_ = BristleLoads(cells(half_width_px_), cells(half_thickness_px_), half_);
    tip_ = BrushTip(settings, mm_per_pixel, half_width_px_, half_thickness_px_, seed);
}

double Brush::fresh_load(int u, int v, double middle_mm) const {
    const float widening = 1 + static_cast<float>(settings_.splay);
    return tip_.fresh_load_mm(static_cast<float>(u) / widening, static_cast<float>(v) / widening,
                              static_cast<float>(middle_mm)) *
           coverage_;
}

void Brush::turn_to(float rotation_rad) {
    const RimShift& rim = traits_of(settings_.shape).rim;
    const double most_px = std::clamp(half_thickness_px_ / rim.per_thickness, rim.least_px, rim.most_px);
    const float step = static_cast<float>(most_px) / static_cast<float>(disc_);
    loads_.turn_to(std::round(rotation_rad / step) * step);
}

std::vector<float> Brush::total_of(const std::vector<std::vector<float>>& cells) {
    std::vector<float> total(cells.empty() ? 0 : cells.front().size(), 0.0f);
    for (const auto& plane : cells)
        for (std::size_t i = 0; i < plane.size(); ++i) total[i] += plane[i];
    return total;
}

void Brush::clean() {
    loads_.clear();
    forget();
}

void Brush::load(const std::vector<Portion>& recipe, double amount, bool keep) {
    fill(recipe, amount, settings_.load_mm, keep);
}

void Brush::fill(const std::vector<Portion>& recipe, double amount, double middle_mm, bool keep) {
    double parts = 0;
    for (const Portion& portion : recipe) parts += portion.part;
    if (!(parts > 0)) fail("a brush is loaded with parts of paint that sum to {}", parts);
    keep ? forget() : clean();
    std::map<IngredientId, std::vector<float>> planes;
    auto there = loads_.cells();
    std::vector<float> total = total_of(there);
    for (std::size_t i = 0; i < there.size(); ++i) planes[ingredients()[i]] = std::move(there[i]);
    const int half_u = loads_.half_u(), half_v = loads_.half_v();
    total.resize(static_cast<std::size_t>(2 * half_u + 1) * static_cast<std::size_t>(2 * half_v + 1), 0.0f);
    for (const Portion& portion : recipe) planes[portion.ingredient].resize(total.size(), 0.0f);
    std::size_t i = 0;
    for (int v = -half_v; v <= half_v; ++v)
        for (int u = -half_u; u <= half_u; ++u, ++i) {
            const float room = static_cast<float>(fresh_load(u, v, middle_mm) * amount) - total[i];
            if (!(room > 0)) continue;
            for (const Portion& portion : recipe)
                planes[portion.ingredient][i] += room * static_cast<float>(portion.part / parts);
        }
    std::vector<IngredientId> ids;
    std::vector<std::vector<float>> cells;
    for (auto& [id, plane] : planes) {
        ids.push_back(id);
        cells.push_back(std::move(plane));
    }
    loads_.set(std::move(ids), std::move(cells));
}

void Brush::take_over(const Brush& other) {
    clean();
    const double area = other.mm_per_pixel_ * other.mm_per_pixel_;
    std::vector<Portion> recipe;
    double on_other = 0, here = 0;
    const auto cells = other.loads_.cells();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        double sum = 0;
        for (const float mm : cells[i]) sum += mm;
        if (sum > 0) recipe.push_back({other.ingredients()[i], sum});
        on_other += sum * area;
    }
    if (!(on_other > 0)) return;
    // A rag, or a smudge, is never loaded, and yet holds what comes onto it.
    const double middle_mm = settings_.load_mm >= 1e-3 ? settings_.load_mm : 1;
    fill(recipe, 1, middle_mm, false);
    for (const float mm : total_of(loads_.cells())) here += mm * mm_per_pixel_ * mm_per_pixel_;
    TP_REQUIRE(here > 0, "a brush has bristles");
    fill(recipe, on_other / here, middle_mm, false);
}

BrushLoad Brush::bristles() const {
    BrushLoad load;
    load.ingredients = ingredients();
    const auto size = static_cast<std::size_t>(grid_size());
    const auto width = static_cast<std::size_t>(2 * loads_.half_u() + 1);
    const auto left = static_cast<std::size_t>(half_ - loads_.half_u()),
               top = static_cast<std::size_t>(half_ - loads_.half_v());
    load.total_mm.assign(size * size, 0.0f);
    for (const auto& cells : loads_.cells()) {
        auto& plane = load.mm.emplace_back(size * size, 0.0f);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::size_t to = (i / width + top) * size + i % width + left;
            plane[to] = cells[i];
            load.total_mm[to] += cells[i];
        }
    }
    return load;
}

void Brush::put_back(const BrushLoad& load) {
    forget();
    const auto size = static_cast<std::size_t>(grid_size());
    TP_REQUIRE(load.total_mm.size() == size * size && load.mm.size() == load.ingredients.size(),
               "a load of this brush");
    const float c = portable::cos(load.rotation_rad), s = portable::sin(load.rotation_rad);
    const int half_u = loads_.half_u(), half_v = loads_.half_v();
    std::vector<std::vector<float>> all;
    for (const auto& plane : load.mm) {
        TP_REQUIRE(plane.size() == size * size, "a load of this brush");
        auto& cells = all.emplace_back(
            static_cast<std::size_t>(2 * half_u + 1) * static_cast<std::size_t>(2 * half_v + 1), 0.0f);
        std::size_t i = 0;
        for (int y = -half_; y <= half_; ++y)
            for (int x = -half_; x <= half_; ++x, ++i) {
                if (plane[i] == 0) continue;
                const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
                const int u = std::clamp(static_cast<int>(std::lround(fx * c + fy * s)), -half_u, half_u);
                const int v = std::clamp(static_cast<int>(std::lround(fy * c - fx * s)), -half_v, half_v);
                cells[static_cast<std::size_t>((v + half_v) * (2 * half_u + 1) + u + half_u)] += plane[i];
            }
    }
    loads_.set(load.ingredients, std::move(all));
}

void Brush::renumber(const std::vector<IngredientId>& number) {
    std::map<IngredientId, std::vector<float>> planes;
    auto cells = loads_.cells();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        TP_REQUIRE(ingredients()[i] < number.size(), "each paint of the brush has a number");
        TP_REQUIRE(planes.emplace(number[ingredients()[i]], std::move(cells[i])).second,
                   "paints that differ have two numbers");
    }
    std::vector<IngredientId> ids;
    cells.clear();
    for (auto& [id, plane] : planes) {
        ids.push_back(id);
        cells.push_back(std::move(plane));
    }
    loads_.set(std::move(ids), std::move(cells));
}

std::vector<double> Brush::volumes_mm3(std::size_t count) const {
    std::vector<double> sums(count, 0.0);
    const auto cells = loads_.cells();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        TP_REQUIRE(ingredients()[i] < count, "the brush's ingredients are those that are counted");
        double& sum = sums[ingredients()[i]];
        for (const float mm : cells[i]) sum += mm;
        sum *= mm_per_pixel_ * mm_per_pixel_;
    }
    return sums;
}

double Brush::full_mm3() const {
    double sum = 0;
    for (int v = -loads_.half_v(); v <= loads_.half_v(); ++v)
        for (int u = -loads_.half_u(); u <= loads_.half_u(); ++u)
            sum += std::max(fresh_load(u, v, settings_.load_mm), 0.0);
    return sum * mm_per_pixel_ * mm_per_pixel_;
}

void Brush::weigh(int step) {
    const bool blade = traits_of(settings_.shape).blade;
    constexpr int often = 8;  // it changes slowly
    if (!blade && mean_load_mm_ >= 0 && step % often != 0) return;
    const float* load = loads_.view_total();
    const auto cells = static_cast<std::size_t>(grid_size()) * static_cast<std::size_t>(grid_size());
    std::array<double, 8> sums{};  // of every eighth: one sum would wait for each addition
    for (std::size_t i = 0; i < cells; ++i) sums[i % sums.size()] += static_cast<double>(load[i]);
    const double mean_mm =
        std::accumulate(sums.begin(), sums.end(), 0.0) / (4 * half_width_px_ * half_thickness_px_);
    mean_load_mm_ = mean_mm / coverage_;
    // What it scrapes up lies on its face and does not lift it before the next stroke.
    if (blade) bead_mm_ = std::min(bead_mm_, static_cast<float>(mean_load_mm_));
}

void Brush::forget() {
    bead_mm_ = kOutside;
    mean_load_mm_ = -1;
}

void Brush::rest() {
    loads_.rest();
    forget();
}

}  // namespace tangi
