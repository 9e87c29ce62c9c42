// document_controller.h: what happens beside the painting in the window: another one being opened, a fit that
// runs, photographs held against it, the paintings opened last. No OpenGL.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "viewer/model/background_job.h"
#include "viewer/model/comparison.h"
#include "viewer/model/host_services.h"
#include "viewer/model/painter.h"
#include "viewer/model/window_state.h"

namespace tangi {

// A painting that is ready to be shown.
struct OpenedPainting {
    std::unique_ptr<Painter> painter;
    std::shared_ptr<TexelTiles> tiles;
    std::filesystem::path file;
    std::optional<Palette> palette{};  // that it is painted on with, where another one was chosen
    bool is_new = false;               // a canvas that was just begun
};

class DocumentController {
public:
    struct Setup {
        HostServices workshop;
        Palette palette;
        std::filesystem::path settings;  // folder; empty: nothing is remembered
        std::function<void()> wake;
        std::function<void(const std::string&)> say;
    };
    DocumentController(WindowState& state, Setup setup);

    // Tells what is shown from now on: photographs of another painting are put away; those of the same one,
    // such as its treatment, stay.
    void shows(const Painter& painter);

    // Does what was asked for, of what is its business.
    void take(const WindowState::Requests& ask, Painter& painter);
    // Looks what has become of it; changes the state. True where there may be something to be seen of it.
    bool look();
    // A painting that is to be shown now; once.
    std::optional<OpenedPainting> opened();

    // A file is being written beside the window (an export, a fit), which would be given up.
    bool writes() const { return job_ && writes_ && !job_->state().over; }

    void open(const std::filesystem::path& file);
    // `file`, which is not there, is a new canvas on this from now on: open() makes it.
    void make(const std::filesystem::path& file, const SubstrateChoice& choice);
    // What is opened from now on is painted on with this paint box.
    void use_palette(Palette palette);
    void remember(const std::filesystem::path& file);  // as one that was opened last
    void hold_photos(const std::filesystem::path& folder, const Painter& painter);

private:
    void fit(const std::filesystem::path& chosen);
    void step(int by);
    void turn_to(int index);
    void put_photos_away();
    void write_as(const ExportFormat& format, const std::filesystem::path& out, Painter& painter);
    bool start(std::string title, std::function<void(const Progress&)> work);

    WindowState& state_;
    Setup setup_;
    bool other_palette_ = false;
    std::optional<std::pair<std::filesystem::path, SubstrateChoice>> new_canvas_;
    std::optional<OpenedPainting> opened_;  // by the job, while it runs; ours once it is over
    std::optional<std::pair<std::filesystem::path, std::string>> written_;  // the same; what is to be said
    bool writes_ = false;
    bool fits_ = false;  // the job does: what it writes is opened
    std::unique_ptr<Job> job_;
    std::unique_ptr<Comparison> comparison_;
    std::future<void> put_away_;        // one that still measures a photograph that nobody wants any more
    std::vector<std::string> held_of_;  // the painting that they are of
    std::optional<Region> measured_;
    bool worked_ = false;
    int lit_ = -1;  // the photograph at whose light the painting is lit
};

}  // namespace tangi
