#include "surface/file/file_name.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <functional>
#include <system_error>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// [bytes] Of a name in this folder: 255 on Linux's own file systems, 143 where names are encrypted. NAME_MAX
// where the folder is not there, or does not say.
std::size_t longest_name_in(const fs::path& folder) {
    const long most = ::pathconf(folder.empty() ? "." : folder.c_str(), _PC_NAME_MAX);
    return most > 0 ? static_cast<std::size_t>(most) : NAME_MAX;
}

bool goes_on(char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; }

// Characters (UTF-8) at the end of `stem` that have so many bytes, or more.
std::size_t characters_in_last(std::string_view stem, std::size_t bytes) {
    std::size_t kept = stem.size() - std::min(bytes, stem.size());
    while (kept > 0 && kept < stem.size() && goes_on(stem[kept])) --kept;
    return static_cast<std::size_t>(std::ranges::count_if(stem.substr(kept), std::not_fn(goes_on)));
}

}  // namespace

std::string told_of_length(const fs::path& file, std::size_t beside) {
    const std::string stem = file.stem().string(), extension = file.extension().string();
    const std::size_t most = longest_name_in(file.parent_path());
    const std::size_t needed = temporary_name(stem, extension).size() + beside;
    if (needed <= most) return {};
    const std::size_t less = characters_in_last(stem, needed - most);
    return fmt::format("the name is too long: make it {} character{} shorter", less, less == 1 ? "" : "s");
}

bool file_exists(const fs::path& file) {
    std::error_code unknown;
    return fs::exists(file, unknown);
}

fs::path beside_painting(const fs::path& painting, const std::string& ending) {
    fs::path path = where_links_lead(painting);
    if (path.extension() == ".exr") path.replace_extension();
    return path += "." + ending;
}

fs::path free_name_beside(const fs::path& painting, std::string_view why, std::string_view extension) {
    for (int i = 1;; ++i) {
        const std::string number = i == 1 ? "" : fmt::format("-{}", i);
        fs::path name = beside_painting(painting, fmt::format("{}{}.{}", why, number, extension));
        if (!file_exists(name)) return name;
    }
}

std::string put_aside(const fs::path& file, const fs::path& painting, std::string_view why,
                      std::string_view extension) {
    if (!file_exists(file)) return {};
    const fs::path name = free_name_beside(painting, why, extension);
    std::error_code failed;
    fs::rename(file, name, failed);
    if (failed)
        fail("{}: cannot be renamed to {}: {}", file.string(), name.filename().string(), failed.message());
    return name.filename().string();
}

std::string words_of(const fs::filesystem_error& error) {
    const fs::path& file = error.path1();
    if (error.code() == std::errc::filename_too_long)
        return fmt::format(
            "{}: the name is too long: {} bytes of a name, and {} of a whole path, are the most",
            shortened(file.string()), longest_name_in(file.parent_path()), PATH_MAX - 1);
    return fmt::format("{}: {}", file.string(), error.code().message());
}

}  // namespace tangi
