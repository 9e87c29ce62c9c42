// file_dialog.h: choosing a file or a folder, in a window of Dear ImGui.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tangi::panels {

class FileDialog {
public:
    // `new_folder`: one that is there, or a new name in one. `folder_or_file`: the photographs of a folder,
    // or those that one of its lights files lists.
    enum class Wants { file, new_file, folder, new_folder, folder_or_file };

    // `ending`: of the files that are listed, ".exr"; several, ".png .jpg", of which the
    // first is added to a new file's name without (file_ending.h). `start`: the
    // folder, or of Wants::new_file the file. `chosen` is called once, with what the user chose.
    FileDialog(std::string title, Wants wants, std::string ending, const std::filesystem::path& start,
               std::function<void(const std::filesystem::path&)> chosen);

    // Keys, wherever the keyboard's focus is.
    void enter() { entered_ = true; }
    void escape() { given_up_ = true; }

    // The name can be typed: the field has the keyboard's focus, two frames after it was asked for.
    bool ready_to_type() const { return !focus_ && since_focus_ >= 2; }

    // What it shows of names.
    void each_text(const std::function<void(std::string_view)>& see) const;

    // False once it is over: chosen, or given up.
    bool draw();

    // What choosing `typed` in `folder` means (typed_path()): an existing file, a folder, a new file with its
    // ending; or why not (then `path` is empty). Of Wants::new_file a folder is one to go to.
    struct Choice {
        std::filesystem::path path;
        std::string complaint;
        bool exists = false;  // a new file of this name is there already
    };
    static Choice choice(Wants wants, const std::string& ending, const std::filesystem::path& folder,
                         const std::string& typed);

private:
    static Choice new_file(const std::filesystem::path& typed, const std::string& ending);
    void go_to(const std::filesystem::path& folder);
    bool accept();
    bool draw_list();
    void draw_name();

    bool takes_folders() const { return wants_ != Wants::file && wants_ != Wants::new_file; }

    std::string title_, ending_, typed_, complaint_;
    std::string name_;  // that a new file has to begin with
    Wants wants_;
    std::filesystem::path folder_;
    std::vector<std::string> folders_, files_;
    std::function<void(const std::filesystem::path&)> chosen_;
    std::string overwrites_;  // was asked about
    int since_focus_ = 0;     // frames
    bool focus_ = true, entered_ = false, given_up_ = false;
};

}  // namespace tangi::panels
