// column.cpp: the column of panels at the window's left, and File, Tools and Canvas.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

constexpr float kWideMessage = 400;  // [pixels] beside a button

constexpr const char* kNotTilted =
    "Photographs were taken from straight ahead: nothing is tilted beside them";

void recent(WindowState& s) {
    // There from the start: what comes later would push away what is about to be clicked.
    if (!ImGui::BeginCombo("Recent", "open again")) return;
    for (const std::filesystem::path& painting : s.recent) {
        if (ImGui::Selectable(painting.filename().string().c_str())) s.ask.open = painting;
        tip(painting.string());
    }
    ImGui::EndCombo();
}

void job(WindowState& s) {
    if (!s.job) return;
    ImGui::TextUnformatted(s.job_title.c_str());
    ImGui::ProgressBar(static_cast<float>(s.job->fraction), {-60 * s.scale, 0}, s.job->stage.c_str());
    ImGui::SameLine();
    if (s.job->stopping)
        ImGui::TextDisabled("stops");
    else if (ImGui::Button("Stop"))
        s.ask.stop_job = true;
}

void film(WindowState& s) {
    if (!s.film) return;
    ImGui::TextUnformatted("Film of the sweep");
    ImGui::ProgressBar(static_cast<float>(s.film->fraction), {-60 * s.scale, 0});
    ImGui::SameLine();
    if (ImGui::Button("Stop##film")) s.ask.stop_film = true;
}

// A folder that was dropped on the window.
void dropped(WindowState& s) {
    if (s.dropped.empty()) return;
    ImGui::TextColored({1, 0.8f, 0.3f, 1}, "Photographs in %s:", s.dropped.filename().string().c_str());
    bool done = false;
    if (s.from_photographs && ImGui::Button("Compare")) {
        s.ask.photos = s.dropped;
        done = true;
    }
    if (s.from_photographs) ImGui::SameLine();
    if (ImGui::Button("Fit a painting (Enter)")) {
        s.ask.fit_folder = s.dropped;
        done = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("Nothing (Esc)")) done = true;
    if (done) s.dropped.clear();
}

// Strokes that a crash left. Where another painting was put in the place of theirs, Enter does nothing to it.
void left_over(WindowState& s) {
    const bool of_another = s.left_over_of_another;
    ImGui::TextColored({1, 0.8f, 0.3f, 1}, "%s",
                       of_another ? "Strokes of another painting lie here." : "Recover unsaved work?");
    const std::string strokes =
        fmt::format("{} stroke{}", s.left_over_strokes, s.left_over_strokes == 1 ? "" : "s");
    if (of_another) {
        if (ImGui::Button("Discard (Enter)")) s.ask.discard = true;
        tip("They are kept in a file beside the painting. To have them on their own painting, put that back "
            "in its place and open it");
        ImGui::SameLine();
        if (ImGui::Button(fmt::format("Paint {} on this", strokes).c_str())) s.ask.recover = true;
        return;
    }
    if (ImGui::Button(fmt::format("Recover {} (Enter)", strokes).c_str())) s.ask.recover = true;
    ImGui::SameLine();
    if (ImGui::Button("Discard")) s.ask.discard = true;
}

// What is asked before strokes or files may be lost.
void questions(WindowState& s) {
    if (s.left_over_strokes > 0) {
        left_over(s);
    }
    if (s.finishing) {
        ImGui::TextColored({1, 0.8f, 0.3f, 1}, "%s",
                           s.painter.saving ? "Saving." : "Strokes are still being painted.");
        const double done = static_cast<double>(s.finishing->all - s.finishing->left);
        ImGui::ProgressBar(static_cast<float>(done / static_cast<double>(s.finishing->all)), {-1, 0},
                           fmt::format("{} left", s.finishing->left).c_str());
        if (ImGui::Button("Close now")) s.ask.close_now = true;
        tip("Nothing is saved. Strokes stay in the journal: next time they can be recovered");
        ImGui::SameLine();
        if (ImGui::Button("Go on painting (Esc)")) s.ask.stay = true;
    }
    if (s.closing && !s.finishing) {
        if (s.painter.unsaved) note("There are strokes that are not saved.", 1, kWarning);
        if (s.treatment_state.edits > 0)
            note("The damage map was corrected, and is not in the log: closed so, the corrections are lost.",
                 3, kWarning);
        if (s.annotations.unsaved) note("There are annotations that are not saved.", 1, kWarning);
        if (s.film)
            note("A film is still being written.", 1, kWarning);
        else if (s.job)
            note("A file is still being written.", 1, kWarning);
        else if (!s.unsaved())
            note("All is written.", 1, kWarning);
        if (!s.open_next.empty())
            ImGui::TextUnformatted(("To open: " + s.open_next.filename().string()).c_str());
        const bool opens = !s.open_next.empty();
        if (s.unsaved()) {
            if (ImGui::Button(opens ? "Save and open (Enter)" : "Save and close (Enter)"))
                s.ask.save = s.ask.close = true;
            ImGui::SameLine();
        }
        if (ImGui::Button(opens ? "Open" : "Close")) s.ask.close_unsaved = true;
        tip(s.painter.unsaved             ? "The strokes stay in the journal: next time they can be recovered"
            : s.treatment_state.edits > 0 ? "The corrections of the damage map are given up"
            : s.annotations.unsaved       ? "They stay beside the painting: next time they are here again"
                                          : "What is being written is given up");
        if (ImGui::Button("Go on painting (Esc)")) {
            s.closing = false;
            s.open_next.clear();
        }
    }
}

// What comes and goes, below the panels, which stay where they are: what is asked, and jobs. Returns its
// height.
float footer(WindowState& s, float height) {
    const bool asks = s.closing || s.finishing || s.left_over_strokes > 0 || !s.dropped.empty();
    if (!asks && !s.job && !s.film) return 0;
    ImGui::SetNextWindowPos({0, height}, ImGuiCond_Always, {0, 1});
    ImGui::SetNextWindowSizeConstraints({width(s), 0}, {width(s), height});
    ImGui::Begin("footer", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    questions(s);
    dropped(s);
    job(s);
    film(s);
    const float taken = ImGui::GetWindowHeight();
    ImGui::End();
    return taken;
}

}  // namespace

void file(WindowState& s) {
    ImGui::TextUnformatted(fmt::format("{}{}", s.title, s.painter.unsaved ? " *" : "").c_str());
    const std::string size = fmt::format("{} × {} pixels", s.painting.width, s.painting.height);
    if (s.painter.elsewhere)
        note(
            "Open in another window: look only. Paint there; or save it under another name here, and paint "
            "on that",
            1, kWarning);
    else if (s.scale_known)
        note(fmt::format("{}, {:.1f} × {:.1f} mm", size, s.painting.width * s.stroke_mm_per_pixel,
                         s.painting.height * s.stroke_mm_per_pixel));
    else  // nothing while it is opened
        note(s.painting.width > 0 ? size + ", scale unknown" : "");
    if (ImGui::Button("New …")) s.ask.new_canvas = true;
    tip(s.keys.text(Action::fresh) + ": a canvas of linen, panel, paper …, or on a picture");
    ImGui::SameLine();
    if (ImGui::Button("Open …")) s.ask.open_dialog = true;
    tip(s.keys.text(Action::open));
    ImGui::SameLine();
    if (ImGui::Button("Save")) s.ask.save = true;
    tip(s.keys.text(Action::save));
    ImGui::SameLine();
    if (ImGui::Button("Save as …")) s.ask.save_dialog = true;
    tip(s.keys.text(Action::save_as));
    if (ImGui::Button("Export …")) ImGui::OpenPopup("formats");
    tip("For other programs: layers, OpenRaster, RTI viewers, a web page");
    if (ImGui::BeginPopup("formats")) {
        for (const ExportFormat& format : s.exports)
            if (ImGui::Selectable(format.name)) s.ask.export_dialog = &format;
        ImGui::EndPopup();
    }
    ImGui::SameLine();
    if (ImGui::Button("Snapshot")) s.ask.snapshot = true;
    tip(s.keys.text(Action::snapshot) + ": what is seen, as a PNG beside the painting");
    ImGui::SameLine();
    if (ImGui::Button("Keys")) s.help = !s.help;
    tip(s.keys.text(Action::help));
    if (ImGui::Button("Fit photographs …")) s.ask.fit_dialog = true;
    tip("Makes a painting of a folder of photographs and a lights file");
    recent(s);
}

void tools(WindowState& s) {
    int i = 0;
    for (const ToolName& tool : kTools) {
        if (!s.treatment_state.on && (tool.tool == Tool::damage || tool.tool == Tool::sample)) continue;
        if (tool.tool == Tool::damage) i = 0;  // a row of its own for those of a treatment
        if (i++ % 3) ImGui::SameLine();
        if (ImGui::RadioButton(with_key(s, tool.name, tool.action).c_str(), s.tool == tool.tool))
            s.tool = tool.tool;
        tip(help_of(tool.action));
    }
    if (ImGui::Button(with_key(s, "Fit", Action::fit).c_str())) s.ask.fit = true;
    ImGui::SameLine();
    if (ImGui::Button(with_key(s, "1:1", Action::one_to_one).c_str())) s.ask.one_to_one = true;
    ImGui::SameLine();
    if (ImGui::Button(with_key(s, "Straighten", Action::straighten).c_str())) s.ask.straighten = true;
    idle_while(s.comparing.on, kNotTilted, [&] { ImGui::Checkbox("Flat: the screen tilts", &s.flat); });
    auto turn = static_cast<float>(s.view.turn_deg);
    if (slide("Turn", turn, -180, 180, "%.0f°")) s.view.turn_deg = turn;
    float tilt[2] = {static_cast<float>(s.tilt.angle_deg.x), static_cast<float>(s.tilt.angle_deg.y)};
    const auto most = static_cast<float>(Tilt::kMost_deg);
    idle_while(s.comparing.on, kNotTilted, [&] {
        if (slide_both("Tilt", tilt, -most, most, "%.0f°")) s.tilt = Tilt{.angle_deg = {tilt[0], tilt[1]}};
    });
}

void messages(WindowState& s) {
    if (s.doubts.empty() && s.said.empty()) ImGui::TextDisabled("nothing was said yet");
    if (!s.doubts.empty()) ImGui::TextDisabled("Of the fit, kept with the painting:");
    for (const std::string& doubt : s.doubts) {
        ImGui::PushStyleColor(ImGuiCol_Text, kWarning);
        ImGui::TextWrapped("%s", doubt.c_str());
        ImGui::PopStyleColor();
    }
    if (!s.said.empty()) ImGui::TextDisabled("Said since, the newest first:");
    for (auto text = s.said.rbegin(); text != s.said.rend(); ++text) ImGui::TextWrapped("%s", text->c_str());
}

void canvas(WindowState& s) {
    if (ImGui::Button("Undo")) s.ask.undo = true;
    tip(s.keys.text(Action::undo));
    ImGui::SameLine();
    if (ImGui::Button("Redo")) s.ask.redo = true;
    tip(s.keys.text(Action::redo));
    ImGui::SameLine();
    if (ImGui::Button("Dry layer")) s.ask.dry = true;
    tip(s.keys.text(Action::dry) + ": all wet paint becomes a dry layer");
    ImGui::TextDisabled("%d stroke%s, %zu dried layer%s", s.painter.strokes,
                        s.painter.strokes == 1 ? "" : "s", s.painter.layers.size(),
                        s.painter.layers.size() == 1 ? "" : "s");
    for (const std::string& layer : s.painter.layers) {
        ImGui::PushID(layer.c_str());
        if (!s.treatment_state.on) {  // there, that is a step
            if (ImGui::SmallButton("Delete layer")) s.ask.lift = layer;
            tip("Takes this layer of dried paint away; can be undone");
            ImGui::SameLine();
        }
        ImGui::TextUnformatted(layer.c_str());
        ImGui::PopID();
    }
}

namespace {

// All but a treatment.
void painting_parts(WindowState& s) {
    ImGui::PushItemWidth(-90 * s.scale);
    folding("File", true, [&] { file(s); });
    // Unfolded when there are photographs, however they came.
    bool* unfolded = ImGui::GetStateStorage()->GetBoolRef(ImGui::GetID("photographs are there"));
    if (s.comparing.loaded && !*unfolded) ImGui::SetNextItemOpen(true);
    *unfolded = s.comparing.loaded;
    folding("Photographs", false, [&] { photographs(s); });
    bool* wanted = ImGui::GetStateStorage()->GetBoolRef(ImGui::GetID("a scale is asked for"));
    if (s.treatment_state.scale_asked && !*wanted) ImGui::SetNextItemOpen(true);
    *wanted = s.treatment_state.scale_asked;
    if (!s.treatment_state.on) folding("Treatment", false, [&] { treatment(s); });
    folding("Tools", true, [&] { tools(s); });
    // What the tool in the hand needs comes first: there is not room for all. Not while the pointer is on
    // what would move: a click on a paint takes the brush into the hand.
    const ImVec2 pointer = ImGui::GetIO().MousePos, corner = ImGui::GetCursorScreenPos();
    if (pointer.x >= ImGui::GetWindowPos().x + ImGui::GetWindowWidth() || pointer.y < corner.y) {
        s.paint_comes_first = s.tool == Tool::paint || s.tool == Tool::pick;
        s.annotations_come_first = s.tool == Tool::annotate;
    }
    const auto annotating = [&] {
        // Unfolded while one draws or writes.
        bool* there = ImGui::GetStateStorage()->GetBoolRef(ImGui::GetID("annotations are wanted"));
        const bool is_wanted = s.tool == Tool::annotate || s.annotations.until_typed > 0;
        if (is_wanted && (!*there || s.annotations.until_typed > 0)) ImGui::SetNextItemOpen(true);
        *there = is_wanted;
        folding(fmt::format("Annotations ({})###Annotations", s.annotations.items.size()).c_str(), false,
                [&] { annotations(s); });
    };
    if (s.annotations_come_first) annotating();
    const auto looking = [&] {
        folding("Light", true, [&] { light(s); });
        folding("Look", false, [&] { look(s); });
        folding("Devices", false, [&] { devices(s); });
    };
    if (!s.paint_comes_first) looking();
    folding("Paint", true, [&] { brush(s); });
    folding("Palette", true, [&] { palette(s); });
    folding("Canvas", true, [&] { canvas(s); });
    if (s.paint_comes_first) looking();
    if (!s.annotations_come_first) annotating();
    const std::size_t count = s.doubts.size() + s.said.size();
    folding(fmt::format("Messages ({})###Messages", count).c_str(), false, [&] { messages(s); });
    ImGui::PopItemWidth();
}

}  // namespace

void column(WindowState& s, float height) {
    const float room = height - footer(s, height);
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({width(s), room});
    ImGui::Begin("column", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    if (s.treatment_state.on && is_narrow(s)) {
        const auto choose = [&](const char* name, bool treatment) {
            if (ImGui::RadioButton(name, s.treatment_state.in_front == treatment))
                s.treatment_state.in_front = treatment;
        };
        choose("Treatment", true);
        ImGui::SameLine();
        choose("Painting, light and look", false);
        ImGui::Separator();
    }
    if (s.treatment_state.on && is_narrow(s) && s.treatment_state.in_front)
        treatment_parts(s);
    else
        painting_parts(s);
    ImGui::End();
}

void help(WindowState& s) {
    if (!s.help) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({width(s) + 20, 20}, ImGuiCond_Appearing);
    // What does not fit is scrolled to.
    ImGui::SetNextWindowSizeConstraints(
        {0, 0}, {std::max(screen.x - width(s) - 40, 100.0f), std::max(screen.y - 40, 100.0f)});
    if (ImGui::Begin("Keys (Escape closes this list)###keys", &s.help,
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_HorizontalScrollbar)) {
        const auto row = [&](const std::string& key, const std::string& text) {
            ImGui::TextUnformatted(key.c_str());
            ImGui::SameLine(170 * s.scale);
            ImGui::TextUnformatted(text.c_str());
        };
        for (const Shortcut& shortcut : shortcuts()) {
            const Action action = shortcut.action;
            const bool of_treatment = action == Action::tool_damage || action == Action::tool_sample ||
                                      (action > Action::treatment && action <= Action::treatment_report);
            if (of_treatment && !s.treatment_state.on) continue;
            const bool asked = s.rebinding == action;
            const std::string key = s.keys.text(action);
            const std::string shown = asked ? "press a key" : key.empty() ? "(none)" : key;
            ImGui::PushID(shortcut.name);
            if (ImGui::Selectable(shown.c_str(), asked, 0, {160 * s.scale, 0})) s.rebinding = action;
            ImGui::PopID();
            tip("Click to give it another key; then Escape leaves it, Backspace takes its keys away");
            ImGui::SameLine(170 * s.scale);
            ImGui::TextUnformatted(shortcut.help);
        }
        if (ImGui::SmallButton("Reset to defaults")) s.ask.usual_keys = true;
        if (!s.message.empty()) {  // which this window may lie over
            ImGui::SameLine();
            ImGui::TextColored({1, 0.88f, 0.6f, 1}, "%s",
                               in_lines(s.message, kWideMessage * s.scale, 1).c_str());
        }
        ImGui::Separator();
        row("wheel", "zoom to the cursor");
        row("right button", "tilt, with any tool");
        row("middle button", "move the painting, with any tool (or Space and drag)");
        row("two fingers", "move, enlarge and turn the painting, with any tool");
        for (const std::string& pen : s.pens) row("pen", pen);
    }
    ImGui::End();
    if (!s.help) s.rebinding.reset();
}

}  // namespace tangi::panels
