#include "fit/residual/residual_fit.h"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "capture/stack/reduced_photos.h"
#include "capture/stack/survey.h"
#include "fit/residual/residual_kernel.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"
#include "surface/maps/mean_material.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"

namespace tangi {

using namespace residual_kernel;

namespace {

// [sigma] The surface was fitted to the photographs that are left out here, so that the gain without them
// looks surer than it is.
constexpr double kSureOfGain = 2;

constexpr int kBandRows = 256;
constexpr std::size_t kKeptBytes = 256u << 20;  // of residual pictures
constexpr std::size_t kFewestForResidual = 8;
constexpr double kEnergyKept = 0.998;  // [1] of the predicted residual's, by the terms that are kept

// The photographs that were fitted, each as a stack of its own, and their light as the fit found it.
struct FittedPhoto {
    Stack stack;
    Light light;
};

std::vector<FittedPhoto> fitted_photos(const Surface& surface, const Stack& stack) {
    std::vector<FittedPhoto> photos;
    for (const StackPhoto& photo : stack.photos) {
        const Photography::Photo* known = find_photo(surface.photography, photo.light);
        if (!known || !known->fitted) continue;
        photos.push_back({stack, as_photographed(photo.light, surface.photography)});
        Stack& one = photos.back().stack;
        one.held_out.clear();
        one.photos = {photo};
        one.photos.front().homography = known->homography;
    }
    std::sort(photos.begin(), photos.end(), [](const FittedPhoto& a, const FittedPhoto& b) {
        return a.stack.photos.front().path < b.stack.photos.front().path;
    });
    return photos;
}

Colours colours_of(const Surface& surface, const Stack& stack) {
    const Photography& p = surface.photography;
    Colours colours;
    colours.to_photo = static_cast<float>(p.white_level) * glm::mat3(p.to_camera.value_or(glm::dmat3(1)));
    colours.from_photo = glm::inverse(colours.to_photo);
    colours.transfer = p.transfer;
    if (stack.development) {
        colours.clipped = stack.development->clipped;
    } else if (stack.bits != 32) {
        colours.clipped = p.transfer.decode(kClipped);
    }
    return colours;
}

// Linear values of one photograph, or of its blocks; NaN where it does not reach. Grey becomes RGB.
Image<Rgb> linear_picture(const Stack& one, const Transfer& transfer, int reduction) {
    StackReader reader(one);
    const Transfer decoded = one.development ? Transfer{} : transfer;
    ReducedPhotos reduced(one, reduction);
    Image<Rgb> picture(reduced.width(), reduced.height());
    const auto take = [&](const Band& band) {
        for (int y = band.y0(); y < band.y1(); ++y)
            for (int c = 0; c < 3; ++c) {
                const float* row = band.row(0, std::min(c, one.channels - 1), y);
                for (int x = 0; x < picture.width(); ++x) picture(x, y)[c] = row[x];
            }
    };
    for (int y0 = 0; y0 < one.height(); y0 += kBandRows) {
        const Band band =
            reader.read(y0, std::min(y0 + kBandRows, one.height()), reduction > 1 ? Transfer{} : decoded);
        if (reduction > 1) {
            reduced.add(band);
        } else {
            take(band);
        }
    }
    if (reduction > 1) take(reduced.read(0, reduced.height(), decoded));
    return picture;
}

// A photograph less the surface relit, per irradiance, in the frame of the pixel's colour; and, where asked
// for, both at the samples.
Image<Vec3> residual_of(const Surface& surface, int reduction, const FittedPhoto& photo,
                        const Colours& colours, std::span<const glm::ivec2> samples, Sampled* sampled) {
    const Image<Rgb> taken = linear_picture(photo.stack, colours.transfer, reduction);
    const Image<Rgb> relit = relight(surface, {&photo.light, 1}, {.cast_shadows = true});
    Image<Vec3> residual(surface.width(), surface.height(), Vec3(0));
    parallel_for(0, surface.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < surface.width(); ++x) {
                if (!(surface.confidence(x, y) > 0)) continue;
                const Rgb value = taken(x, y), predicted = colours.to_photo * relit(x, y);
                if (std::isnan(value.r + value.g + value.b)) continue;
                Rgb left = value - predicted;
                for (int c = 0; c < 3; ++c)
                    if (value[c] >= colours.clipped) left[c] = std::max(left[c], 0.0f);
                const Rgb irradiance =
                    incidence(photo.light, surface.point_mm(x, y), surface.photography.rig).irradiance;
                const Rgb reflected = colours.from_photo * left / irradiance;
                residual(x, y) = glm::transpose(colour_frame(surface.diffuse(x, y))) * reflected;
            }
    });
    if (sampled)
        for (const glm::ivec2& at : samples) {
            sampled->stored.push_back(taken(at.x, at.y));
            for (int c = 0; c < 3; ++c)
                if (float& v = sampled->stored.back()[c]; !std::isnan(v))
                    v = colours.transfer.encode(std::min(v, 1.0f));
            sampled->relit.push_back(colours.to_photo * relit(at.x, at.y));
            sampled->irradiance.push_back(
                incidence(photo.light, surface.point_mm(at.x, at.y), surface.photography.rig).irradiance);
        }
    return residual;
}

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

// Measured pixels spread evenly over the picture: the same ones when it is turned or mirrored.
std::vector<glm::ivec2> sample_positions(const Surface& surface, int count) {
    std::vector<glm::ivec2> measured;
    const double step = std::max(std::sqrt(static_cast<double>(surface.height_mm.size()) / count), 1.0);
    for (const int y : spread_over(surface.height(), step))
        for (const int x : spread_over(surface.width(), step))
            if (surface.confidence(x, y) > 0) measured.emplace_back(x, y);
    return measured;
}

// Few functions of the light's direction in place of what the regression of residuals x says: it predicts
// k(l)^T inverse x, which coefficients^T x and functions^T k(l) stand for.
struct FewFunctions {
    Matrix coefficients, functions;  // [photograph][term]
};

// By the principal components of what it predicts at the photographs, as bright as it is there: M = D K
// inverse X, of samples X, is about U U^T M.
FewFunctions few_functions(const Matrix& kernel, const Matrix& inverse, const Eigen::VectorXd& irradiance,
                           const Matrix& samples, int most) {
    const Matrix predicted = irradiance.asDiagonal() * (kernel * (inverse * samples));
    const SymmetricEigen found = symmetric_eigen(predicted * predicted.transpose());
    const Eigen::VectorXd energy = found.values.cwiseMax(0).reverse();
    double kept = 0;
    int terms = 0;
    while (terms < std::min<int>(most, static_cast<int>(energy.size())) && kept < kEnergyKept * energy.sum())
        kept += energy[terms++];
    Matrix components = found.vectors.rowwise().reverse().leftCols(terms);
    for (Eigen::Index t = 0; t < components.cols(); ++t) {  // their sign is arbitrary
        Eigen::Index largest = 0;
        components.col(t).cwiseAbs().maxCoeff(&largest);
        if (components(largest, t) < 0) components.col(t) *= -1;
    }
    const Matrix reached = inverse * (samples * predicted.transpose()) * components;
    return {inverse * (kernel * (irradiance.asDiagonal() * components)),
            reached * energy.head(terms).cwiseInverse().asDiagonal()};
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

void accumulate(const Image<Vec3>& residual, const Matrix& along, const Matrix& across, Eigen::Index photo,
                RelightingResidual& result) {
    parallel_for(0, residual.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const auto from = residual.row(y);
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
    // `surface` has blocks for pixels, of as many of the stack's a side.
    ResidualFitter(const Surface& surface, int reduction, const Stack& stack, const ResidualOptions& options,
                   std::vector<FittedPhoto> photos, const Progress& progress)
        : surface_(surface),
          reduction_(reduction),
          options_(options),
          photos_(std::move(photos)),
          progress_(progress),
          colours_(colours_of(surface, stack)),
          positions_(sample_positions(surface, options.residual_samples)) {
        for (const FittedPhoto& photo : photos_) directions_.push_back(photo.light.direction);
    }
    ResidualFit run();

private:
    void sample_photographs();
    void sum_up(const Choice& choice, ResidualFit& result);

    const Surface& surface_;
    const int reduction_;
    const ResidualOptions& options_;
    const std::vector<FittedPhoto> photos_;
    const Progress& progress_;
    const Colours colours_;
    const std::vector<glm::ivec2> positions_;
    std::vector<Vec3> directions_;
    Samples samples_;
    std::vector<Image<Vec3>> kept_;  // residuals of the photographs; empty where they take too much memory
};

void ResidualFitter::sample_photographs() {
    samples_.residual.resize(static_cast<Eigen::Index>(photos_.size()),
                             static_cast<Eigen::Index>(3 * positions_.size()));
    for (const glm::ivec2& at : positions_)
        samples_.to_rgb.push_back(colour_frame(surface_.diffuse(at.x, at.y)));
    const bool keep = photos_.size() * surface_.height_mm.size() * sizeof(Vec3) <= kKeptBytes;
    for (std::size_t i = 0; i < photos_.size(); ++i) {
        Sampled& sampled = samples_.photos.emplace_back();
        Image<Vec3> residual = residual_of(surface_, reduction_, photos_[i], colours_, positions_, &sampled);
        for (std::size_t j = 0; j < positions_.size(); ++j)
            for (int c = 0; c < 3; ++c)
                samples_.residual(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(3 * j) + c) =
                    residual(positions_[j].x, positions_[j].y)[c];
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
    residual.brightness.assign(residual.brightness_weights.size(),
                               Image<float>(surface_.width(), surface_.height()));
    residual.colour.assign(2 * residual.colour_weights.size(),
                           Image<float>(surface_.width(), surface_.height()));
    for (std::size_t i = 0; i < photos_.size(); ++i) {
        accumulate(
            !kept_.empty() ? kept_[i] : residual_of(surface_, reduction_, photos_[i], colours_, {}, nullptr),
            along.coefficients, across.coefficients, static_cast<Eigen::Index>(i), residual);
        report(progress_, "residual",
               0.5 + 0.5 * static_cast<double>(i + 1) / static_cast<double>(photos_.size()));
    }
    residual.reduction = reduction_;
    result.report.bytes = bytes_of(residual);
    result.report.terms = static_cast<int>(residual.brightness_weights.size());
    result.report.colour_terms = static_cast<int>(residual.colour_weights.size());
}

ResidualFit ResidualFitter::run() {
    ResidualFit result;
    result.report.reduction = reduction_;
    if (positions_.empty()) {
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
    ResidualFit result;
    if (photos.size() < kFewestForResidual) {
        result.report.why = fmt::format(
            "{} photographs are too few for a residual over the light's direction, which needs {}",
            photos.size(), kFewestForResidual);
        return result;
    }
    const int reduction = ReducedPhotos::reduction_for(surface.width(), surface.height());
    const Surface blocks = reduction > 1 ? reduced(surface, reduction) : Surface();
    result = ResidualFitter(reduction > 1 ? blocks : surface, reduction, stack, options, std::move(photos),
                            progress)
                 .run();
    if (result.report.used) result.residual.dry_hash = hash_of(surface);
    return result;
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

}  // namespace tangi
