// relit_painting.h: what `relight` draws: a painting of any size with its paint and its residual.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "paint/canvas/appearance.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/render/part_relighter.h"
#include "surface/render/relighting_residual.h"
#include "viewer/render/gpu_relight.h"

namespace tangi {

// What is drawn of a painting, and by what.
struct Drawing {
    AppearanceOptions look;  // how paint, and under another illuminant all of the painting, is seen
    RelightOptions options;
    std::optional<bool> with_residual;  // where not said, if there is one of what is drawn
    bool gpu = false;
};

// A painting with its paint, and what its residual adds where none lies.
struct RelitPainting {
    std::shared_ptr<const PaintingReader> seen;
    RelightingResidual residual;         // empty where it is left out
    std::shared_ptr<const Surface> dry;  // that the residual is of, where paint lies on it
    Image<float> bare;
    std::vector<std::string> warnings;

    const PaintingHeader& header() const { return seen->header(); }
};

// Throws Error naming the file, and UsageError where a residual is asked for that is none of what is drawn.
RelitPainting open_relit(const std::filesystem::path& path, const Drawing& drawing, const Progress& progress);

// Pictures of one painting, which must live as long: by the reference renderer, or by OpenGL as far as that
// goes.
class PaintingRelighter {
public:
    PaintingRelighter(const RelitPainting& painting, const Drawing& drawing);

    // In bands of rows, from top to bottom.
    void draw(const std::vector<Light>& lights, const std::function<void(Image<Rgb>&& rows)>& take,
              const Progress& progress);
    Image<Rgb> picture(const std::vector<Light>& lights);
    std::string drawn_by() const { return gpu_ ? gpu_->device() : "reference renderer"; }

private:
    void finish(const Surface& part, std::span<const Light> lights, Image<Rgb>& picture) const;
    bool by_gpu(const std::function<void()>& action);

    const RelitPainting& painting_;
    RelightOptions options_;
    PartRelighter renderer_;
    ResidualUnderLights under_;     // the lights of the picture that is drawn
    std::optional<Surface> whole_;  // for OpenGL
    std::optional<GpuRelight> gpu_;
};

}  // namespace tangi
