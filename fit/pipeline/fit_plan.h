// fit_plan.h: a fit in steps, for pictures of any size and any number of machines: what is found once, of all
// photographs; the pixels, part by part; and what is made of all of them.
//
// fit_painting() takes the same steps of a large picture (refinement.h), and its result has the same bits.
#pragma once

#include "fit/pipeline/fit_painting.h"
#include "fit/pipeline/refinement.h"

namespace tangi {

// All that pixels are fitted by, and all that is known of the photographs.
struct FitPlan {
    Stack stack;  // photographs that are used, as registered; their lights' gains have their white balance
    Transfer transfer{};
    Lighting lighting{};  // as the camera sees it, of stack.photos
    Survey survey{};
    Surface described{};                  // of the painting, without its maps
    std::optional<double> white_level{};  // FitOptions::white_level, or what is found instead
    FirstFit first{};                     // its report has all that the photographs tell
};

// Steps 3 to 7 of docs/developer/architecture.md, and the passes over the reduced photographs. Memory: that
// of these, which have a megapixel at most, of 6 bytes a photograph and pixel. Throws as fit_painting().
FitPlan plan_fit(Stack stack, const FitOptions& options = {}, const Progress& progress = {});

// Pixels of a painting, or of a part of it, as fitted by a plan.
struct RefinedPixels {
    Surface surface;
    FitErrors errors;
    LightVisibility lights{0, 0, 0};   // without runs
    std::vector<PassCounts> counts{};  // of tiles
};

// Fits parts of a picture by a plan, whose stack can be read. Parts must be asked for from the top to the
// bottom.
class PartFitter {
public:
    // `columns`: y0 and y1 do not count; x0 is a multiple of kMarchLanes.
    // `tile`: [pixels] width of the tiles that are counted apart, from x0 on.
    PartFitter(const FitPlan& plan, const FitOptions& options, const Region& columns, int tile);
    ~PartFitter();
    PartFitter(const PartFitter&) = delete;
    PartFitter& operator=(const PartFitter&) = delete;

    // Rows y0 <= y < y1 of the columns. `skipped`: parts of them that nobody asks for.
    RefinedPixels fit(int y0, int y1, const std::vector<Region>& skipped = {}, const Progress& progress = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

// `pixels`: all of the picture. Throws as fit_painting().
FitResult finish_fit(FitPlan plan, const FitOptions& options, RefinedPixels pixels,
                     const Progress& progress = {});

}  // namespace tangi
