#include "paint/brush.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "paint/bristle_rows.h"
#include "paint/transfer.h"
#include "surface/error.h"
#include "surface/noise.h"

namespace tangi {

namespace {

using procedural::hash;
using procedural::uniform;

constexpr int kMargin = 4;          // [pixels] around the contact for paint that is pushed out of it
constexpr float kLightest = 0.15f;  // part of the dome that the lightest touch flattens
// What is narrower than three pixels meets more or fewer of them as its place between them has it.
constexpr double kLeastHalf_px = 1.5;

// 0 in the middle of the tip, 1 at its rim; u and v in half extents.
float dome_of(const std::string& shape, float u, float v, std::uint64_t seed) {
    const float rho2 = u * u + v * v;
    if (shape == "flat") return std::pow(std::abs(u), 10.0f) + v * v;
    if (shape == "filbert") return std::pow(std::abs(u), 3.0f) + v * v;
    if (shape == "knife") return std::pow(std::abs(u), 16.0f) + v * v;
    if (shape == "fan") {  // an arc of tufts
        const float along = v + 1.6f * (u * u - 0.4f);
        return std::pow(std::abs(u), 10.0f) + along * along;
    }
    if (shape == "rag")  // folds
        return rho2 * (1 + 0.5f * procedural::fractal_noise(2.5f * u, 2.5f * v, 3, hash(seed, 77)));
    return rho2;
}

// The bristles around a point: each cell of a grid holds one, off its middle by up to half a cell.
struct Bristle {
    float shorter;     // [1] 0 = the longest
    float distance;    // [cells] to the nearest
    std::uint64_t id;  // of the nearest
};

Bristle bristle_at(float u, float v, std::uint64_t seed) {
    const int cu = static_cast<int>(std::floor(u)), cv = static_cast<int>(std::floor(v));
    float envelope = 10, best = 10;
    std::uint64_t nearest = 0;
    for (int j = cv - 1; j <= cv + 1; ++j)
        for (int i = cu - 1; i <= cu + 1; ++i) {
            const std::uint64_t h = hash(seed, i, j);
            const float du = static_cast<float>(i) + uniform(hash(h, 1)) - u;
            const float dv = static_cast<float>(j) + uniform(hash(h, 2)) - v;
            const float distance2 = du * du + dv * dv;
            // Most bristles are a little shorter than the longest, some much.
            const float length = uniform(hash(h, 3));
            const float shorter = 0.75f * length * std::sqrt(length);
            envelope = std::min(envelope, shorter + 0.6f * distance2);
            if (distance2 < best) best = distance2, nearest = h;
        }
    return {envelope, std::sqrt(best), nearest};
}

// Where the cells of a brush lie when it is turned: each cell has another place, and none is lost.
class Turn {
public:
    Turn(float rotation_rad, int disc) : reach_(2 * disc + 2) {
        // Quarter turns are exact; what is left of the angle is within 45 degrees, where shears are small.
        const double quarter = std::numbers::pi / 2;
        const long quarters = std::lround(rotation_rad / quarter);
        const double rest = rotation_rad - static_cast<double>(quarters) * quarter;
        quarters_ = static_cast<int>(((quarters % 4) + 4) % 4);
        for (int i = -reach_; i <= reach_; ++i) {
            across_.push_back(static_cast<int>(std::lround(-std::tan(rest / 2) * i)));
            down_.push_back(static_cast<int>(std::lround(std::sin(rest) * i)));
        }
    }
    void place(int u, int v, int& x, int& y) const {
        x = u, y = v;
        for (int turn = quarters_; turn > 0; --turn) {
            const int old = x;
            x = -y;
            y = old;
        }
        x += across_[static_cast<std::size_t>(y + reach_)];
        y += down_[static_cast<std::size_t>(x + reach_)];
        x += across_[static_cast<std::size_t>(y + reach_)];
    }

private:
    int reach_, quarters_;
    std::vector<int> across_, down_;  // shifts of rows and columns
};

// Length of a contact with these half extents along the motion.
double length_along(const Dab& dab, double half_width, double half_thickness) {
    const double along = dab.dx * std::cos(dab.rotation_rad) + dab.dy * std::sin(dab.rotation_rad);
    return 2 * std::sqrt(half_width * half_width * along * along +
                         half_thickness * half_thickness * (1 - along * along));
}

// The turned rectangle or ellipse around the bristles, as rows cut it.
struct Outline {
    double a, b;  // [pixels] half extents
    double c, s;  // cosine and sine of the rotation
    bool ellipse;

    // Columns of a row `py` pixels below the middle that begins at `px` from it.
    RowSpan across(double py, double px, int width) const {
        double low = -1e9, high = 1e9;
        if (ellipse) {
            // (x c + y s)^2 / a^2 + (y c - x s)^2 / b^2 = 1 as a quadratic in x.
            const double p = c * c / (a * a) + s * s / (b * b), q = py * c * s * (1 / (a * a) - 1 / (b * b));
            const double r = py * py * (s * s / (a * a) + c * c / (b * b)) - 1, root2 = q * q - p * r;
            if (!(root2 >= 0)) return {0, 0};
            low = (-q - std::sqrt(root2)) / p;
            high = (-q + std::sqrt(root2)) / p;
        } else {
            const auto cut = [&](double slope, double offset, double half) {  // |slope x + offset| <= half
                if (std::abs(slope) < 1e-9) {
                    if (std::abs(offset) > half) high = -1e9;
                    return;
                }
                const double one = (-half - offset) / slope, other = (half - offset) / slope;
                low = std::max(low, std::min(one, other));
                high = std::min(high, std::max(one, other));
            };
            cut(c, py * s, a);
            cut(-s, py * c, b);
        }
        if (!(high >= low)) return {0, 0};
        const double begin = std::clamp(std::floor(low - px), 0.0, static_cast<double>(width));
        const double end = std::clamp(std::ceil(high - px) + 1, 0.0, static_cast<double>(width));
        return {static_cast<int>(begin), static_cast<int>(end)};
    }
};

}  // namespace

Brush::Brush(const BrushSettings& settings, double mm_per_pixel, std::uint64_t seed)
    : settings_(settings), mm_per_pixel_(mm_per_pixel), seed_(seed) {
    validate(settings);
    TP_REQUIRE(mm_per_pixel > 0, "pixels have a size");
    width_px_ = settings.size_mm / mm_per_pixel;
    thickness_px_ = width_px_ * settings.thickness;
    half_width_px_ = std::max(width_px_ / 2, kLeastHalf_px);
    half_thickness_px_ = std::max(thickness_px_ / 2, kLeastHalf_px);
    if (half_width_px_ > width_px_ / 2 || half_thickness_px_ > thickness_px_ / 2)
        coverage_ = width_px_ * thickness_px_ / (4 * half_width_px_ * half_thickness_px_);
    const double widest = (1 + settings.splay) * std::hypot(half_width_px_, half_thickness_px_);
    if (widest > 2000)
        fail("a brush of {} mm is {} pixels wide here; at most 2800 can be painted with", settings.size_mm,
             std::lround(2 * half_width_px_));
    disc_ = static_cast<int>(std::ceil(widest)) + 2;
    half_ = disc_ + kMargin + 2;
    total_.assign(static_cast<std::size_t>(grid_size()) * static_cast<std::size_t>(grid_size()), 0.0f);
    make_texture(seed);
}

void Brush::make_texture(std::uint64_t seed) {
    texture_half_u_ = static_cast<int>(std::ceil(half_width_px_)) + 2;
    texture_half_v_ = static_cast<int>(std::ceil(half_thickness_px_)) + 2;
    const int width = 2 * texture_half_u_ + 1, height = 2 * texture_half_v_ + 1;
    const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    dome_.assign(texels, kOutside);
    tip_.assign(texels, 0.0f);
    // Bristles thinner than two pixels cannot be told apart.
    const double cell_px = std::max(settings_.bristle_mm / mm_per_pixel_, 2.0);
    for (int v = 1 - texture_half_v_; v < texture_half_v_; ++v)
        for (int u = 1 - texture_half_u_; u < texture_half_u_; ++u) {
            const auto fu = static_cast<float>(u), fv = static_cast<float>(v);
            const auto a = static_cast<float>(half_width_px_), b = static_cast<float>(half_thickness_px_);
            const auto cell = static_cast<float>(cell_px);
            const Bristle fine = bristle_at(fu / cell, fv / cell, hash(seed, 1));
            const Bristle tuft =
                bristle_at(fu / (4 * cell), fv / (4 * cell), hash(seed, 2));  // they stick together
            const auto i = static_cast<std::size_t>((v + texture_half_v_) * width + u + texture_half_u_);
            dome_[i] = dome_of(settings_.shape, fu / a, fv / b, seed);
            tip_[i] = std::min(0.55f * fine.shorter + 0.7f * tuft.shorter, 1.5f);
        }
}

Brush::Texel Brush::texel(float u, float v) const {
    const int x = static_cast<int>(std::lround(u)) + texture_half_u_;
    const int y = static_cast<int>(std::lround(v)) + texture_half_v_;
    const int width = 2 * texture_half_u_ + 1, height = 2 * texture_half_v_ + 1;
    if (x < 0 || y < 0 || x >= width || y >= height) return {kOutside, 0};
    const auto i = static_cast<std::size_t>(y * width + x);
    return {dome_[i], tip_[i]};
}

float Brush::fresh_load(int u, int v) const {
    const float widening = 1 + static_cast<float>(settings_.splay);
    const auto fu = static_cast<float>(u) / widening, fv = static_cast<float>(v) / widening;
    const Texel t = texel(fu, fv);
    if (t.dome >= 1) return 0;
    const float cell = static_cast<float>(std::max(settings_.bristle_mm / mm_per_pixel_, 2.0));
    const Bristle fine = bristle_at(fu / cell, fv / cell, hash(seed_, 1));
    const Bristle tuft = bristle_at(fu / (4 * cell), fv / (4 * cell), hash(seed_, 2));
    const float luck = 0.4f * uniform(hash(fine.id, 9)) + 0.6f * uniform(hash(tuft.id, 9));
    return static_cast<float>(settings_.load_mm * coverage_) * (1 - 0.3f * t.dome) *
           (1 - static_cast<float>(settings_.load_variation) * luck);
}

void Brush::turn_to(float rotation_rad) {
    const float step = 1.0f / static_cast<float>(disc_);  // one pixel at the rim
    const float wanted = std::round(rotation_rad / step) * step;
    if (wanted == rotation_rad_) return;
    const int size = grid_size();
    const Turn before(rotation_rad_, disc_), after(wanted, disc_);
    std::vector<std::pair<int, int>> moves;
    for (int v = -disc_; v <= disc_; ++v)
        for (int u = -disc_; u <= disc_; ++u) {
            if (u * u + v * v > disc_ * disc_) continue;
            int x0, y0, x1, y1;
            before.place(u, v, x0, y0);
            after.place(u, v, x1, y1);
            moves.emplace_back((y0 + half_) * size + x0 + half_, (y1 + half_) * size + x1 + half_);
        }
    std::vector<float> turned(total_.size());
    const auto turn = [&](std::vector<float>& plane) {
        std::fill(turned.begin(), turned.end(), 0.0f);
        for (const auto& [from, to] : moves)
            turned[static_cast<std::size_t>(to)] = plane[static_cast<std::size_t>(from)];
        std::swap(plane, turned);
    };
    for (auto& plane : loads_) turn(plane);
    turn(total_);
    rotation_rad_ = wanted;
}

float* Brush::load_plane(IngredientId ingredient) {
    const auto found = std::lower_bound(ids_.begin(), ids_.end(), ingredient);
    const auto number = found - ids_.begin();
    if (found == ids_.end() || *found != ingredient) {
        ids_.insert(found, ingredient);
        loads_.insert(loads_.begin() + number, std::vector<float>(total_.size(), 0.0f));
    }
    return loads_[static_cast<std::size_t>(number)].data();
}

void Brush::sum_loads() {
    std::fill(total_.begin(), total_.end(), 0.0f);
    for (const auto& plane : loads_)
        for (std::size_t i = 0; i < plane.size(); ++i) total_[i] += plane[i];
}

void Brush::clean() {
    ids_.clear();
    loads_.clear();
    std::fill(total_.begin(), total_.end(), 0.0f);
}

void Brush::load(const std::vector<Portion>& recipe, double amount, bool keep) {
    double parts = 0;
    for (const Portion& portion : recipe) parts += portion.part;
    if (!(parts > 0)) fail("a brush is loaded with parts of paint that sum to {}", parts);
    if (!keep) clean();
    for (const Portion& portion : recipe) load_plane(portion.ingredient);
    const int size = grid_size();
    const Turn turn(rotation_rad_, disc_);
    for (int v = -disc_; v <= disc_; ++v)
        for (int u = -disc_; u <= disc_; ++u) {
            if (u * u + v * v > disc_ * disc_) continue;
            int x, y;
            turn.place(u, v, x, y);
            const auto i = static_cast<std::size_t>((y + half_) * size + x + half_);
            const float room = fresh_load(u, v) * static_cast<float>(amount) - total_[i];
            if (!(room > 0)) continue;
            for (const Portion& portion : recipe)
                load_plane(portion.ingredient)[i] += room * static_cast<float>(portion.part / parts);
        }
    sum_loads();
}

void Brush::take_over(const Brush& other) {
    clean();
    double on_other = 0, here = 0;
    for (const float mm : other.total_) on_other += mm;
    if (!(on_other > 0)) return;
    const double area = other.mm_per_pixel_ * other.mm_per_pixel_ / (mm_per_pixel_ * mm_per_pixel_);
    std::vector<Portion> recipe;
    for (std::size_t i = 0; i < other.ids_.size(); ++i) {
        double sum = 0;
        for (const float mm : other.loads_[i]) sum += mm;
        if (sum > 0) recipe.push_back({other.ids_[i], sum});
    }
    load(recipe, 1);
    for (const float mm : total_) here += mm;
    const double scale = here > 0 ? on_other * area / here : 0;
    if (!(scale > 0)) return clean();
    load(recipe, scale);
}

void Brush::put_back(BrushLoad load) {
    TP_REQUIRE(load.total_mm.size() == total_.size() && load.mm.size() == load.ingredients.size(),
               "a load of this brush");
    for (const auto& plane : load.mm) TP_REQUIRE(plane.size() == total_.size(), "a load of this brush");
    TP_REQUIRE(std::is_sorted(load.ingredients.begin(), load.ingredients.end()), "paints are in order");
    rotation_rad_ = load.rotation_rad;
    ids_ = std::move(load.ingredients);
    loads_ = std::move(load.mm);
    total_ = std::move(load.total_mm);
}

void Brush::renumber(const std::vector<IngredientId>& number) {
    std::vector<std::pair<IngredientId, std::vector<float>>> planes;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
        TP_REQUIRE(ids_[i] < number.size(), "each paint of the brush has a number");
        planes.emplace_back(number[ids_[i]], std::move(loads_[i]));
    }
    std::sort(planes.begin(), planes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < planes.size(); ++i) {
        TP_REQUIRE(i == 0 || planes[i - 1].first != planes[i].first, "paints that differ have two numbers");
        ids_[i] = planes[i].first;
        loads_[i] = std::move(planes[i].second);
    }
}

std::vector<double> Brush::volumes_mm3(std::size_t ingredients) const {
    std::vector<double> sums(ingredients, 0.0);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
        TP_REQUIRE(ids_[i] < ingredients, "the brush's ingredients are those that are counted");
        for (const float mm : loads_[i]) sums[ids_[i]] += mm;
        sums[ids_[i]] *= mm_per_pixel_ * mm_per_pixel_;
    }
    return sums;
}

void Brush::contact_centre(const Dab& dab, double& x, double& y) const {
    const double trail = settings_.bend * half_width_px_ * (0.3 + 0.7 * dab.pressure);
    x = dab.x - trail * (dab.dx + dab.tilt_x);
    y = dab.y - trail * (dab.dy + dab.tilt_y);
}

void Brush::reach_px(const Dab& dab, int& half_x, int& half_y) const {
    const double widening = 1 + settings_.splay * dab.pressure;
    const double a = widening * half_width_px_, b = widening * half_thickness_px_;
    const double c = std::abs(std::cos(dab.rotation_rad)), s = std::abs(std::sin(dab.rotation_rad));
    half_x = std::min(static_cast<int>(std::ceil(a * c + b * s)) + kMargin, half_);
    half_y = std::min(static_cast<int>(std::ceil(a * s + b * c)) + kMargin, half_);
}

double Brush::contact_length_px(const Dab& dab) const {
    if (coverage_ == 1) return resolved_length_px(dab);
    return length_along(dab, width_px_ / 2, thickness_px_ / 2);
}

double Brush::resolved_length_px(const Dab& dab) const {
    return length_along(dab, half_width_px_, half_thickness_px_);
}

void Brush::underside_mm(const Dab& dab, int x0, int y0, int width, int height, float* out,
                         std::vector<RowSpan>& spans) const {
    double cx, cy;
    contact_centre(dab, cx, cy);
    const float c = std::cos(dab.rotation_rad), s = std::sin(dab.rotation_rad);
    const float narrowing = 1 / (1 + static_cast<float>(settings_.splay) * dab.pressure);
    const float touched = kLightest + (1 - kLightest) * dab.pressure;
    const auto depth = static_cast<float>(settings_.depth_mm),
               groove = static_cast<float>(settings_.groove_mm);
    const float gap = static_cast<float>(settings_.gap_mm) * (1 - 0.7f * dab.pressure);
    // The leading edge is higher; tilt lifts the side that the handle leans away from.
    const float per_px = depth / static_cast<float>(half_width_px_);
    const float lift_x = per_px * (static_cast<float>(settings_.lift) * dab.dx - dab.tilt_x);
    const float lift_y = per_px * (static_cast<float>(settings_.lift) * dab.dy - dab.tilt_y);
    const TipMaps maps{dome_.data(), tip_.data(), 2 * texture_half_u_ + 1, 2 * texture_half_v_ + 1};
    UndersideRow row{};
    row.du = c * narrowing;
    row.dv = -s * narrowing;
    row.dlift_mm = lift_x;
    row.gap_mm = gap;
    row.groove_mm = groove;
    row.rise_mm = 2 * depth;
    row.touched = touched;
    const Outline outline{(half_width_px_ + 1) / narrowing, (half_thickness_px_ + 1) / narrowing, c, s,
                          settings_.shape == "round"};
    spans.resize(static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        const double py = y0 + y - cy;
        RowSpan& span = spans[static_cast<std::size_t>(y)];
        span = outline.across(py, x0 - cx, width);
        float* to = out + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
        if (span.end <= span.begin) {
            std::fill_n(to, width, kOutside);
            continue;
        }
        const RowSpan whole = widened(span, {0, width});
        const auto dx = static_cast<float>(x0 + whole.begin - cx), dy = static_cast<float>(py);
        row.u = (dx * c + dy * s) * narrowing + static_cast<float>(texture_half_u_);
        row.v = (dy * c - dx * s) * narrowing + static_cast<float>(texture_half_v_);
        row.lift_mm = dx * lift_x + dy * lift_y;
        underside_row(whole.end - whole.begin, maps, row, to + whole.begin);
        std::fill(to, to + span.begin, kOutside);
        std::fill(to + span.end, to + width, kOutside);
    }
}

}  // namespace tangi
