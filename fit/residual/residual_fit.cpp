#include "fit/residual/residual_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "capture/stack/reduced_photos.h"
#include "fit/residual/photo_residuals.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"

namespace tangi {

using namespace residual_kernel;

namespace {

// [sigma] The surface was fitted to the photographs that are left out here, so that the gain without them
// looks surer than it is.
constexpr double kSureOfGain = 2;

constexpr std::size_t kKeptBytes = 256u << 20;  // of residual pictures
constexpr std::size_t kFewestForResidual = 8;

// An even number of places among so many pixels, about a step apart, the same from either end.
std::vector<int> spread_over(int pixels, double step) {
    const int half = std::max(static_cast<int>(std::lround(pixels / (2 * step))), 1);
    std::vector<int> places;
    for (int i = 0; i < half; ++i) places.push_back(static_cast<int>((i + 0.5) * pixels / (2 * half)));
    for (int i = half - 1; i >= 0; --i) {
        const int other = pixels - 1 - places[static_cast<std::size_t>(i)];
        if (other != places.back()) places.push_back(other);
    }
    return places;
}

// Blocks with measured middles spread evenly over the picture: the same ones when it is turned or mirrored.
std::vector<glm::ivec2> sample_positions(const Surface& surface, const Blocks& blocks, int count) {
    std::vector<glm::ivec2> measured;
    const double all = blocks.width * static_cast<double>(blocks.height);
    const double step = std::max(std::sqrt(all / count), 1.0);
    for (const int y : spread_over(blocks.height, step))
        for (const int x : spread_over(blocks.width, step)) {
            const glm::ivec2 at = blocks.middle(x, y);
            if (surface.confidence(at.x, at.y) > 0) measured.emplace_back(x, y);
        }
    return measured;
}

// Columns of the samples' residuals along (component 0) or across (1 and 2) the pixel's colour.
Matrix columns_of(const Matrix& residual, bool along) {
    const auto samples = residual.cols() / 3;
    Matrix result(residual.rows(), along ? samples : 2 * samples);
    for (Eigen::Index j = 0; j < samples; ++j)
        if (along) {
            result.col(j) = residual.col(3 * j);
        } else {
            result.col(2 * j) = residual.col(3 * j + 1);
            result.col(2 * j + 1) = residual.col(3 * j + 2);
        }
    return result;
}

// [1] Of each photograph, over the samples and channels.
Eigen::VectorXd mean_irradiance(const Samples& samples) {
    Eigen::VectorXd means(static_cast<Eigen::Index>(samples.photos.size()));
    for (Eigen::Index i = 0; i < means.size(); ++i) {
        const std::vector<Rgb>& all = samples.photos[static_cast<std::size_t>(i)].irradiance;
        Rgb sum(0);
        for (const Rgb& value : all) sum += value;
        means[i] = static_cast<double>(sum.r + sum.g + sum.b) / (3 * static_cast<double>(all.size()));
    }
    return means;
}

RelightingResidual::Weights rows_of(const Matrix& m) {
    RelightingResidual::Weights rows;
    for (Eigen::Index t = 0; t < m.rows(); ++t) {
        rows.emplace_back();
        for (Eigen::Index i = 0; i < m.cols(); ++i) rows.back().push_back(m(t, i));
    }
    return rows;
}

void accumulate(const Image<BlockResidual>& residual, const Matrix& along, const Matrix& across,
                Eigen::Index photo, RelightingResidual& result) {
    parallel_for(0, residual.height(), 8, [&](int begin, int end) {
        std::vector<Vec3> from(static_cast<std::size_t>(residual.width()));
        for (int y = begin; y < end; ++y) {
            std::ranges::transform(residual.row(y), from.begin(), &BlockResidual::value);
            const auto add = [&](Image<float>& map, double weight, int component) {
                const float w = static_cast<float>(weight);
                const auto to = map.row(y);
                for (std::size_t x = 0; x < from.size(); ++x) to[x] += w * from[x][component];
            };
            for (std::size_t t = 0; t < result.brightness.size(); ++t)
                add(result.brightness[t], along(photo, static_cast<Eigen::Index>(t)), 0);
            for (std::size_t t = 0; t < result.colour.size(); ++t)
                add(result.colour[t], across(photo, static_cast<Eigen::Index>(t / 2)),
                    1 + static_cast<int>(t % 2));
        }
    });
}

void compare_with(const Choice& choice, const Samples& s, const Colours& colours,
                  const ResidualOptions& options, ResidualReport& report_) {
    const double n = static_cast<double>(s.photos.size());
    double sum = 0, square = 0;
    for (std::size_t i = 0; i < s.photos.size(); ++i) {
        const double alone = psnr_with(s, colours, i, [](std::size_t) { return Vec3(0); });
        const double gain = choice.photos_db[i] - alone;
        report_.surface_db += alone / n;
        sum += gain;
        square += gain * gain;
    }
    report_.kernel = choice.kernel;
    report_.reach = choice.reach;
    report_.ridge = choice.ridge;
    report_.cv_psnr_db = choice.mean_db;
    report_.gain_error_db = std::sqrt(std::max(square / n - sum * sum / (n * n), 0.0) / std::max(n - 1, 1.0));
    const double enough = std::max(options.residual_min_gain_db, kSureOfGain * report_.gain_error_db);
    report_.used = sum / n > enough;
    if (!report_.used)
        report_.why = fmt::format(
            "a residual predicts validation photographs no better than the surface alone: by {:.2f} dB, "
            "where "
            "{:.2f} dB would count",
            sum / n, enough);
}

void require_fitted_from(const Surface& surface, const Stack& stack) {
    require_consistent(surface);
    if (surface.width() != stack.width() || surface.height() != stack.height())
        fail(
            "{}: the photographs are {} x {}, the painting is {} x {}; give the photographs that it was "
            "fitted from",
            stack.folder.string(), stack.width(), stack.height(), surface.width(), surface.height());
}

// The fit of the residual: photographs are sampled, a kernel is chosen, and then all pixels are summed up.
class ResidualFitter {
public:
    ResidualFitter(const Surface& surface, const Stack& stack, const ResidualOptions& options,
                   std::vector<FittedPhoto> photos, const Progress& progress)
        : surface_(surface),
          options_(options),
          photos_(std::move(photos)),
          progress_(progress),
          colours_(colours_of(surface, stack)),
          blocks_(surface, ReducedPhotos::reduction_for(surface.width(), surface.height())),
          residuals_(surface, blocks_, colours_, sample_positions(surface, blocks_, options.residual_samples),
                     static_cast<int>(photos_.size())) {
        for (const FittedPhoto& photo : photos_) directions_.push_back(photo.light.direction);
    }
    ResidualFit run();

private:
    void sample_photographs();
    void sum_up(const Choice& choice, ResidualFit& result);
    Image<float> empty_map() const { return Image<float>(blocks_.width, blocks_.height); }

    const Surface& surface_;
    const ResidualOptions& options_;
    const std::vector<FittedPhoto> photos_;
    const Progress& progress_;
    const Colours colours_;
    const Blocks blocks_;
    const Residuals residuals_;
    std::vector<Vec3> directions_;
    Samples samples_;
    std::vector<Image<BlockResidual>>
        kept_;  // residuals of the photographs; empty where they take too much memory
};

void ResidualFitter::sample_photographs() {
    const std::vector<glm::ivec2>& positions = residuals_.samples();
    samples_.residual.resize(static_cast<Eigen::Index>(photos_.size()),
                             static_cast<Eigen::Index>(3 * positions.size()));
    for (const glm::ivec2& block : positions) {
        const glm::ivec2 at = blocks_.middle(block.x, block.y);
        samples_.to_rgb.push_back(colour_frame(surface_.diffuse(at.x, at.y)));
    }
    const bool keep = photos_.size() * empty_map().size() * sizeof(BlockResidual) <= kKeptBytes;
    for (std::size_t i = 0; i < photos_.size(); ++i) {
        Image<BlockResidual> residual = residuals_.of(photos_[i], &samples_.photos.emplace_back());
        for (std::size_t j = 0; j < positions.size(); ++j)
            for (int c = 0; c < 3; ++c)
                samples_.residual(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(3 * j) + c) =
                    residual(positions[j].x, positions[j].y).value()[c];
        if (keep) kept_.push_back(std::move(residual));
        report(progress_, "residual", 0.4 * static_cast<double>(i + 1) / static_cast<double>(photos_.size()));
    }
}

void ResidualFitter::sum_up(const Choice& choice, ResidualFit& result) {
    const Matrix kernel = kernel_matrix(directions_, choice.kernel, choice.reach);
    const Matrix inverse = inverse_of(kernel, choice.ridge);
    const Eigen::VectorXd irradiance = mean_irradiance(samples_);
    const FewFunctions along = few_functions(kernel, inverse, irradiance, columns_of(samples_.residual, true),
                                             options_.residual_terms);
    const FewFunctions across = few_functions(
        kernel, inverse, irradiance, columns_of(samples_.residual, false), options_.residual_colour_terms);
    RelightingResidual& residual = result.residual;
    residual.kernel = choice.kernel;
    residual.reach = choice.reach;
    residual.light_radius_deg = light_radius_deg(surface_, {});
    residual.directions = directions_;
    residual.brightness_weights = rows_of(along.functions.transpose());
    residual.colour_weights = rows_of(across.functions.transpose());
    residual.reduction = blocks_.side;
    residual.brightness.assign(residual.brightness_weights.size(), empty_map());
    residual.colour.assign(2 * residual.colour_weights.size(), empty_map());
    for (std::size_t i = 0; i < photos_.size(); ++i) {
        accumulate(kept_.empty() ? residuals_.of(photos_[i], nullptr) : kept_[i], along.coefficients,
                   across.coefficients, static_cast<Eigen::Index>(i), residual);
        report(progress_, "residual",
               0.5 + 0.5 * static_cast<double>(i + 1) / static_cast<double>(photos_.size()));
    }
    residual.dry_hash = hash_of(surface_);
    result.report.bytes = bytes_of(residual);
    result.report.terms = static_cast<int>(residual.brightness_weights.size());
    result.report.colour_terms = static_cast<int>(residual.colour_weights.size());
}

ResidualFit ResidualFitter::run() {
    ResidualFit result;
    result.report.reduction = blocks_.side;
    if (residuals_.samples().empty()) {
        result.report.why = "no pixel was fitted";
        return result;
    }
    sample_photographs();
    const Choice choice = choose_kernel(samples_, colours_, directions_, progress_);
    compare_with(choice, samples_, colours_, options_, result.report);
    if (result.report.used) sum_up(choice, result);
    return result;
}

}  // namespace

ResidualFit fit_residual(const Surface& surface, const Stack& stack, const ResidualOptions& options,
                         const Progress& progress) {
    validate(options);
    require_fitted_from(surface, stack);
    std::vector<FittedPhoto> photos = fitted_photos(surface, stack);
    if (photos.size() < kFewestForResidual) {
        ResidualFit result;
        result.report.why = fmt::format(
            "{} photographs are too few for a residual over the light's direction, which needs {}",
            photos.size(), kFewestForResidual);
        return result;
    }
    return ResidualFitter(surface, stack, options, std::move(photos), progress).run();
}

nlohmann::json to_json(const ResidualReport& report) {
    if (!report.used && report.cv_psnr_db == 0) return {{"used", false}, {"why", report.why}};
    return {{"used", report.used},
            {"why", report.why},
            {"reduction", report.reduction},
            {"kernel", name_of(report.kernel)},
            {"reach", report.reach},
            {"ridge", report.ridge},
            {"surface_db", report.surface_db},
            {"cv_psnr_db", report.cv_psnr_db},
            {"gain_error_db", report.gain_error_db},
            {"terms", report.terms},
            {"colour_terms", report.colour_terms},
            {"coefficients", report.terms + 2 * report.colour_terms},
            {"bytes", report.bytes}};
}

ResidualFit try_residual(Surface& surface, const Stack& stack, const ResidualOptions& options,
                         std::vector<std::string>& warnings, const Progress& progress) {
    ResidualFit residual;
    try {
        residual = fit_residual(surface, stack, options, progress);
    } catch (const Error& error) {
        warnings.push_back(fmt::format("no residual is stored: {}", error.what()));
        residual.report.why = error.what();
    }
    if (!residual.report.used) surface.provenance = with_residual_in_vain(surface.provenance);
    return residual;
}

}  // namespace tangi
