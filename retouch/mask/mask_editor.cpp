#include "retouch/mask/mask_editor.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"
#include "surface/image/colour.h"

namespace tangi {

namespace {

Region joined(const Region& a, const Region& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

}  // namespace

Region MaskDraft::tile_region(const std::pair<int, int>& at) const {
    return {at.first * kTile, at.second * kTile, std::min((at.first + 1) * kTile, mask_.width()),
            std::min((at.second + 1) * kTile, mask_.height())};
}

MaskDraft::Values MaskDraft::values(const std::pair<int, int>& at) const {
    const Region r = tile_region(at);
    Values values;
    for (int y = r.y0; y < r.y1; ++y) {
        const auto row = mask_.row(y);
        values.insert(values.end(), row.begin() + r.x0, row.begin() + r.x1);
    }
    return values;
}

void MaskDraft::begin() {
    TP_REQUIRE(!open_, "an action ends before the next one begins");
    actions_.resize(done_);
    actions_.emplace_back();
    open_ = true;
}

void MaskDraft::end() {
    TP_REQUIRE(open_, "an action that ends has begun");
    open_ = false;
    Action& action = actions_.back();
    std::erase_if(action.before, [&](const auto& tile) { return values(tile.first) == tile.second; });
    for (const auto& [at, before] : action.before) action.after[at] = values(at);
    if (action.before.empty())
        actions_.pop_back();  // nothing changed
    else
        done_ = actions_.size();
}

void MaskDraft::remember(const Region& region) {
    TP_REQUIRE(open_, "a mask changes within an action");
    if (region.empty()) return;
    for (int y = region.y0 / kTile; y <= (region.y1 - 1) / kTile; ++y)
        for (int x = region.x0 / kTile; x <= (region.x1 - 1) / kTile; ++x)
            if (const std::pair at(x, y); !actions_.back().before.contains(at))
                actions_.back().before.emplace(at, values(at));
}

Region MaskDraft::draw(const Corner& from, const Corner& to, double radius_px, MaskEdit edit) {
    const double reach = radius_px + 1;
    const auto bound = [](double v, int size) { return static_cast<int>(std::clamp<double>(v, 0, size)); };
    const Region r{bound(std::floor(std::min(from.x, to.x) - reach), mask_.width()),
                   bound(std::floor(std::min(from.y, to.y) - reach), mask_.height()),
                   bound(std::ceil(std::max(from.x, to.x) + reach), mask_.width()),
                   bound(std::ceil(std::max(from.y, to.y) + reach), mask_.height())};
    if (r.empty()) return {};
    remember(r);
    const double dx = to.x - from.x, dy = to.y - from.y, length2 = dx * dx + dy * dy;
    for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
            const double px = x + 0.5 - from.x, py = y + 0.5 - from.y;
            const double t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0;
            if (std::hypot(px - t * dx, py - t * dy) <= radius_px)
                mask_(x, y) = edit == MaskEdit::add ? 1.0f : 0.0f;
        }
    return r;
}

Region MaskDraft::combine(const Mask& area, MaskEdit edit) {
    TP_REQUIRE(area.region() == mask_.region(), "masks have the painting's size");
    Region touched;
    for (int y = 0; y < area.height(); ++y)
        for (int x = 0; x < area.width(); ++x)
            if (area(x, y) >= 0.5f) touched = joined(touched, {x, y, x + 1, y + 1});
    remember(touched);
    for (int y = touched.y0; y < touched.y1; ++y)
        for (int x = touched.x0; x < touched.x1; ++x)
            if (area(x, y) >= 0.5f) mask_(x, y) = edit == MaskEdit::add ? 1.0f : 0.0f;
    return touched;
}

Region MaskDraft::put(const Tiles& tiles) {
    Region touched;
    for (const auto& [at, values] : tiles) {
        const Region r = tile_region(at);
        auto value = values.begin();
        for (int y = r.y0; y < r.y1; ++y, value += r.width())
            std::copy(value, value + r.width(), mask_.row(y).begin() + r.x0);
        touched = joined(touched, r);
    }
    return touched;
}

Region MaskDraft::undo() {
    TP_REQUIRE(!open_ && can_undo(), "there is something to undo");
    return put(actions_[--done_].before);
}

Region MaskDraft::redo() {
    TP_REQUIRE(!open_ && can_redo(), "there is something to redo");
    return put(actions_[done_++].after);
}

Mask wand(const Surface& s, int x, int y, WandBy by, double tolerance) {
    if (x < 0 || y < 0 || x >= s.width() || y >= s.height())
        fail("the pixel ({}, {}) is not in the picture, which has {} x {}", x, y, s.width(), s.height());
    const auto lab_at = [&](int px, int py) {
        return lab_from_linear(glm::dvec3(glm::max(s.diffuse(px, py), Rgb(0))));
    };
    const Lab own = lab_at(x, y);
    const auto log_of = [](float v) { return std::log(std::max(static_cast<double>(v), 1e-4)); };
    const auto difference = [&](int px, int py) {
        if (by == WandBy::colour) {
            const Lab there = lab_at(px, py);
            return std::hypot(there.l - own.l, there.a - own.a, there.b - own.b);
        }
        if (by == WandBy::height)
            return static_cast<double>(std::abs(s.height_mm(px, py) - s.height_mm(x, y)));
        return std::abs(log_of(s.roughness(px, py)) - log_of(s.roughness(x, y))) +
               0.5 * std::abs(log_of(s.specular(px, py)) - log_of(s.specular(x, y)));
    };
    Mask mask(s.width(), s.height());
    std::vector<std::pair<int, int>> open = {{x, y}};
    mask(x, y) = 1;
    while (!open.empty()) {
        const auto [px, py] = open.back();
        open.pop_back();
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const int nx = px + dx, ny = py + dy;
            if (nx < 0 || ny < 0 || nx >= s.width() || ny >= s.height() || mask(nx, ny) > 0) continue;
            if (difference(nx, ny) > tolerance) continue;
            mask(nx, ny) = 1;
            open.emplace_back(nx, ny);
        }
    }
    return mask;
}

}  // namespace tangi
