// part_fitter.cpp: pixels of parts of a picture, by a plan.
#include "fit/pipeline/fit_lights.h"
#include "fit/pipeline/fit_plan.h"
#include "surface/base/error.h"
#include "surface/maps/surface_part.h"

namespace tangi {

namespace {

FitOptions with_white_level(FitOptions options, const std::optional<double>& white_level) {
    options.white_level = white_level;
    return options;
}

Stack columns_of(Stack stack, const Region& columns) {
    stack.mask = {};  // the parts have it
    stack.crop.x1 = stack.crop.x0 + columns.x1;
    stack.crop.x0 += columns.x0;
    return stack;
}

}  // namespace

struct PartFitter::State {
    State(const FitPlan& planned, const FitOptions& given, const Region& asked, int tile)
        : plan(planned),
          options(with_white_level(given, planned.white_level)),
          noise(noise_model(planned.stack, planned.transfer, options)),
          columns(asked),
          tile_width(tile),
          stack(columns_of(planned.stack, asked)),
          reader(stack),
          height_mm(enlarged_height(planned.first, planned.stack.width(), planned.stack.height())),
          refinement(planned.first, height_mm, options) {}

    const FitPlan& plan;
    FitOptions options;
    NoiseModel noise;
    Region columns;
    int tile_width;
    Stack stack;  // all rows
    StackReader reader;
    Image<float> height_mm;
    Refinement refinement;
};

PartFitter::PartFitter(const FitPlan& plan, const FitOptions& options, const Region& columns, int tile) {
    TP_REQUIRE(columns.x0 >= 0 && columns.x0 < columns.x1 && columns.x1 <= plan.stack.width() &&
                   columns.x0 % kMarchLanes == 0,
               "columns of the picture that begin with a run of pixels");
    state_ = std::make_unique<State>(plan, options, columns, tile);
}

PartFitter::~PartFitter() = default;

RefinedPixels PartFitter::fit(int y0, int y1, const std::vector<Region>& skipped, const Progress& progress) {
    const FitPlan& plan = state_->plan;
    TP_REQUIRE(y0 >= 0 && y0 < y1 && y1 <= plan.stack.height(), "rows of the picture");
    const Region part{state_->columns.x0, y0, state_->columns.x1, y1};
    Image<unsigned char> mask = plan.stack.mask.empty() ? Image<unsigned char>(part.width(), part.height(), 1)
                                                        : cut(plan.stack.mask, part);
    for (const Region& other : skipped)
        for (int y = std::max(other.y0, y0); y < std::min(other.y1, y1); ++y)
            for (int x = std::max(other.x0, part.x0); x < std::min(other.x1, part.x1); ++x)
                mask(x - part.x0, y - y0) = 0;
    FitResult result{Surface(part.width(), part.height()), FitErrors(part.width(), part.height()), {}};
    Surface& surface = result.surface;
    surface.reflectance_model = plan.described.reflectance_model;
    surface.mm_per_pixel = plan.described.mm_per_pixel;
    surface.part_of = PartOfPainting{part.x0, y0, static_cast<double>(plan.stack.width()),
                                     static_cast<double>(plan.stack.height())};
    Stack rows = state_->stack;
    rows.crop.y1 = rows.crop.y0 + y1;
    rows.crop.y0 += y0;
    const CalibratedStack input{rows, plan.transfer, state_->noise, plan.lighting, nullptr, &state_->reader,
                                y0};
    RefinedPixels pixels;
    pixels.counts = state_->refinement.fit(input, mask, state_->tile_width, result, pixels.lights, progress);
    pixels.surface = std::move(result.surface);
    pixels.errors = std::move(result.errors);
    return pixels;
}

}  // namespace tangi
