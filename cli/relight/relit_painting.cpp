#include "cli/relight/relit_painting.h"

#include "cli/arguments.h"
#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "surface/maps/surface_part.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// What is drawn that a residual is none of; empty where it fits.
std::string drawn_otherwise(const Drawing& drawing, const PaintingHeader& header,
                            const RelightingResidual& residual) {
    if (drawing.look.illuminant != Illuminant::d65)
        return "--illuminant: what a residual adds is of the light of the photographs";
    Surface dry;
    describe(header, dry);
    if (belongs_to(residual, dry, drawing.options)) return {};
    return fmt::format(
        "the residual was fitted with --cast-shadows, --model bounded and --light-radius-deg {}, and is none "
        "of anything else",
        static_cast<float>(residual.light_radius_deg));
}

// Where it is asked for, there must be one, unless the fit found that none is better.
RelightingResidual residual_to_add(const fs::path& path, const Drawing& drawing, const PaintingHeader& dry,
                                   std::vector<std::string>& warnings, const Progress& progress) {
    if (!drawing.with_residual.value_or(true)) return {};
    RelightingResidual residual = read_residual(path, dry, progress);
    const bool required = drawing.with_residual.has_value();
    if (residual.empty()) {
        if (required && !residual_in_vain(dry.provenance))
            fail("{}: has no part 'residual'; fit the painting again, without --no-residual", path.string());
        if (required)
            warnings.push_back(
                fmt::format("--residual: {} holds none, since the fit found none that predicts photographs "
                            "better than the surface alone, which is what is shown",
                            path.string()));
        return residual;
    }
    const std::string otherwise = drawn_otherwise(drawing, dry, residual);
    if (otherwise.empty()) return residual;
    if (required) throw UsageError(fmt::format("--residual: {}; leave one of them out", otherwise));
    return {};
}

}  // namespace

RelitPainting open_relit(const fs::path& path, const Drawing& drawing, const Progress& progress) {
    RelitPainting painting;
    const PaintingHeader file = open_painting(path)->header();
    painting.residual = residual_to_add(path, drawing, file, painting.warnings, progress);
    if (painting.residual.empty() || !is_painted(file)) {
        painting.seen = open_painted(path, drawing.look, progress);
        return painting;
    }
    const Canvas canvas = read_canvas(path, progress);
    painting.seen = reader_of(shown(canvas, drawing.look, progress), path);
    painting.dry = canvas.dry_shared();
    painting.bare = bare_part(canvas);
    return painting;
}

PaintingRelighter::PaintingRelighter(const RelitPainting& painting, const Drawing& drawing)
    : painting_(painting), options_(drawing.options), renderer_(painting.seen, drawing.options) {
    if (!painting.residual.empty())
        renderer_.finish_with([this](const Surface& part, std::span<const Light> lights,
                                     Image<Rgb>& picture) { finish(part, lights, picture); });
    if (!drawing.gpu) return;
    by_gpu([&] {
        whole_ = painting_.seen->read(painting_.seen->extent(0).region());
        gpu_.emplace(*whole_);
    });
}

void PaintingRelighter::draw(const std::vector<Light>& lights,
                             const std::function<void(Image<Rgb>&& rows)>& take, const Progress& progress) {
    under_ = residual_under(painting_.residual, lights);
    Image<Rgb> picture;
    if (gpu_ && by_gpu([&] { picture = gpu_->relight(lights, options_); })) {
        if (!painting_.residual.empty()) finish(*whole_, lights, picture);
        return take(std::move(picture));
    }
    renderer_.draw_bands(
        lights, [&](Image<Rgb>&& rows, int) { take(std::move(rows)); }, progress);
}

Image<Rgb> PaintingRelighter::picture(const std::vector<Light>& lights) {
    Image<Rgb> all(painting_.seen->width(), painting_.seen->height());
    int top = 0;
    draw(lights,
         [&](Image<Rgb>&& rows) {
             paste(rows, rows.region(), all, 0, top);
             top += rows.height();
         },
         {});
    return all;
}

void PaintingRelighter::finish(const Surface& part, std::span<const Light> lights,
                               Image<Rgb>& picture) const {
    if (!painting_.dry) return add_residual(painting_.residual, under_, part, lights, {}, picture);
    const Region region = {part.part_of->left, part.part_of->top, part.part_of->left + part.width(),
                           part.part_of->top + part.height()};
    Surface dry = cut(*painting_.dry, region);
    dry.photography = painting_.dry->photography;
    dry.part_of = part.part_of;
    add_residual(painting_.residual, under_, dry, lights, cut(painting_.bare, region), picture);
}

// False, with a note, where OpenGL cannot.
bool PaintingRelighter::by_gpu(const std::function<void()>& action) {
    try {
        action();
        return true;
    } catch (const Error& error) {
        gpu_.reset();
        warn(fmt::format("--gpu: {}; the reference renderer draws instead", error.what()));
        return false;
    }
}

}  // namespace tangi
