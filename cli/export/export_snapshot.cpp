// export_snapshot.cpp: a painting as a picture under one light.
#include <array>

#include "cli/arguments.h"
#include "cli/export/exporter.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "surface/render/viewing_exposure.h"

namespace tangi {

// As under one light, with shadows: for people, so sRGB, as bright as the photographs were. `relight` has
// more lights.
nlohmann::json export_snapshot(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    const std::shared_ptr<const Surface> surface = job.seen();
    require_picture_ending(a.out);
    refuse_to_overwrite(a.out, {a.painting});
    const Vec3 direction = parse_direction_in_front(a.light, "--light");
    Image<Rgb> picture =
        relight(*surface, std::array{distant_light(direction)}, {.cast_shadows = true}, job.progress);
    const bool any_unit = lower_extension(a.out) == ".exr";  // only files of floats hold any
    const double white = surface->photography.white_level;
    for (Rgb& pixel : picture.pixels())
        pixel *= static_cast<float>(any_unit ? white : viewing_exposure(white));
    write_picture(
        a.out, picture, lower_extension(a.out) == ".exr" ? Transfer{} : Transfer{Transfer::Kind::srgb},
        {.notes = job.notes(fmt::format("Relit from direction {:.3f}, {:.3f}, {:.3f} (x right, y up, z "
                                        "towards the viewer), Ward's model, cast shadows",
                                        direction.x, direction.y, direction.z))});
    return {{"files", {a.out}}};
}

}  // namespace tangi
