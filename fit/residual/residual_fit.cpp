#include "fit/residual/residual_fit.h"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "capture/stack/survey.h"
#include "fit/residual/residual_kernel.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"
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

// Linear values of one photograph; NaN where it does not reach. Grey becomes RGB.
Image<Rgb> linear_picture(const Stack& one, const Transfer& transfer) {
    StackReader reader(one);
    Image<Rgb> picture(one.width(), one.height());
    for (int y0 = 0; y0 < one.height(); y0 += kBandRows) {
        const Band band =
            reader.read(y0, std::min(y0 + kBandRows, one.height()), one.development ? Transfer{} : transfer);
        for (int y = y0; y < band.y1(); ++y)
            for (int c = 0; c < 3; ++c) {
                const float* row = band.row(0, std::min(c, one.channels - 1), y);
                for (int x = 0; x < one.width(); ++x) picture(x, y)[c] = row[x];
            }
    }
    return picture;
}

// A photograph less the surface relit, per irradiance, in the frame of the pixel's colour; and, where asked
// for, both at the samples.
Image<Vec3> residual_of(const Surface& surface, const FittedPhoto& photo, const Colours& colours,
                        std::span<const glm::ivec2> samples, Sampled* sampled) {
    const Image<Rgb> taken = linear_picture(photo.stack, colours.transfer);
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

// Principal components [photograph][term] of what the regression predicts at the photographs.
Matrix components_of(const Matrix& predicted, int most) {
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
    return components;
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
    report_.used = sum / n > std::max(options.residual_min_gain_db, kSureOfGain * report_.gain_error_db);
}

void require_fitted_from(const Surface& surface, const Stack& stack) {
    require_consistent(surface);
    if (surface.width() != stack.width() || surface.height() != stack.height())
        fail(
            "{}: the photographs are {} x {}, the painting is {} x {}; give the photographs that it was "
            "fitted from",
            stack.folder.string(), stack.width(), stack.height(), surface.width(), surface.height());
}

void require_enough(const std::vector<FittedPhoto>& photos, const Stack& stack) {
    if (photos.size() < kFewestForResidual)
        fail(
            "{}: {} photographs are too few for a residual over the light's direction, which needs {}; fit "
            "without "
            "--residual",
            stack.folder.string(), photos.size(), kFewestForResidual);
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
          positions_(sample_positions(surface, options.residual_samples)) {
        for (const FittedPhoto& photo : photos_) directions_.push_back(photo.light.direction);
    }
    ResidualFit run();

private:
    void sample_photographs();
    void sum_up(const Choice& choice, ResidualFit& result);

    const Surface& surface_;
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
        Image<Vec3> residual = residual_of(surface_, photos_[i], colours_, positions_, &sampled);
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
    const Matrix predicted = kernel * inverse * samples_.residual;
    const Matrix along = components_of(columns_of(predicted, true), options_.residual_terms);
    const Matrix across = components_of(columns_of(predicted, false), options_.residual_colour_terms);
    RelightingResidual& residual = result.residual;
    residual.kernel = choice.kernel;
    residual.reach = choice.reach;
    residual.light_radius_deg = light_radius_deg(surface_, {});
    residual.directions = directions_;
    residual.brightness_weights = rows_of(along.transpose() * inverse);
    residual.colour_weights = rows_of(across.transpose() * inverse);
    residual.brightness.assign(static_cast<std::size_t>(along.cols()),
                               Image<float>(surface_.width(), surface_.height()));
    residual.colour.assign(static_cast<std::size_t>(2 * across.cols()),
                           Image<float>(surface_.width(), surface_.height()));
    for (std::size_t i = 0; i < photos_.size(); ++i) {
        accumulate(!kept_.empty() ? kept_[i] : residual_of(surface_, photos_[i], colours_, {}, nullptr),
                   along, across, static_cast<Eigen::Index>(i), residual);
        report(progress_, "residual",
               0.5 + 0.5 * static_cast<double>(i + 1) / static_cast<double>(photos_.size()));
    }
    residual.dry_hash = hash_of(surface_);
    result.report.terms = static_cast<int>(along.cols());
    result.report.colour_terms = static_cast<int>(across.cols());
}

ResidualFit ResidualFitter::run() {
    ResidualFit result;
    if (positions_.empty()) return result;
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
    require_enough(photos, stack);
    return ResidualFitter(surface, stack, options, std::move(photos), progress).run();
}

nlohmann::json to_json(const ResidualReport& report) {
    return {{"used", report.used},
            {"kernel", name_of(report.kernel)},
            {"reach", report.reach},
            {"ridge", report.ridge},
            {"surface_db", report.surface_db},
            {"cv_psnr_db", report.cv_psnr_db},
            {"gain_error_db", report.gain_error_db},
            {"terms", report.terms},
            {"colour_terms", report.colour_terms},
            {"coefficients", report.terms + 2 * report.colour_terms}};
}

}  // namespace tangi
