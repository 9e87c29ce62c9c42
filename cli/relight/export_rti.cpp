// export_rti.cpp: .ptm and .rti files of a painting, or of its photographs.
#include "cli/arguments.h"
#include "cli/relight/exporter.h"
#include "fit/exchange/ptm_rti_file.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

RtiBasis basis_of(const ExportArguments& a) {
    if (a.to == "ptm") return RtiBasis::ptm;
    for (const RtiBasis basis : {RtiBasis::hsh4, RtiBasis::hsh9, RtiBasis::hsh16})
        if (terms_of(basis) == a.terms) return basis;
    throw UsageError(fmt::format("--terms {}: .rti files have 4, 9 or 16 terms", a.terms));
}

}  // namespace

nlohmann::json export_rti(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    const std::shared_ptr<const Surface> seen = job.seen();
    const Surface& surface = *seen;
    const RtiBasis basis = basis_of(a);
    if (lower_extension(a.out) != "." + a.to) fail("--out {}: --to {} writes a .{} file", a.out, a.to, a.to);
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
    AtomicFile file(a.out);
    const bool linear = surface.photography.transfer.kind == Transfer::Kind::linear;
    const RtiImage image = stack ? fit_rti(*stack, basis, a.lrgb, job.progress, linear)
                                 : rti_of(surface, basis, a.lrgb, {Transfer::Kind::srgb},
                                          {.directions = a.directions}, job.progress);
    write_rti_file(file, image, job.progress);
    return {{"files", {a.out}},
            {"basis", name_of(basis)},
            {"lrgb", a.lrgb},
            {"from", stack ? "photographs" : "painting"},
            {"encoding", stack && !linear ? "as stored" : "srgb"},
            {"lights", stack ? static_cast<int>(stack->photos.size()) : a.directions}};
}

}  // namespace tangi
