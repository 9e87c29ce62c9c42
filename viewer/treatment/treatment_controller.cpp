#include "viewer/treatment/treatment_controller.h"

#include <fmt/format.h>

#include <algorithm>

#include "retouch/treatment/confining_mask.h"
#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr const char* kRecovery = "sitting.json";
constexpr std::chrono::milliseconds kBetweenLooks(500);  // whether the folder is there

json recovery_of(const TreatmentState& t) {
    json classes = json::array();
    for (const DamageClass damage : t.where) classes.push_back(name_of(damage));
    return {{"retouched", classes}, {"confined", t.confined}, {"feather_mm", t.feather_mm}};
}

// What was painted on at the last sitting; what cannot be read counts as nothing.
void read_recovery(const fs::path& folder, TreatmentState& t) {
    if (!fs::exists(folder / kRecovery)) return;
    const json recovery = json_or_discarded(read_text_file(folder / kRecovery));
    if (!recovery.is_object()) return;
    if (const auto classes = recovery.find("retouched"); classes != recovery.end() && classes->is_array()) {
        t.where.clear();
        for (const json& name : *classes)
            if (name.is_string())
                if (const auto damage = damage_class_named(name.is_string() ? name.get<std::string>() : ""))
                    t.where.insert(*damage);
    }
    if (const auto it = recovery.find("confined"); it != recovery.end() && it->is_boolean())
        t.confined = it->get<bool>();
    if (const auto it = recovery.find("feather_mm"); it != recovery.end() && it->is_number())
        t.feather_mm = std::clamp(it->get<float>(), 0.0f, 100.0f);
}

}  // namespace

std::optional<fs::path> treatment_of(const fs::path& painting) {
    if (painting.filename() != "painting.exr") return {};
    const fs::path folder = fs::absolute(painting).parent_path();
    if (!fs::is_regular_file(folder / "log.jsonl")) return {};
    return folder;
}

std::optional<double> treatment_scale(const fs::path& painting) {
    const auto folder = treatment_of(painting);
    if (!folder) return {};
    const Treatment treatment = Treatment::open(*folder);
    if (!treatment.scale_known()) return {};
    return treatment.mm_per_pixel();
}

TreatmentController::TreatmentController(WindowState& state, Setup setup)
    : state_(state), setup_(std::move(setup)) {
    setup_.say = [say = std::move(setup_.say)](const std::string& text) { say(in_panel_words(text)); };
    read_pairs();
}

TreatmentController::~TreatmentController() { leave(); }

Treatment TreatmentController::treatment() const {
    const std::lock_guard lock(held_->mutex);
    return held_->treatment;
}

Canvas TreatmentController::canvas_of(Painter& painter) {
    std::optional<Canvas> canvas;
    painter.look([&](const Surface&, const Canvas& now) { canvas = now; }).get();
    return std::move(*canvas);
}

bool TreatmentController::start(std::string title, Work work, bool ours) {
    if (job_) {
        setup_.say(fmt::format("first stop, or wait for: {}", job_->title()));
        return false;
    }
    finish_ = {};
    job_is_ours_ = ours;
    job_ = std::make_unique<Job>(
        std::move(title), [this, work = std::move(work)](const Progress& p) { finish_ = work(p); },
        setup_.wake);
    return true;
}

void TreatmentController::leave() {
    job_.reset();
    finish_ = {};
    if (painter_ && held_) {
        painter_->keep_by({});
        painter_->confine({}, {});
        painter_->show_as({});
    }
    painter_ = nullptr;
    held_.reset();
    drafts_.clear();
    last_.reset();
    suggested_.reset();
    preview_.reset();
    state_shown_.reset();
    gone_ = false;
    confined_by_.clear();
    refresh_due_ = confine_due_ = false;
    TreatmentState blank;
    blank.who = std::move(state_.treatment_state.who);
    blank.usual_who = setup_.author.who;
    blank.pairs = *pairs_;
    state_.treatment_state = std::move(blank);
    for (DamageRow& row : state_.treatment_state.damage)
        row.damage = kDamageClasses[static_cast<std::size_t>(&row - state_.treatment_state.damage.data())];
}

void TreatmentController::shows(Painter& painter) {
    leave();
    painter_ = &painter;
    if (const auto folder = treatment_of(painter.file())) open(*folder);
}

void TreatmentController::open(const fs::path& folder) {
    TreatmentState& t = state_.treatment_state;
    try {
        held_ = std::shared_ptr<Held>(new Held{{}, Treatment::open(folder)});
        read_recovery(folder, t);
    } catch (const Error& error) {
        setup_.say(error.what());
        held_.reset();
        return;
    }
    const Treatment& treatment = held_->treatment;
    painting_ = painter_->file();
    t.on = t.checking = true;
    t.folder = folder.string();
    t.dry_sha256 = treatment.dry_sha256();
    t.mm_per_pixel = treatment.mm_per_pixel();
    t.scale_known = treatment.scale_known();
    state_.scale_known = state_.scale_known || t.scale_known;
    // As fine as its pixels, and no finer.
    t.retouch.pitch_mm = std::max(t.retouch.pitch_mm, 2 * t.mm_per_pixel);
    t.retouch.width_mm = std::max(t.retouch.width_mm, t.mm_per_pixel);
    t.brush_mm = std::max(t.brush_mm, static_cast<float>(3 * t.mm_per_pixel));
    map_ = DamageMap(treatment.width(), treatment.height());
    map_changed_ = map_.picture().region();
    for (const std::string& warning : treatment.log().warnings()) setup_.say(warning);
    painter_->keep_by([held = held_, keeping = keeping_](Canvas& canvas, const Painter::ToKeep& recovery) {
        return kept(*held, *keeping, canvas, recovery);
    });
    check();
}

// Everything that the log says is compared with what there is; only then one may work on it.
void TreatmentController::check() {
    TreatmentState& t = state_.treatment_state;
    const bool started = start(
        "checking the treatment",
        [this, painter = painter_](const Progress& progress) -> Finish {
            const Treatment now = treatment();
            std::vector<std::string> faults = now.check(progress);
            Facts facts;
            if (faults.empty()) facts = facts_of(now, canvas_of(*painter));
            return [this, faults = std::move(faults), facts = std::move(facts)]() mutable {
                TreatmentState& all = state_.treatment_state;
                all.checking = false;
                all.usable = faults.empty();
                all.faults = std::move(faults);
                if (!all.usable) {
                    setup_.say(all.faults.front());
                    return;
                }
                adopt(std::move(facts));
            };
        },
        true);
    if (started) t.checking = true;
}

// The painter's brushes stop at the damage that is retouched.
void TreatmentController::confine() {
    const TreatmentState& t = state_.treatment_state;
    const json recovery = recovery_of(t);
    const bool started = start(
        "making the mask ready",
        [this, painter = painter_, where = t.where, confined = t.confined, feather_mm = t.feather_mm,
         recovery](const Progress&) -> Finish {
            const Treatment now = treatment();
            StepArea area = area_of_classes(now, where);
            const auto allowed = std::make_shared<const Mask>(area.mask);
            const double feather_px = static_cast<double>(feather_mm) / now.mm_per_pixel();
            Painter::Stops stops;
            if (confined) {
                ConfiningMask mask =
                    confining_mask(now.folder(), feather_px > 0 ? feathered(*allowed, feather_px) : *allowed);
                stops = {mask.mask, mask.name, std::move(mask.png)};
            }
            painter->confine(std::move(stops), allowed);
            {
                const std::lock_guard lock(keeping_->mutex);
                keeping_->area = std::move(area);
                keeping_->feather_mm = static_cast<double>(feather_mm);
            }
            write_text_file(now.folder() / kRecovery, json_lines(recovery));
            return {};
        },
        true);
    if (!started) return;
    confine_due_ = false;
    confined_by_ = json_line(recovery);
}

// On the painter's thread, in place of saving.
Painter::Kept TreatmentController::kept(Held& held, Keeping& keeping, Canvas& canvas,
                                        const Painter::ToKeep& recovery) {
    StepArea area;
    Author who;
    double feather_mm = 0;
    {
        const std::lock_guard lock(keeping.mutex);
        area = keeping.area;
        who = keeping.author;
        feather_mm = keeping.feather_mm;
    }
    const std::lock_guard lock(held.mutex);
    Treatment& treatment = held.treatment;
    if (canvas.wet().empty() && canvas.dried().size() == treatment.layers().size())
        return {"nothing was painted that is not in the log", false};
    if (area.mask.empty()) area = area_of_classes(treatment, {});
    TreatmentStep step{.action = "retouch", .parameters = {{"feather_mm", feather_mm}}};
    if (!recovery.journal.empty()) {
        step.strokes = {recovery.journal, recovery.masks, recovery.tools};
        if (fs::exists(recovery.unsaved)) step.withdrawn.push_back(recovery.unsaved.filename().string());
    }
    const json result =
        retouch_step(treatment, canvas, {area, std::move(step), treatment.painting().string()}, who);
    keeping.done = true;
    const json& last = result["retouches"].back();
    return {fmt::format("in the log: {}, {}, {} pixels on original", last["layer"].get<std::string>(),
                        area_in_words(last), last["on_original"]["pixels"].get<int>())};
}

// What the job that ran to its end leaves.
void TreatmentController::finish_job() {
    TreatmentState& t = state_.treatment_state;
    t.job = job_->state();
    t.job_title = job_->title();
    if (!t.job->over) return;
    const Job::State end = *t.job;
    const std::string title = job_->title();
    job_.reset();  // its thread is done: what it made is ours
    t.job.reset();
    if (end.cancelled) setup_.say("stopped: " + title);
    if (!end.error.empty()) setup_.say(end.error);
    if (end.cancelled || !end.error.empty()) t.checking = false;
    if (const Finish finish = std::exchange(finish_, {})) finish();
}

// What was logged is read, and the brushes stop where the settings say, as soon as nothing else runs.
void TreatmentController::keep_up() {
    const TreatmentState& t = state_.treatment_state;
    refresh_due_ |= keeping_->done.exchange(false);
    {
        const std::lock_guard lock(keeping_->mutex);
        keeping_->author = author();
    }
    if (!t.usable || job_) return;
    if (json_line(recovery_of(t)) != confined_by_) confine_due_ = true;
    if (refresh_due_)
        refresh();
    else if (confine_due_)
        confine();
}

void TreatmentController::look_for_folder() {
    const auto now = std::chrono::steady_clock::now();
    if (now - looked_ < kBetweenLooks) return;
    looked_ = now;
    gone_ = treatment_of(painting_) != fs::path(state_.treatment_state.folder);
}

void TreatmentController::compose_map() {
    const TreatmentState& t = state_.treatment_state;
    DamageMap::Style style{{}, t.style, t.additions};
    for (std::size_t i = 0; i < t.damage.size(); ++i) style.shown[i] = t.damage[i].shown;
    if (style == style_) return;
    style_ = style;
    map_changed_ = map_.compose(style_);
}

bool TreatmentController::look() {
    TreatmentState& t = state_.treatment_state;
    if (!painter_) return false;
    const bool worked = job_ != nullptr;
    if (job_) finish_job();
    if (!held_) return worked;
    if (painting_ != painter_->file()) {
        Painter* painter = painter_;
        setup_.say("saved as a painting of its own: the treatment stays as it was");
        shows(*painter);  // it was saved under another name
        return true;
    }
    keep_up();
    look_for_folder();
    t.no_strokes = no_strokes();
    compose_map();
    find_stale();
    if (t.suggestion && t.suggestion->threshold != threshold_) show_suggestion();
    if (t.state != state_shown_) show_state();
    return worked || !map_changed_.empty();
}

}  // namespace tangi
