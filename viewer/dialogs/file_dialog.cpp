#include "viewer/dialogs/file_dialog.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <utility>

#include "surface/file/file_name.h"
#include "surface/image_file/image_io.h"
#include "viewer/dialogs/file_ending.h"

namespace tangi::panels {

namespace fs = std::filesystem;

namespace {

// One of "`.png .jpg`".
bool is_listed(const std::string& ending, const std::string& endings) {
    return !ending.empty() && (' ' + endings + ' ').find(' ' + ending + ' ') != std::string::npos;
}

// ".lp or .dome" of ".lp .dome".
std::string in_words(std::string endings) {
    for (std::size_t at = 0; (at = endings.find(' ', at)) != std::string::npos; at += 4)
        endings.replace(at, 1, " or ");
    return endings;
}

}  // namespace

FileDialog::FileDialog(std::string title, Wants wants, std::string ending, const fs::path& start,
                       std::function<void(const fs::path&)> chosen)
    : title_(std::move(title)), ending_(std::move(ending)), wants_(wants), chosen_(std::move(chosen)) {
    std::error_code gone;
    const fs::path at = fs::absolute(start.empty() ? fs::path(".") : start, gone).lexically_normal();
    if (wants == Wants::new_file) typed_ = name_ = at.filename().string();
    go_to(fs::is_directory(at, gone) ? at : at.parent_path());
}

void FileDialog::go_to(const fs::path& folder) {
    folder_ = folder.has_filename() || folder == folder.root_path() ? folder : folder.parent_path();
    folders_.clear();
    files_.clear();
    std::error_code error;
    for (fs::directory_iterator entry(folder_, fs::directory_options::skip_permission_denied, error), end;
         !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        std::error_code gone;
        if (name.starts_with('.')) continue;
        if (entry->is_directory(gone))
            folders_.push_back(name);
        else if (wants_ != Wants::folder && wants_ != Wants::new_folder &&
                 is_listed(lower_extension(entry->path()), ending_))
            files_.push_back(name);
    }
    complaint_ = error ? fmt::format("cannot be listed: {}", error.message()) : "";
    std::sort(folders_.begin(), folders_.end());
    std::sort(files_.begin(), files_.end());
}

FileDialog::Choice FileDialog::choice(Wants wants, const std::string& ending, const fs::path& folder,
                                      const std::string& typed) {
    const bool is_named = wants == Wants::file || wants == Wants::new_file;
    if (typed.find_first_not_of(' ') == std::string::npos)
        return is_named ? Choice{{}, "type or click a name", false} : Choice{folder, "", true};
    fs::path path = typed_path(folder, typed);
    if (wants == Wants::new_file) return new_file(path, ending);
    if (!path.has_filename() && path.has_relative_path()) path = path.parent_path();  // "photos/"
    std::error_code gone;
    if (!fs::exists(path, gone)) {
        if (wants != Wants::new_folder || !fs::is_directory(path.parent_path(), gone))
            return {{}, "there is no such file or folder", false};
        const std::string told = told_of_length(path);
        return told.empty() ? Choice{path, "", false} : Choice{{}, told, false};
    }
    const bool is_folder = fs::is_directory(path, gone);
    if ((wants == Wants::folder || wants == Wants::new_folder) && !is_folder)
        return {{}, "that is no folder", true};
    if (wants == Wants::folder_or_file && !is_folder && !is_listed(lower_extension(path), ending))
        return {
            {}, fmt::format("that is neither a folder nor a file that ends in {}", in_words(ending)), true};
    return {path, "", true};
}

FileDialog::Choice FileDialog::new_file(const fs::path& typed, const std::string& ending) {
    std::error_code gone;
    if (!typed.has_filename())
        return fs::is_directory(typed, gone) ? Choice{typed, "", true}
                                             : Choice{{}, "there is no such folder", false};
    auto [path, complaint] = with_ending(typed, ending);
    if (path.empty()) return {{}, complaint, false};
    // A page and the same as PDF are written side by side: the page is what it is called by.
    if (lower_extension(path) == ".pdf") path.replace_extension(".html");
    if (fs::is_directory(path, gone)) return {{}, "that is a folder", true};
    if (!fs::is_directory(path.parent_path(), gone)) return {{}, "there is no such folder", false};
    return {path, "", fs::exists(path, gone)};
}

bool FileDialog::accept() {
    const Choice choice = FileDialog::choice(wants_, ending_, folder_, typed_);
    std::error_code gone;
    complaint_ = choice.complaint;
    if (choice.path.empty()) return false;
    if ((wants_ == Wants::file || wants_ == Wants::new_file) && fs::is_directory(choice.path, gone)) {
        go_to(choice.path);
        typed_ = name_;
        return false;
    }
    if (wants_ == Wants::new_file && choice.exists && overwrites_ != choice.path.string()) {
        overwrites_ = choice.path.string();
        complaint_ = "is there already; once more to replace it";
        return false;
    }
    chosen_(choice.path);
    return true;
}

void FileDialog::each_text(const std::function<void(std::string_view)>& see) const {
    see(title_);
    see(folder_.string());
    see(typed_);
    see(complaint_);
    for (const std::string& name : folders_) see(name);
    for (const std::string& name : files_) see(name);
}

// Folders and files to click; true where a file was chosen so.
bool FileDialog::draw_list() {
    bool done = false;
    ImGui::BeginChild("list", {0, -2.6f * ImGui::GetFrameHeightWithSpacing()}, true);
    fs::path next;
    if (folder_.has_relative_path() && ImGui::Selectable("..")) next = folder_.parent_path();
    for (const std::string& name : folders_) {
        if (!ImGui::Selectable((name + "/").c_str(), typed_ == name, ImGuiSelectableFlags_AllowDoubleClick))
            continue;
        if (takes_folders()) typed_ = name;
        if (!takes_folders() || ImGui::IsMouseDoubleClicked(0)) next = folder_ / name;
    }
    for (const std::string& name : files_)
        if (ImGui::Selectable(name.c_str(), typed_ == name, ImGuiSelectableFlags_AllowDoubleClick)) {
            typed_ = name;
            done = ImGui::IsMouseDoubleClicked(0) && accept();
        }
    ImGui::EndChild();
    if (!next.empty()) {
        go_to(next);
        if (wants_ != Wants::new_file) typed_.clear();
    }
    return done;
}

// Where a name is typed.
void FileDialog::draw_name() {
    if (focus_) ImGui::SetKeyboardFocusHere();
    since_focus_ = std::exchange(focus_, false) ? 1 : since_focus_ + 1;
    ImGui::PushItemWidth(-1);
    const char* hint = wants_ == Wants::folder       ? "this folder, or the name of one"
                       : wants_ == Wants::new_folder ? "this folder, or the name of one, or of a new one"
                       : wants_ == Wants::folder_or_file
                           ? "this folder, or the name of one, or of a file above"
                           : "name, or a whole path";
    ImGui::InputTextWithHint("##name", hint, &typed_);
    ImGui::PopItemWidth();
}

bool FileDialog::draw() {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Appearing, {0.5f, 0.5f});
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowSize({std::min(40 * line, screen.x), std::min(33 * line, screen.y)},
                             ImGuiCond_Appearing);
    ImGui::SetNextWindowBgAlpha(1);
    bool open = true;
    ImGui::Begin(title_.c_str(), &open, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse);
    ImGui::TextUnformatted(folder_.string().c_str());
    bool done = draw_list();
    draw_name();
    if (std::exchange(entered_, false)) {
        done = accept();
        focus_ = !done;
    }
    const char* verb = wants_ == Wants::new_file ? "Save" : takes_folders() ? "Choose" : "Open";
    if (ImGui::Button(verb)) done = accept();
    ImGui::SameLine();
    if (ImGui::Button("Cancel") || given_up_) open = false;
    ImGui::SameLine();
    ImGui::TextColored({1, 0.7f, 0.3f, 1}, "%s", complaint_.c_str());
    ImGui::End();
    return open && !done;
}

}  // namespace tangi::panels
