// window_dialogs.cpp: dialogs in which a file or folder is chosen.
#include <fmt/format.h>

#include "viewer/app/window_app.h"

namespace tangi {

// What is chosen is asked for in turn, as `where` of the window's requests.
void WindowApp::choose(const FileQuestion& question, std::filesystem::path WindowState::Requests::*where) {
    dialog_.emplace(question.title, question.wants, question.ending, question.start,
                    [this, where](const std::filesystem::path& path) { state_.ask.*where = path; });
    settle_ = kFramesAfterwards;  // its first ones give it the keyboard, and nothing may be typed before
}

// The same, of the treatment's requests.
void WindowApp::choose_for_treatment(const FileQuestion& question,
                                     std::filesystem::path TreatmentState::Ask::*where) {
    dialog_.emplace(
        question.title, question.wants, question.ending, question.start,
        [this, where](const std::filesystem::path& path) { state_.treatment_state.ask.*where = path; });
}

void WindowApp::choose_export(const ExportFormat& format) {
    using panels::FileDialog;
    const std::filesystem::path file = painter_->file(), here = std::filesystem::absolute(file).parent_path();
    const bool is_folder = *format.ending == 0;
    dialog_.emplace(fmt::format("Export: {}", format.name),
                    is_folder ? FileDialog::Wants::new_folder : FileDialog::Wants::new_file,
                    is_folder ? ".exr" : format.ending,
                    is_folder ? here : here / (file.stem().string() + format.ending),
                    [this, chosen = &format](const std::filesystem::path& path) {
                        state_.ask.format = chosen;
                        state_.ask.export_to = path;
                    });
    settle_ = kFramesAfterwards;
}

void WindowApp::treatment_dialogs() {
    using Wants = panels::FileDialog::Wants;
    const TreatmentState::Ask& ask = state_.treatment_state.ask;
    const std::filesystem::path here = std::filesystem::absolute(painter_->file()).parent_path();
    if (ask.open_dialog)
        choose_for_treatment({"Open a treatment", Wants::folder, here}, &TreatmentState::Ask::open);
    if (ask.report_dialog)
        choose_for_treatment({"Report of the treatment", Wants::new_file,
                              here.parent_path() / (here.stem().string() + "-treatment.html"), ".html .pdf"},
                             &TreatmentState::Ask::report);
}

void WindowApp::photo_dialogs(const PhotoRequests& ask) {
    using Wants = panels::FileDialog::Wants;
    using Requests = WindowState::Requests;
    const std::filesystem::path here = std::filesystem::absolute(painter_->file()).parent_path();
    if (ask.photos_dialog && !state_.from_photographs)
        say("this painting was not fitted to photographs: there is nothing to compare it with");
    else if (ask.photos_dialog)
        choose({"The folder of photographs", Wants::folder, here}, &Requests::photos);
    if (ask.fit_dialog)
        choose({"Fit the photographs of a folder, or of a lights file", Wants::folder_or_file, here,
                state_.lights_endings.c_str()},
               &Requests::fit_folder);
}

void WindowApp::annotation_dialogs(const AnnotationRequests& ask) {
    using Wants = panels::FileDialog::Wants;
    using Requests = WindowState::Requests;
    const std::filesystem::path file = painter_->file(), here = std::filesystem::absolute(file).parent_path();
    if (ask.load_annotations_dialog)
        choose({"Add the annotations of a file", Wants::file, here, ".json .jsonld"},
               &Requests::load_annotations);
    if (ask.copy_annotations_dialog)
        choose({"A copy of the annotations", Wants::new_file,
                here / (file.stem().string() + "-annotations.json"), ".json .jsonld"},
               &Requests::copy_annotations);
}

// Those that were asked for. Where there are several, the last one stays.
void WindowApp::dialogs(const WindowState::Requests& ask) {
    using Wants = panels::FileDialog::Wants;
    using Requests = WindowState::Requests;
    constexpr const char* kPictures = ".png .jpg .jpeg .tif .tiff .exr";
    const std::filesystem::path file = painter_->file(), here = std::filesystem::absolute(file).parent_path();
    treatment_dialogs();
    if (ask.open_dialog) choose({"Open a painting", Wants::file, here}, &Requests::open);
    if (ask.save_dialog) choose({"Save the painting as", Wants::new_file, file}, &Requests::save_as);
    photo_dialogs(ask);
    annotation_dialogs(ask);
    if (ask.palette_dialog) choose({"Another paint box", Wants::file, here, ".json"}, &Requests::palette);
    if (ask.export_dialog) choose_export(*ask.export_dialog);
    if (ask.substrate_dialog)
        choose({"A picture or painting to paint on", Wants::file, here, kPictures}, &Requests::substrate);
    if (ask.height_dialog) choose({"A height map", Wants::file, here, kPictures}, &Requests::height_from);
    if (ask.film_dialog)
        choose({"A film of the light going round", Wants::new_file,
                here / (file.stem().string() + "-sweep.mp4"), ".mp4 .webm"},
               &Requests::film);
    if (ask.report_dialog) choose({"A folder for the report", Wants::new_folder, here}, &Requests::report);
}

}  // namespace tangi
