#include "viewer/desk.h"

#include <fmt/format.h>

#include "paint/canvas_file.h"
#include "surface/error.h"
#include "viewer/settings.h"
#include "viewer/treatment_desk.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Where the painting fitted to a folder of photographs is written: beside it, under a name that is free.
fs::path place_for_fit(const fs::path& folder) {
    const fs::path plain = folder.has_filename() ? folder : folder.parent_path();
    for (int i = 1;; ++i) {
        fs::path path = plain;
        path += i == 1 ? ".exr" : fmt::format("-{}.exr", i);
        if (!fs::exists(path)) return path;
    }
}

}  // namespace

Desk::Desk(WindowState& state, Setup setup) : state_(state), setup_(std::move(setup)) {
    state_.recent = recent_paintings(setup_.settings);
}

// Looking does not wait for the photograph that is being measured.
void Desk::put_photos_away() {
    state_.comparing = {};
    lit_ = -1;
    if (comparison_) put_away_ = std::async(std::launch::async, [old = std::move(comparison_)] {});
}

void Desk::shows(const Painter& painter) {
    put_photos_away();
    measured_.reset();
    if (fs::exists(painter.file())) remember(painter.file());
}

void Desk::remember(const fs::path& file) {
    try {
        remember_painting(setup_.settings, file);
    } catch (const Error& error) {
        setup_.say(error.what());  // one can paint all the same
    }
    state_.recent = recent_paintings(setup_.settings);
}

void Desk::start(std::string title, std::function<void(const Progress&)> work) {
    if (job_ && !job_->state().over) {
        setup_.say(fmt::format("first stop, or wait for: {}", job_->title()));
        return;
    }
    job_ = std::make_unique<Job>(std::move(title), std::move(work), setup_.wake);
}

void Desk::open(const fs::path& file) {
    const std::optional<Palette> other = other_palette_ ? std::optional(setup_.palette) : std::nullopt;
    start("opening " + file.filename().string(),
          [this, file, other, palette = setup_.palette](const Progress& progress) {
              OpenedPainting opened;
              opened.palette = other;
              Painter::Setup setup{read_canvas(file, progress, treatment_scale(file)), palette, file, false};
              opened.painter = std::make_unique<Painter>(std::move(setup), setup_.wake, progress);
              opened.tiles = std::make_shared<TexelTiles>(opened.painter->surface(), opened.painter->range());
              opened.file = file;
              opened_ = std::move(opened);
          });
}

void Desk::use_palette(Palette palette) {
    setup_.palette = std::move(palette);
    other_palette_ = true;
}

void Desk::fit(const fs::path& chosen) {
    const fs::path folder = fs::is_regular_file(chosen) ? fs::absolute(chosen).parent_path() : chosen;
    const fs::path out = place_for_fit(folder);
    start(fmt::format("fitting {}", folder.filename().string()),
          [this, chosen, out](const Progress& progress) {
              std::string said = setup_.workshop.fit(chosen, out, progress);
              fitted_ = {out, std::move(said)};
          });
}

void Desk::hold_photos(const fs::path& folder, const Painter& painter) {
    put_photos_away();
    state_.comparing.loaded = state_.comparing.on = true;
    state_.comparing.folder = folder.string();
    comparison_ = std::make_unique<Comparison>(
        folder.string(),
        [this, folder, dry = painter.dry(), file = painter.file()](const Progress& progress) {
            return setup_.workshop.open_photos(folder, dry, file, progress);
        },
        setup_.wake);
    comparison_->measure(measured_);
}

void Desk::turn_to(int index) {
    state_.comparing.news.wanted = index;
    comparison_->want(index);
}

// Past photographs that cannot be read.
void Desk::step(int by) {
    const Comparison::News& news = state_.comparing.news;
    if (!news.book || news.book->entries().empty()) return;
    const int count = static_cast<int>(news.book->entries().size());
    int index = news.wanted;
    for (int i = 0; i < count; ++i) {
        index = (index + by + count) % count;
        if (!news.broken.contains(index)) break;
    }
    turn_to(index);
}

void Desk::take(const WindowState::Requests& ask, const Painter& painter) {
    if (ask.stop_job && job_) job_->stop();
    if (!ask.fit_folder.empty() && setup_.workshop.fit) fit(ask.fit_folder);
    if (!ask.photos.empty() && setup_.workshop.open_photos) hold_photos(ask.photos, painter);
    if (!comparison_) return;
    if (ask.put_photos_away) {
        put_photos_away();
        return;
    }
    if (ask.photo) turn_to(*ask.photo);
    if (ask.step_photo != 0) step(ask.step_photo);
    if (!ask.report.empty()) comparison_->write_report(ask.report);
    if (ask.stop_report) comparison_->stop_report();
    if (measured_ != state_.region) {
        measured_ = state_.region;
        comparison_->measure(measured_);
    }
}

bool Desk::look() {
    const bool worked = std::exchange(worked_, job_ || (comparison_ && state_.comparing.news.working));
    if (job_) {
        const Job::State job = job_->state();
        state_.job = job;
        state_.job_title = job_->title();
        if (job.over) {
            if (!job.error.empty()) setup_.say(job.error);
            if (job.cancelled) setup_.say("stopped: " + job_->title());
            job_.reset();  // its thread is done: what it made is ours
            state_.job.reset();
            if (fitted_) {
                setup_.say(fmt::format("wrote {}{}", fitted_->first.string(),
                                       fitted_->second.empty() ? "" : "; " + fitted_->second));
                state_.ask.open = fitted_->first;
                fitted_.reset();
            }
        }
    }
    if (!comparison_) return worked;
    Comparison::News news = comparison_->fetch();
    for (const std::string& message : news.messages) setup_.say(message);
    if (news.failed) {
        put_photos_away();
        return true;
    }
    state_.comparing.news = std::move(news);
    const Comparison::News& now = state_.comparing.news;
    if (now.book && now.broken.contains(now.wanted) && now.broken.size() < now.book->entries().size())
        step(1);
    // Until the photograph is there, the painting is shown as its lamp lights it; afterwards it stays so.
    if (now.book && lit_ != now.wanted && !now.book->entries().empty()) {
        lit_ = now.wanted;
        const Light& light = now.book->entries()[static_cast<std::size_t>(lit_)].light;
        state_.lamps[state_.lamp].angles = angles_of(light.direction);
        state_.sweeping = false;
    }
    return worked || now.working;
}

std::optional<OpenedPainting> Desk::opened() {
    if (job_) return {};
    return std::exchange(opened_, std::nullopt);
}

}  // namespace tangi
