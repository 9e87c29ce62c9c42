// file_ending.h: the file that a typed name means, where it is to have one of some endings.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tangi {

struct NamedFile {
    std::filesystem::path path;  // empty where there is a complaint
    std::string complaint;
};

// `endings`: ".html .pdf", the first of which is added where the name has none of them; large or small
// letters are the same. An ending that is another kind of file's ("x.pdf" for a painting) is not added to but
// told: "x.pdf.exr" is what nobody means. "Madonna 1.5" has none.
NamedFile with_ending(const std::filesystem::path& typed, std::string_view endings);

}  // namespace tangi
