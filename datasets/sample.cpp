#include "datasets/sample.h"

#include <cstdlib>

#include "surface/base/error.h"

namespace tangi {

namespace fs = std::filesystem;

fs::path sample_folder() {
    const char* given = std::getenv("TANGIPAINT_DATASETS");
    const fs::path folder = given && *given ? fs::path(given) : fs::path(TP_DATASETS_DIR);
    std::error_code status;
    if (fs::is_directory(folder / "impasto", status)) return folder;
    if (given && *given)
        fail("{}: holds no folder 'impasto'; TANGIPAINT_DATASETS must name TangiPaint's datasets folder",
             folder.string());
    fail("{}: the sample 'impasto' is not there; set TANGIPAINT_DATASETS to TangiPaint's datasets folder",
         folder.string());
}

}  // namespace tangi
