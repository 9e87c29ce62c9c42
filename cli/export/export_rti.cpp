// export_rti.cpp: .ptm and .rti files and planes for Relight, of a painting, or of its photographs.
#include <algorithm>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/export/exporter.h"
#include "fit/exchange/ptm_rti_file.h"
#include "fit/exchange/relight_folder.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

RtiBasis basis_of(const ExportArguments& a) {
    const bool asks_for_terms = a.typed && std::ranges::count(a.typed(), "--terms");
    if (a.to == "ptm" || (a.to == "relight" && !asks_for_terms)) return RtiBasis::ptm;
    for (const RtiBasis basis : {RtiBasis::hsh4, RtiBasis::hsh9, RtiBasis::hsh16})
        if (terms_of(basis) == a.terms) return basis;
    throw UsageError(fmt::format("--terms {}: harmonics have 4, 9 or 16 terms", a.terms));
}

struct Rti {
    RtiImage image;
    nlohmann::json about;
};

Rti rti_of_job(const ExportJob& job, const Surface& surface) {
    const ExportArguments& a = job.arguments;
    const RtiBasis basis = basis_of(a);
    std::vector<fs::path> inputs = {a.painting};
    std::optional<Stack> stack;
    if (!a.photos.empty()) {
        StackOptions options;
        if (!a.lights.empty()) options.lights_file = a.lights;
        stack = open_stack(a.photos, options);
        for (const StackPhoto& photo : stack->photos) inputs.push_back(photo.path);
        if (stack->is_raw) fail("{}: camera raw cannot be exported; leave out --photos", a.photos);
        // As the fit registered them; those that it did not see have no part.
        std::erase_if(stack->photos, [&](StackPhoto& photo) {
            const Photography::Photo* known = find_photo(surface.photography, photo.light);
            if (known) photo.homography = known->homography;
            return !known || !known->fitted;
        });
    }
    refuse_to_overwrite(a.out, inputs);
    const bool linear = surface.photography.transfer.kind == Transfer::Kind::linear;
    const RtiImage image = stack ? fit_rti(*stack, basis, a.lrgb, job.progress, linear)
                                 : rti_of(surface, basis, a.lrgb, {Transfer::Kind::srgb},
                                          {.directions = a.directions}, job.progress);
    return {image,
            {{"basis", name_of(basis)},
             {"lrgb", a.lrgb},
             {"from", stack ? "photographs" : "painting"},
             {"encoding", stack && !linear ? "as stored" : "srgb"},
             {"lights", stack ? static_cast<int>(stack->photos.size()) : a.directions}}};
}

}  // namespace

nlohmann::json export_rti(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    require_ending(a.out, {exporter_named(a.to).extension},
                   fmt::format("--to {} writes a .{} file", a.to, a.to));
    const std::shared_ptr<const Surface> surface = job.seen();
    AtomicFile file(a.out);
    Rti rti = rti_of_job(job, *surface);
    write_rti_file(file, rti.image, job.progress);
    rti.about["files"] = {a.out};
    return rti.about;
}

nlohmann::json export_relight(const ExportJob& job) {
    const std::shared_ptr<const Surface> surface = job.seen();
    const Rti rti = rti_of_job(job, *surface);
    nlohmann::json result = export_folder(job.arguments.out, "files.json", [&](const fs::path& folder) {
        write_relight_folder(folder, rti.image, surface->mm_per_pixel, job.progress);
    });
    result.update(rti.about);
    return result;
}

}  // namespace tangi
