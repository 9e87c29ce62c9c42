#include "viewer/app/document_controller.h"

#include <fmt/format.h>

#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "surface/file/output_set.h"
#include "surface/painting_file/painting_tiles.h"
#include "viewer/model/user_settings.h"
#include "viewer/treatment/treatment_controller.h"

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

// What tells one painting from another by what it was fitted to.
std::vector<std::string> photographs_of(const Painter& painter) {
    const Surface& dry = *painter.dry();
    std::vector<std::string> names = {fmt::format("{} x {}", dry.width(), dry.height())};
    for (const Photography::Photo& photo : dry.photography.photos) {
        const Vec3& d = photo.light.direction;
        names.push_back(fmt::format("{} {} {} {}", photo.light.name, d.x, d.y, d.z));
    }
    return names;
}

}  // namespace

DocumentController::DocumentController(WindowState& state, Setup setup)
    : state_(state), setup_(std::move(setup)) {
    state_.recent = recent_paintings(setup_.settings);
    state_.exports = setup_.workshop.exports;
    state_.lights_endings = setup_.workshop.lights_endings;
}

// Looking does not wait for the photograph that is being measured.
void DocumentController::put_photos_away() {
    state_.comparing = {};
    lit_ = -1;
    if (comparison_) put_away_ = std::async(std::launch::async, [old = std::move(comparison_)] {});
}

void DocumentController::shows(const Painter& painter) {
    const Comparing before = state_.comparing;
    put_photos_away();
    measured_.reset();
    if (before.loaded && photographs_of(painter) == held_of_) {  // the same painting, or its treatment
        hold_photos(before.folder, painter);
        state_.comparing.on = false;  // who begins a treatment wants to see it, and to draw on it
        state_.comparing.way = before.way;
        state_.comparing.divider = before.divider;
        turn_to(before.news.wanted);
    }
    std::error_code unknown;
    if (fs::exists(painter.file(), unknown)) remember(painter.file());
}

void DocumentController::remember(const fs::path& file) {
    try {
        remember_painting(setup_.settings, file);
    } catch (const std::exception& error) {
        setup_.say(message_of(error));  // one can paint all the same
    }
    state_.recent = recent_paintings(setup_.settings);
}

bool DocumentController::start(std::string title, std::function<void(const Progress&)> work) {
    if (job_) {
        setup_.say(fmt::format("first stop, or wait for: {}", job_->title()));
        return false;
    }
    job_ = std::make_unique<Job>(std::move(title), std::move(work), setup_.wake);
    return true;
}

void DocumentController::open(const fs::path& file) {
    const std::optional<Palette> other = other_palette_ ? std::optional(setup_.palette) : std::nullopt;
    std::optional<SubstrateChoice> ground;
    std::error_code unknown;
    if (new_canvas_ && new_canvas_->first == file && !fs::exists(file, unknown)) ground = new_canvas_->second;
    start((ground ? "making " : "opening ") + file.filename().string(),
          [this, file, other, ground, palette = setup_.palette](const Progress& progress) {
              settle_outputs_at(file);  // a command that was stopped may have been putting it in place
              OpenedPainting opened;
              opened.palette = other;
              opened.is_new = ground.has_value();
              const auto stamp = stamp_of(main_file_of(file));
              Canvas canvas = ground ? Canvas(std::make_shared<Surface>(make_substrate(*ground, progress)))
                                     : read_canvas(file, progress, treatment_scale(file));
              Painter::Setup setup{std::move(canvas), palette, file, ground.has_value(), stamp};
              opened.painter = std::make_unique<Painter>(std::move(setup), setup_.wake, progress);
              opened.tiles = std::make_shared<TexelTiles>(opened.painter->surface(), opened.painter->range());
              opened.file = file;
              opened_ = std::move(opened);
          });
}

void DocumentController::make(const fs::path& file, const SubstrateChoice& choice) {
    new_canvas_ = {file, choice};
}

void DocumentController::use_palette(Palette palette) {
    setup_.palette = std::move(palette);
    other_palette_ = true;
}

void DocumentController::fit(const fs::path& chosen) {
    const fs::path folder = fs::is_regular_file(chosen) ? fs::absolute(chosen).parent_path() : chosen;
    const fs::path out = place_for_fit(folder);
    const bool started = start(fmt::format("fitting {}", folder.filename().string()),
                               [this, chosen, out](const Progress& progress) {
                                   std::string said = setup_.workshop.fit(chosen, out, progress);
                                   written_ = {out, std::move(said)};
                               });
    if (started) fits_ = writes_ = true;
}

// With what is on the canvas at this moment.
void DocumentController::write_as(const ExportFormat& format, const fs::path& out, Painter& painter) {
    struct Now {
        std::optional<Canvas> canvas;
        std::vector<PartToWrite> tools;
    };
    const nlohmann::json annotations = json_of(state_.annotations.items);
    auto now = std::make_shared<Now>();
    // The painter may be gone before the job runs; it does first what it was asked for.
    std::shared_future<void> looked = painter
                                          .look_at_session([now](const Session& session) {
                                              now->canvas.emplace(session.canvas());
                                              now->tools = tools_of(session);
                                          })
                                          .share();
    const bool started = start("exporting " + out.filename().string(),
                               [this, name = std::string(format.format), out, now, looked, annotations,
                                file = painter.file()](const Progress& progress) {
                                   looked.get();
                                   std::string said = setup_.workshop.export_canvas(
                                       {*now->canvas, now->tools, annotations, file}, name, out, progress);
                                   written_ = {out, in_panel_words(said)};
                               });
    if (started) writes_ = true;
}

void DocumentController::hold_photos(const fs::path& folder, const Painter& painter) {
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
    held_of_ = photographs_of(painter);
}

void DocumentController::turn_to(int index) {
    state_.comparing.news.wanted = index;
    comparison_->want(index);
}

// Past photographs that cannot be read.
void DocumentController::step(int by) {
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

void DocumentController::take(const WindowState::Requests& ask, Painter& painter) {
    if (ask.stop_job && job_) job_->stop();
    if (!ask.fit_folder.empty() && setup_.workshop.fit) fit(ask.fit_folder);
    if (!ask.export_to.empty() && setup_.workshop.export_canvas)
        write_as(*ask.format, ask.export_to, painter);
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

bool DocumentController::look() {
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
            if (written_) {
                setup_.say(fmt::format("wrote {}{}", written_->first.string(),
                                       written_->second.empty() ? "" : "; " + written_->second));
                if (std::exchange(fits_, false)) state_.ask.open = written_->first;
                written_.reset();
            }
            fits_ = writes_ = false;
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
    // Until the photograph is there, the painting is shown as its light lights it; afterwards it stays so.
    if (now.book && lit_ != now.wanted && !now.book->entries().empty()) {
        lit_ = now.wanted;
        const Light& light = now.book->entries()[static_cast<std::size_t>(lit_)].light;
        state_.lights[state_.light].angles = angles_of(light.direction);
        state_.sweeping = false;
    }
    return worked || now.working;
}

std::optional<OpenedPainting> DocumentController::opened() {
    if (job_) return {};
    return std::exchange(opened_, std::nullopt);
}

}  // namespace tangi
