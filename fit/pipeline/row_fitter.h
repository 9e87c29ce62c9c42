// row_fitter.h: the Ward fit of rows of pixels: in batches, with Ceres for what the batches leave in doubt
// and for a sample by which both are compared; or with Ceres alone.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fit/pixel/batch_sampler.h"
#include "fit/pixel/lighting.h"
#include "fit/pixel/ward_batch.h"
#include "fit/pixel/ward_fit.h"
#include "fit/shadows/light_visibility.h"
#include "surface/render/cast_shadows.h"

namespace tangi {

enum class Solver {
    batch,  // many pixels at once, in floats; Ceres polishes and checks
    ceres,  // one pixel after the other, in doubles
};

// How batches and Ceres compare on pixels that both fitted.
struct SolverAgreement {
    long compared = 0;
    long cost_agrees = 0;   // final costs within 1 %
    long cheaper = 0;       // of the others: the batch's is lower
    long slope_agrees = 0;  // slopes within 0.01, about half a degree
    long doubtful = 0;      // pixels of the whole picture that batches left in doubt: fitted by Ceres
    long polished = 0;      // of those: Ceres' result was taken

    SolverAgreement& operator+=(const SolverAgreement& other);
};

// Whether a pixel is of the sample that Ceres fits as well: about 512 of a picture, at most every 16th.
bool is_compared(int x, int y, int width, int height);

// What is known of a pixel beside its samples; empty where nothing is.
struct PixelKnowledge {
    std::function<WardPrior(int x, int y)> prior;
    std::function<glm::dvec2(int x, int y)> stretch{};   // that of the prior
    const CastShadows* shadows = nullptr;                // of the relief of the whole painting
    std::function<Rgb(int x, int y)> specular_colour{};  // as Surface::specular_colour
    // As find_occluded_pixels(), of a surface on which the neighbours stand in for them.
    std::function<bool(int x, int y)> occluded{};
    // With `shadows`, to be filled in: what the surface as it is makes of the photographs.
    LightVisibility* lights = nullptr;
};

// What rows of pixels are fitted with beside their photographs: the same for all rows of a pass.
struct RowTask {
    const Surface& surface;
    const PixelKnowledge& known;
    const Image<unsigned char>& mask;  // pixels that are fitted; empty: all
    bool judged = true;                // with batches: whether Ceres has a say
    int tile = 0;  // [pixels] width of the tiles of which solvers are compared apart; 0: all are one
};

// Keeps its memory; one a thread. Keeps references to lighting and noise.
class RowFitter {
public:
    RowFitter(const WardFitOptions& options, Solver solver, const Lighting& lighting, const NoiseModel& noise,
              int channels);

    // Called for a pixel with its estimate.
    using Done = std::function<void(int x, int y, const WardEstimate&)>;
    // Fits rows y0 <= y < y1 of the band and calls `done` for each pixel that the task's mask has and that
    // could be fitted. A pixel's estimate does not depend on which rows it is fitted with.
    void fit(const Band& band, int y0, int y1, const RowTask& task, const Done& done);

    // What the photographs of the band say of a pixel; until the next call.
    PixelSamples& samples_at(const Band& band, int x, int y, const Surface& surface,
                             const PixelKnowledge& known);

    const std::vector<SolverAgreement>& agreement() const { return agreement_; }  // of each tile, or fewer

private:
    void fit_by_ceres(const Band& band, int y0, int y1, const RowTask& task, const Done& done);
    void fit_in_batches(const Band& band, int y0, int y1, const RowTask& task, const Done& done);
    // What batches made of rows y0 <= y < y1: given to `done`, once Ceres has judged it.
    void hand_out(const Band& band, int y0, int y1, const RowTask& task,
                  const std::vector<WardSolution>& solutions, const Done& done);
    WardEstimate by_ceres(const Band& band, int x, int y, const Surface& surface,
                          const PixelKnowledge& known);
    void start_row(const Band& band, int y, int first_name, const Image<unsigned char>& mask,
                   const Surface& surface, const PixelKnowledge& known);
    void look_at_row(const Band& band, int y, const Surface& surface, const PixelKnowledge& known);
    void divide_lane_by_specular_colour(const Rgb& colour, int lane);
    void shade(const CastShadows& shadows, const glm::ivec2& first, int count, int first_name);
    // Takes Ceres' estimate where the batches' is in doubt and dearer; counts how both compare.
    void judge(const Band& band, int x, int y, const RowTask& task, const WardSolution& solution,
               WardEstimate& estimate);
    // samples_at(), under lights of the colour of the lobe.
    PixelSamples& white_samples_at(const Band& band, int x, int y, const Surface& surface,
                                   const PixelKnowledge& known);
    WardPrior prior_at(int x, int y, const PixelKnowledge& known) const;
    // Fits those of `solutions` again for which `offer` has another start; names and what became of them.
    struct Offer {
        const PixelSamples* samples;
        WardPrior prior;
        WardStart start;
    };
    std::vector<int> fit_again(const Band& band, std::size_t count,
                               const std::function<std::optional<Offer>(int name)>& offer);
    void fit_by_highlight(const Band& band, int first, const Surface& surface, const PixelKnowledge& known,
                          std::vector<WardSolution>& solutions);
    // Whether a pixel may lie in more shade than its fit takes.
    bool may_be_shaded(int x, int y, bool explained, bool shaded, const PixelKnowledge& known) const;
    void fit_in_shade(const Band& band, int first, const RowTask& task, std::vector<WardSolution>& solutions);

    Solver solver_;
    const Lighting& lighting_;
    const NoiseModel& noise_;
    BatchSampler sampler_;
    WardFitter ceres_;
    WardBatchFitter batches_, again_;
    WardBatch batch_, other_batch_;
    bool highlights_, in_shade_;
    std::vector<bool> shaded_;  // of pixels as batches name them: relief that is known hides some light
    WardBounds bounds_;
    PixelSamples samples_;
    WardPrior prior_;
    std::vector<SolverAgreement> agreement_;
};

}  // namespace tangi
