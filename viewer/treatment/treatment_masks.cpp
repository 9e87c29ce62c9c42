// treatment_masks.cpp: of the treatment: damage that is drawn.
#include <fmt/format.h>

#include <algorithm>

#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

using nlohmann::json;

namespace {

const char* name_of(MaskTool tool) {
    constexpr std::array<const char*, 4> names = {"brush", "polygon", "wand", "area"};
    return names[static_cast<std::size_t>(tool)];
}

}  // namespace

// That of the class that is drawn: begun with what the class has.
MaskDraft& TreatmentController::draft() {
    const DamageClass damage = state_.treatment_state.current;
    auto found = drafts_.find(damage);
    if (found == drafts_.end()) found = drafts_.emplace(damage, MaskDraft(treatment().mask(damage))).first;
    return found->second;
}

void TreatmentController::changed(const Region& region) {
    if (region.empty()) return;
    const DamageClass damage = state_.treatment_state.current;
    map_.set(damage, drafts_.at(damage).mask(), region);
    const Region r = map_.compose(style_, region);
    map_changed_ = map_changed_.empty()
                       ? r
                       : Region{std::min(r.x0, map_changed_.x0), std::min(r.y0, map_changed_.y0),
                                std::max(r.x1, map_changed_.x1), std::max(r.y1, map_changed_.y1)};
    count_edits();
}

void TreatmentController::count_edits() {
    TreatmentState& t = state_.treatment_state;
    t.edits = 0;
    for (const auto& [damage, draft] : drafts_) t.edits += draft.actions();
    const auto own = drafts_.find(t.current);
    t.can_redo = own != drafts_.end() && own->second.can_redo();
    if (drafts_.empty())
        for (DamageRow& row : t.damage) row.corrected.reset();
    else if (!last_)  // not at each place of a brush: a large map takes a while
        count_corrected();
}

void TreatmentController::touch(const MaskTouch& touch) {
    TreatmentState& t = state_.treatment_state;
    if (!t.usable) return;
    t.map = t.damage[static_cast<std::size_t>(t.current)].shown = true;  // else one would draw blindly
    t.additions = false;
    const MaskEdit edit = touch.erase ? MaskEdit::remove : MaskEdit::add;
    const double radius_px = 0.5 * static_cast<double>(t.brush_mm) / t.mm_per_pixel;
    switch (touch.kind) {
        case MaskTouch::Kind::press:
            if (last_) draft().end();
            draft().begin();
            last_ = touch.at;
            changed(draft().draw(touch.at, touch.at, radius_px, edit));
            break;
        case MaskTouch::Kind::drag:
            if (!last_) break;
            changed(draft().draw(*last_, touch.at, radius_px, edit));
            last_ = touch.at;
            break;
        case MaskTouch::Kind::release:
            if (!last_) break;
            draft().end();
            last_.reset();
            count_edits();
            break;
        case MaskTouch::Kind::polygon:
            polygon(touch.polygon, edit);
            break;
        case MaskTouch::Kind::wand:
            wand_at(touch);
            break;
        case MaskTouch::Kind::area: {
            MaskDraft& mask = draft();
            const Mask area = connected_at(mask.mask(), static_cast<int>(std::floor(touch.at.x)),
                                           static_cast<int>(std::floor(touch.at.y)));
            if (area.empty()) {
                setup_.say(fmt::format("nothing of '{}' lies there", title_of(t.current)));
                break;
            }
            mask.begin();
            const Region region = mask.combine(area, MaskEdit::remove);
            mask.end();
            changed(region);
            break;
        }
    }
}

void TreatmentController::polygon(const Polygon& corners, MaskEdit edit) {
    MaskDraft& mask = draft();
    Mask area;
    try {
        area = mask_of_polygons({corners}, mask.mask().width(), mask.mask().height());
    } catch (const Error& error) {
        setup_.say(error.what());
        return;
    }
    mask.begin();
    const Region region = mask.combine(area, edit);
    mask.end();
    if (region.empty()) setup_.say("the polygon encloses no pixel by half or more: nothing is drawn");
    changed(region);
}

void TreatmentController::wand_at(const MaskTouch& touch) {
    const TreatmentState& t = state_.treatment_state;
    const int x = static_cast<int>(touch.at.x), y = static_cast<int>(touch.at.y);
    const auto tolerance = static_cast<double>(t.tolerance[static_cast<std::size_t>(t.wand_by)]);
    start("the wand",
          [this, dry = painter_->dry(), x, y, by = t.wand_by, tolerance, erase = touch.erase,
           damage = t.current](const Progress&) -> Finish {
              Mask area = wand(*dry, x, y, by, tolerance);
              return [this, area = std::move(area), erase, damage] {
                  state_.treatment_state.current = damage;
                  MaskDraft& mask = draft();
                  mask.begin();
                  const Region region = mask.combine(area, erase ? MaskEdit::remove : MaskEdit::add);
                  mask.end();
                  changed(region);
              };
          });
}

// Of the class that is drawn, as the legend has it.
void TreatmentController::count_corrected() {
    const DamageClass damage = state_.treatment_state.current;
    DamageRow& row = *std::ranges::find(state_.treatment_state.damage, damage, &DamageRow::damage);
    const auto own = drafts_.find(damage);
    row.corrected.reset();
    if (own == drafts_.end() || !own->second.can_undo()) return;
    const MaskArea area = area_of(own->second.mask(), state_.treatment_state.mm_per_pixel);
    row.corrected = {area.regions, area.mm2 / 100, area.percent};
}

// Each class that was corrected is a step.
void TreatmentController::keep_edits() {
    const TreatmentState& t = state_.treatment_state;
    std::vector<std::pair<DamageClass, MaskDraft>> edited;
    for (const auto& [damage, draft] : drafts_) {
        if (!draft.can_undo()) continue;
        if (state_.painter.unsaved && t.where.contains(damage)) {
            setup_.say("first record what was painted there: Ctrl+S");
            return;
        }
        edited.emplace_back(damage, draft);
    }
    const std::string under_way =
        t.polygon.empty() ? ""
                          : "the polygon under way is not closed, and not part of it: Enter closes it, Esc "
                            "drops it";
    if (edited.empty() && !under_way.empty()) setup_.say("nothing is in the log yet: " + under_way);
    if (edited.empty()) return;
    start("entering the damage in the log",
          [this, under_way, edited = std::move(edited), who = author(), painter = painter_,
           tool = std::string(name_of(t.mask_tool))](const Progress& progress) -> Finish {
              {
                  const std::lock_guard lock(held_->mutex);
                  for (const auto& [damage, draft] : edited)
                      draw_step(held_->treatment,
                                {damage,
                                 draft.mask(),
                                 {{"edit", "by hand"}, {"edits", draft.actions()}, {"last_tool", tool}}},
                                who, progress);
              }
              Facts facts = facts_of(treatment(), canvas_of(*painter));
              return [this, under_way, facts = std::move(facts)]() mutable {
                  drafts_.clear();
                  count_edits();
                  adopt(std::move(facts));
                  setup_.say("the damage map is in the log" + (under_way.empty() ? "" : "; " + under_way));
              };
          });
}

void TreatmentController::keep_now() {
    if (!held_ || state_.treatment_state.edits == 0) return;
    try {
        const std::lock_guard lock(held_->mutex);
        while (!drafts_.empty()) {
            const auto& [damage, draft] = *drafts_.begin();
            if (draft.can_undo())
                draw_step(held_->treatment,
                          {damage, draft.mask(), {{"edit", "by hand"}, {"edits", draft.actions()}}},
                          author());
            drafts_.erase(drafts_.begin());
        }
    } catch (const Error& error) {
        setup_.say(error.what());
    }
    count_edits();
}

void TreatmentController::drop_edits() {
    last_.reset();
    for (const auto& [damage, draft] : std::exchange(drafts_, {})) map_.set(damage, treatment().mask(damage));
    map_changed_ = map_.compose(style_);
    count_edits();
}

}  // namespace tangi
