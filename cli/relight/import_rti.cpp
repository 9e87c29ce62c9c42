#include "cli/relight/import_rti.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <glm/common.hpp>

#include "cli/arguments.h"
#include "fit/exchange/ptm_rti_file.h"
#include "fit/exchange/relight_folder.h"
#include "fit/verdict/fit_result.h"
#include "fit/verdict/fit_verdict.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/provenance/fit_doubts.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kPictures = 40;
constexpr double kLowest_deg = 25;  // below, few photographs were taken, and polynomials run away

// A folder of the system that is gone at the end.
class PassingFolder {
public:
    PassingFolder() {
        std::string name = (fs::temp_directory_path() / "tangipaint-XXXXXX").string();
        if (!::mkdtemp(name.data()))
            fail("{}: no folder can be made there; set TMPDIR", fs::temp_directory_path().string());
        path_ = name;
    }
    ~PassingFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    PassingFolder(const PassingFolder&) = delete;
    PassingFolder& operator=(const PassingFolder&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

void write_as_photographs(const RtiImage& image, const fs::path& folder, const Progress& progress) {
    const std::vector<Vec3> directions = hemisphere_directions(kPictures, kLowest_deg);
    std::string lights = fmt::format("{}\n", directions.size());
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const std::string name = fmt::format("relit_{:03}.png", i);
        Image<Rgb> picture = evaluate(image, directions[i]);
        for (Rgb& pixel : picture.pixels()) pixel = glm::clamp(pixel, 0.0f, 1.0f);
        write_map(folder / name, picture);
        const Vec3& d = directions[i];
        lights += fmt::format("{} {:.6f} {:.6f} {:.6f}\n", name, d.x, d.y, d.z);
        report(progress, "relight", static_cast<double>(i + 1) / static_cast<double>(directions.size()));
    }
    write_text_file(folder / "lights.lp", lights);
}

std::vector<fs::path> files_of(const fs::path& from) {
    if (!fs::is_directory(from)) return {from};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(from))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

std::vector<std::string> doubts_of(const RtiImage& image, const fs::path& from) {
    return {fmt::format(
        "{}: holds {} terms a pixel instead of photographs: highlights are smoothed and shadows are "
        "part of its colours, so that gloss and roughness are guesses, and height is that of its shading",
        from.string(), terms_of(image.basis))};
}

}  // namespace

bool is_rti(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension == ".ptm" || extension == ".rti" || (fs::is_directory(path) && is_relight_folder(path));
}

nlohmann::json import_rti(const fs::path& from, const fs::path& out,
                          const std::optional<double>& mm_per_pixel, const Progress& progress) {
    const std::vector<fs::path> inputs = files_of(from);
    refuse_to_overwrite(out, inputs);
    AtomicFile file(out);
    const RtiImage image = fs::is_directory(from) ? read_relight_folder(from) : read_rti_file(from);
    const PassingFolder folder;
    write_as_photographs(image, folder.path(), progress);
    UsableStack opened = open_usable_stack(folder.path(), {.transfer = Transfer{Transfer::Kind::srgb}});
    FitOptions options;
    options.mm_per_pixel = mm_per_pixel;
    options.register_photos = false;
    options.lights_as_given = true;
    FitResult fit = fit_painting(opened.stack, options, progress);
    // The photographs' own encoding is not known, and those that were fitted are gone.
    const std::vector<std::string> poor = doubts_of(image, from);
    const std::vector<std::string> warnings = fit_warnings(fit.report);
    nlohmann::json told_options = to_json(options);
    told_options["pictures"] = kPictures;
    const nlohmann::json provenance = provenance_of("import", told_options, records_of(inputs));
    fit.surface.provenance = with_doubts(json_line(provenance), poor, warnings);
    write_painting(file, fit.surface, std::array{part_of(fit.errors)}, progress);
    nlohmann::json result = fit_result(fit, {}, out.string());
    result["from"] = name_of(image.basis);
    result["inputs"] = provenance.at("inputs");
    result["warnings"] = told(warnings);
    result["poor"] = poor;
    return result;
}

}  // namespace tangi
