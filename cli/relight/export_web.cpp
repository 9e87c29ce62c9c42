// export_web.cpp: the web page of a painting, as a folder or as one file.
#include "cli/arguments.h"
#include "cli/relight/exporter.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

nlohmann::json export_web(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    const std::shared_ptr<const Surface> surface = job.seen();
    const fs::path page =
        lower_extension(a.out) == ".html" ? fs::path(a.out) : fs::path(a.out) / "index.html";
    if (page != fs::path(a.out) && fs::exists(a.out) && !fs::is_directory(a.out))
        fail("--out {}: is a file; give a folder, or a page of one file, .html", a.out);
    refuse_to_overwrite(page, {a.painting});
    WebWords words = a.words;
    if (words.title.empty()) words.title = fs::path(a.painting).stem().string();
    const WebReport report = write_web_page(a.out, *surface, words, a.web, job.progress);
    nlohmann::json files = nlohmann::json::array();
    for (const fs::path& path : report.files) files.push_back(path.string());
    return {{"files", files},
            {"levels", report.levels},
            {"tiles", report.tiles},
            {"bytes", report.bytes},
            {"first_picture_bytes", report.first_bytes}};
}

}  // namespace tangi
