// file_ending.h: the file that a typed name means, and where it is to have one of some endings.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tangi {

// A name or a path in `folder`, as desktops understand it: blanks at its ends are none of it, "~" is the
// user's own folder. What is there by this very name is that. Ends in a slash where a folder is meant ("..",
// "~").
std::filesystem::path typed_path(const std::filesystem::path& folder, std::string_view typed);

struct NamedFile {
    std::filesystem::path path;  // empty where there is a complaint
    std::string complaint;
};

// `endings`: ".html .pdf", the first of which is added where the name has none of them; large or small
// letters are the same. An ending that is another kind of file's ("x.pdf" for a painting) is not added to but
// told: "x.pdf.exr" is what nobody means. "Madonna 1.5" has none. A name of dots, or of an ending alone, is
// none, and one that leaves no room for those beside it (told_of_length()) is told.
NamedFile with_ending(const std::filesystem::path& typed, std::string_view endings);

}  // namespace tangi
