#include "cli/relight/lights_to_relight.h"

#include <algorithm>
#include <set>
#include <string>

#include "cli/arguments.h"
#include "surface/base/error.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Windows programs write their folders with backslashes.
fs::path portable(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return fs::path(name);
}

// Where the lights file lies beside its photographs, these have the names of the pictures to be made. One
// that lies there is a photograph, unless the photograph that the lights file names is another file.
void refuse_to_overwrite_photograph(const fs::path& output, const fs::path& lights_file, const Light& light) {
    const fs::path folder = fs::absolute(lights_file).parent_path(), listed = portable(light.name);
    if (!fs::exists(output)) return;
    for (const fs::path& named : {folder / listed, folder / listed.filename()}) {
        std::error_code missing;
        const bool same_folder =
            fs::equivalent(fs::absolute(output).parent_path(), named.parent_path(), missing);
        if (same_folder && (!fs::exists(named) || fs::equivalent(output, named)))
            fail("--out {}: would overwrite the photograph {}; choose another folder",
                 output.parent_path().string(), output.string());
    }
}

}  // namespace

LightList lights_in(const fs::path& path) {
    LightList list = read_lights(path);
    if (list.capture && list.capture->geometry) list.lights = in_picture(*list.capture).lights;
    if (list.lights.empty()) fail("{}: holds no light", path.string());
    if (std::ranges::any_of(list.lights, [](const Light& light) { return light.name.empty(); }))
        fail(
            "{}: does not name the photographs of its lights, after which the pictures are called; give a "
            "lights file that does (.lp)",
            path.string());
    // The picture is of what was asked for; where the lights really stood is another matter.
    if (list.capture)
        list.warnings.insert(list.warnings.end(), list.capture->poor.begin(), list.capture->poor.end());
    return list;
}

std::vector<fs::path> pictures_of(const std::vector<Light>& lights, const fs::path& lights_file,
                                  const fs::path& folder, const std::vector<fs::path>& inputs) {
    std::vector<fs::path> pictures;
    std::set<fs::path> seen;
    for (const Light& light : lights) {
        pictures.push_back(folder / (portable(light.name).stem().string() + ".png"));
        if (!seen.insert(pictures.back()).second)
            fail("{}: two photographs have the stem '{}', so their relit pictures would be one file",
                 lights_file.string(), pictures.back().stem().string());
        refuse_to_overwrite(pictures.back(), inputs);
        refuse_to_overwrite_photograph(pictures.back(), lights_file, light);
    }
    return pictures;
}

}  // namespace tangi
