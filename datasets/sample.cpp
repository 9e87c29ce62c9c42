#include "datasets/sample.h"

#include <dlfcn.h>

#include <cstdlib>
#include <vector>

#include "datasets/source_folder.h"
#include "surface/base/error.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Of the program, and of the library that this is in, where it is in one.
std::vector<fs::path> folders_of_program() {
    std::error_code unknown;
    std::vector<fs::path> folders = {fs::read_symlink("/proc/self/exe", unknown).parent_path()};
    Dl_info library{};
    if (::dladdr(reinterpret_cast<const void*>(&sample_folder), &library) && library.dli_fname)
        folders.push_back(fs::weakly_canonical(library.dli_fname, unknown).parent_path());
    return folders;
}

// Below the prefix that was installed to: bin/, lib/ and lib/ARCHITECTURE/ are one or two folders down.
std::vector<fs::path> places() {
    std::vector<fs::path> found;
    for (const fs::path& folder : folders_of_program())
        for (const fs::path& prefix : {folder.parent_path(), folder.parent_path().parent_path()})
            found.push_back(prefix / "share" / "tangipaint" / "datasets");
    if (*kSourceFolder) found.emplace_back(kSourceFolder);
    return found;
}

}  // namespace

fs::path sample_folder() {
    std::error_code status;
    if (const char* given = std::getenv("TANGIPAINT_DATASETS"); given && *given) {
        if (fs::is_directory(fs::path(given) / "impasto", status)) return given;
        fail("{}: holds no folder 'impasto'; TANGIPAINT_DATASETS must name TangiPaint's datasets folder",
             given);
    }
    const std::vector<fs::path> looked_at = places();
    for (const fs::path& folder : looked_at)
        if (fs::is_directory(folder / "impasto", status)) return folder;
    fail("{}: the sample 'impasto' is not there; set TANGIPAINT_DATASETS to TangiPaint's datasets folder",
         looked_at.front().string());
}

}  // namespace tangi
