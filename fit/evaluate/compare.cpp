#include "fit/evaluate/compare.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capture/photo/rejected_photo.h"
#include "fit/evaluate/compared_lights.h"
#include "fit/evaluate/compared_motions.h"
#include "fit/evaluate/compared_whites.h"
#include "fit/pipeline/photo_prefetch.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/image/colour_rows.h"
#include "surface/render/relighter.h"
#include "surface/render/viewing_exposure.h"

namespace tangi {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kForeign =
    0.3;  // [1] median correlation; photographs of the same painting have more than 0.5

void require_comparable(const Surface& surface, const Stack& stack) {
    require_consistent(surface);
    if (surface.photography.photos.empty())
        fail(
            "this painting does not come from photographs: it holds no transfer curve and no lights, so it "
            "cannot be "
            "compared with {}; make one from them with: tangipaint fit",
            stack.folder.string());
    if (surface.width() != stack.width() || surface.height() != stack.height())
        fail(
            "{}: the photographs are {} x {}, the painting is {} x {}; give the photographs that it was "
            "fitted from, with the same crop and capture file; a preview has none of its size: fit it "
            "without --preview",
            stack.folder.string(), stack.width(), stack.height(), surface.width(), surface.height());
    if (stack.photos.empty() && stack.held_out.empty())
        fail("{}: no photographs to compare with", stack.folder.string());
}

PixelMask pixels_to_compare(const Surface& surface, const Stack& stack) {
    PixelMask mask = measured(surface.confidence);
    bool any = false;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        if (!stack.mask.empty() && !stack.mask.pixels()[i]) mask.pixels()[i] = 0;
        any = any || mask.pixels()[i];
    }
    if (!any)
        fail("{}: the painting was measured nowhere that its mask keeps: its confidence is 0",
             stack.folder.string());
    return mask;
}

// A mask less the pixels that a photograph does not reach.
PixelMask without_missing(PixelMask mask, const PixelMask& missing) {
    for (std::size_t i = 0; i < mask.size(); ++i)
        if (missing.pixels()[i]) mask.pixels()[i] = 0;
    return mask;
}

// Stored values as a camera makes them, by rows; `stored` has the size of `linear` or gets it.
void encode_picture(const Image<Rgb>& linear, const Transfer& transfer, const glm::mat3& colour,
                    Image<Rgb>& stored) {
    if (stored.region() != linear.region()) stored = Image<Rgb>(linear.width(), linear.height());
    parallel_for(0, linear.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const std::span<Rgb> row = stored.row(y);
            for (int x = 0; x < linear.width(); ++x) row[static_cast<std::size_t>(x)] = colour * linear(x, y);
            encode_row(transfer, row, row);
        }
    });
}

// What the camera would have stored under a light.
void relight_stored(const Relighter& relighter, const Light& light, const Transfer& transfer,
                    const glm::mat3& colour, Image<Rgb>& stored) {
    parallel_for(0, stored.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const std::span<Rgb> row = stored.row(y);
            relighter.draw_row(light, y, row);
            for (Rgb& value : row) value = colour * value;
            encode_row(transfer, row, row);
        }
    });
}

// What a camera with these channels saw of radiance in linear Rec. 709.
glm::mat3 exposure_of(const Photography& photography) {
    return static_cast<float>(photography.white_level) *
           glm::mat3(photography.to_camera.value_or(glm::dmat3(1)));
}

// [1] Pictures are compared as bright as people see them: floats in a unit of their own
// (fit/exchange/float_scale.h) would be all alike, or all wrong, beside a full scale of 1.
float unit_of(const Photography& photography, const Transfer& transfer) {
    if (transfer != Transfer{}) return 1;
    return static_cast<float>(viewing_exposure(photography.white_level) / photography.white_level);
}

// Files of floats hold linear light whatever the painting was fitted from.
Transfer encoding_of(const Stack& stack, const Photography& photography, std::vector<std::string>& warnings) {
    Transfer transfer = photography.transfer;
    if (stack.bits == 32) transfer = {};
    if (stack.transfer) transfer = *stack.transfer;
    if (transfer != photography.transfer)
        warnings.push_back(
            fmt::format("{}: compared as {}; the painting was fitted from photographs stored as {}",
                        stack.folder.string(), transfer.name(), photography.transfer.name()));
    return transfer;
}

PhotoComparison described(const StackPhoto& photo, const Photography& photography) {
    PhotoComparison result;
    result.name = photo.light.name;
    result.light = as_photographed(photo.light, photography);
    const Vec3& l = photo.light.direction;
    result.elevation_deg = std::asin(std::clamp(static_cast<double>(l.z), -1.0, 1.0)) / kDegree;
    result.azimuth_deg =
        std::fmod(std::atan2(static_cast<double>(l.y), static_cast<double>(l.x)) / kDegree + 360, 360);
    const Photography::Photo* known = find_photo(photography, photo.light);
    result.fitted = known && known->fitted;
    return result;
}

// CIEDE2000 of what was photographed and relit, from linear light.
void measure_colour(const ComparedPictures& pictures, Image<float>& delta_e) {
    const int width = delta_e.width();
    parallel_for(0, delta_e.height(), 8, [&](int begin, int end) {
        std::vector<Rgb> photo(static_cast<std::size_t>(width)), relit(photo.size());
        const auto decode = [&](std::span<const Rgb> stored, std::vector<Rgb>& linear) {
            decode_row(pictures.transfer, stored, linear);
            if (pictures.from_camera != glm::mat3(1))
                for (Rgb& value : linear) value = pictures.from_camera * value;
        };
        for (int y = begin; y < end; ++y) {
            decode(pictures.photo.row(y), photo);
            decode(pictures.relit.row(y), relit);
            delta_e_2000_row(photo, relit, delta_e.row(y));
        }
    });
}

void measure(const ComparedPictures& pictures, Image<float>& delta_e, PhotoComparison& result) {
    measure_colour(pictures, delta_e);
    result.psnr_db = std::min(psnr_db(pictures.photo, pictures.relit, pictures.mask), kPsnrCap_db);
    result.ssim = ssim(pictures.photo, pictures.relit, pictures.mask);
    result.delta_e_2000 = mean(delta_e, pictures.mask);
    result.delta_e_2000_p95 = percentile(delta_e, 0.95, pictures.mask);
    result.correlation = luma_correlation(pictures.photo, pictures.relit, pictures.mask);
    result.bias = mean_difference(pictures.photo, pictures.relit, pictures.mask);
}

template <class Wanted>
ComparisonMean mean_of(const std::vector<PhotoComparison>& photos, Wanted&& wanted) {
    ComparisonMean mean;
    for (const PhotoComparison& photo : photos) {
        if (!wanted(photo)) continue;
        ++mean.count;
        mean.psnr_db += photo.psnr_db;
        mean.ssim += photo.ssim;
        mean.delta_e_2000 += photo.delta_e_2000;
        if (photo.residual_psnr_db)
            mean.residual_psnr_db = mean.residual_psnr_db.value_or(0) + *photo.residual_psnr_db;
    }
    const double n = std::max(mean.count, 1);
    if (mean.residual_psnr_db) *mean.residual_psnr_db /= n;
    return {mean.count, mean.psnr_db / n, mean.ssim / n, mean.delta_e_2000 / n, mean.residual_psnr_db};
}

void summarise(const Stack& stack, int unknown, CompareReport& report) {
    report.held_out = mean_of(report.photos, [](const PhotoComparison& p) { return !p.fitted; });
    report.fitted = mean_of(report.photos, [](const PhotoComparison& p) { return p.fitted; });
    report.all = mean_of(report.photos, [](const PhotoComparison&) { return true; });
    report.worst =
        std::min_element(report.photos.begin(), report.photos.end(), [](const auto& a, const auto& b) {
            return a.psnr_db < b.psnr_db;
        })->name;
    if (unknown > 0)
        report.warnings.push_back(fmt::format(
            "{}: {} of {} photographs are not among those that the painting lists, by name and light: "
            "they count as held out, and their lights as predicted from those of the others",
            stack.folder.string(), unknown, report.photos.size()));
    std::vector<double> correlations;
    for (const PhotoComparison& photo : report.photos)
        if (photo.correlation) correlations.push_back(*photo.correlation);
    if (correlations.empty()) return;
    const double typical = median(std::move(correlations));
    if (typical < kForeign)
        report.foreign = fmt::format(
            "{}: the photographs and what the painting looks like under their lights have hardly anything "
            "but brightness in common (correlation {:.2f}, where photographs of the painting have 0.9): "
            "are they of another painting, or turned or cropped otherwise?",
            stack.folder.string(), typical);
}

// Photographs one after the other against the surface relit under their lights.
class Comparison {
public:
    Comparison(const Surface& surface, const Stack& stack, const CompareOptions& options,
               const Progress& progress, const RelightingResidual& residual);

    // Places photographs that the painting does not list where the relit pictures show it.
    void register_unlisted();
    // Those that cannot be read are rejected, with a warning.
    void compare_all(const ComparisonSink& sink);
    CompareReport summarised();

private:
    const Photography& photography() const { return surface_.photography; }
    std::string folder() const { return stack_.folder.string(); }
    void relight_as(const Light& light, Image<Rgb>& stored) const {
        relight_stored(relighter_, light, report_.transfer, exposure_, stored);
    }
    void relight_with_residual(const StoredPhoto& photo, const PixelMask& present, PhotoComparison& result);
    void compare_with(const StoredPhoto& photo, std::size_t i, const ComparisonSink& sink);

    const Surface& surface_;
    const Stack& stack_;
    const Progress& progress_;
    const RelightingResidual& residual_;
    CompareReport report_;
    const PixelMask mask_;
    std::vector<StackPhoto> all_;  // those of the stack, then its held-out ones
    int unlisted_ = 0;             // by the painting
    const RelightOptions relighting_;
    const Relighter relighter_;
    const float unit_;
    const glm::mat3 exposure_, from_camera_;
    std::vector<RejectedPhoto> rejected_;
    // Used for one photograph after the other.
    Image<Rgb> relit_, linear_, with_residual_;
    Image<float> delta_e_;
};

CompareReport started(const Surface& surface, const Stack& stack, const CompareOptions& options) {
    CompareReport report;
    report.width = surface.width();
    report.height = surface.height();
    report.options = options;
    report.options.light_radius_deg =
        light_radius_deg(surface, {.light_radius_deg = options.light_radius_deg});
    report.warnings = stack.warnings;
    report.transfer = encoding_of(stack, surface.photography, report.warnings);
    return report;
}

std::vector<StackPhoto> all_photographs(const Stack& stack) {
    std::vector<StackPhoto> all = stack.photos;
    all.insert(all.end(), stack.held_out.begin(), stack.held_out.end());
    return all;
}

Comparison::Comparison(const Surface& surface, const Stack& stack, const CompareOptions& options,
                       const Progress& progress, const RelightingResidual& residual)
    : surface_(surface),
      stack_(stack),
      progress_(progress),
      residual_(residual),
      report_(started(surface, stack, options)),
      mask_(pixels_to_compare(surface, stack)),
      all_(all_photographs(stack)),
      relighting_{.cast_shadows = options.cast_shadows, .light_radius_deg = options.light_radius_deg},
      relighter_(surface, relighting_, static_cast<int>(all_.size())),
      unit_(unit_of(surface.photography, report_.transfer)),
      exposure_(unit_ * exposure_of(surface.photography)),
      from_camera_(from_camera(surface.photography)),
      relit_(surface.width(), surface.height()),
      delta_e_(surface.width(), surface.height()) {}

void Comparison::register_unlisted() {
    for (StackPhoto& photo : all_) {
        const Photography::Photo* known = find_photo(photography(), photo.light);
        unlisted_ += known == nullptr;
        // As the fit registered it; others are registered below.
        if (known) photo.homography = known->homography;
    }
    report_.exchanged = says_lights_are_exchanged(all_, photography(), folder());
    // Under a light that is not theirs they would be laid elsewhere.
    if (unlisted_ == 0 || !report_.exchanged.empty()) return;
    const RelitPicture relit_under = [&](const StackPhoto& photo, Image<Rgb>& stored) {
        relight_as(as_photographed(photo.light, photography()), stored);
    };
    for (std::string& told :
         register_unknown(all_, stack_, photography(), report_.transfer, relit_under, progress_))
        report_.warnings.push_back(std::move(told));
}

void Comparison::compare_all(const ComparisonSink& sink) {
    PhotosAhead ahead(stack_, all_, unit_);
    for (std::size_t i = 0; i < all_.size(); ++i) {
        report(progress_, "compare", static_cast<double>(i) / static_cast<double>(all_.size()));
        const StoredPhoto* photo = nullptr;
        try {
            photo = &ahead.next();
        } catch (const PhotoError& error) {
            rejected_.push_back({all_[i].light.name, error.what()});
            report_.warnings.push_back(fmt::format("{}; rejected", error.what()));
            require_few(rejected_, all_.size(), 1, folder());
            continue;
        }
        compare_with(*photo, i, sink);
    }
}

// Fills in the relit picture, too.
void Comparison::relight_with_residual(const StoredPhoto& photo, const PixelMask& present,
                                       PhotoComparison& result) {
    // A residual is one of a picture with these shadows.
    const RelightOptions residuals_own{.cast_shadows = true, .light_radius_deg = residual_.light_radius_deg};
    const bool as_fitted =
        relighting_.cast_shadows && report_.options.light_radius_deg == residual_.light_radius_deg;
    linear_ = relight(surface_, {&result.light, 1}, relighting_);
    encode_picture(linear_, report_.transfer, exposure_, relit_);
    if (!as_fitted) linear_ = relight(surface_, {&result.light, 1}, residuals_own);
    add_residual(residual_, surface_, {&result.light, 1}, {}, linear_);
    encode_picture(linear_, report_.transfer, exposure_, with_residual_);
    result.residual_psnr_db = std::min(psnr_db(photo.picture, with_residual_, present), kPsnrCap_db);
}

void Comparison::compare_with(const StoredPhoto& photo, std::size_t i, const ComparisonSink& sink) {
    PhotoComparison result = described(all_[i], photography());
    const PixelMask fewer = photo.missing.empty() ? PixelMask() : without_missing(mask_, photo.missing);
    const PixelMask& present = fewer.empty() ? mask_ : fewer;
    if (residual_.empty())
        relight_as(result.light, relit_);
    else
        relight_with_residual(photo, present, result);
    // Told, and not undone: what a photograph is compared with owes nothing to it.
    if (!result.fitted && stack_.channels == 3) {
        const WhiteBalance white = white_balance_of(photo.picture, relit_, present, report_.transfer,
                                                    stack_.bits != 32, result.light.direction);
        if (white.differs) result.white_balance = glm::dvec2(white.gain().r, white.gain().b);
    }
    const ComparedPictures pictures{
        static_cast<int>(i), result,      photo.picture, relit_, delta_e_, present,
        report_.transfer,    from_camera_};
    measure(pictures, delta_e_, result);
    if (sink) sink(pictures);
    report_.photos.push_back(std::move(result));
}

CompareReport Comparison::summarised() {
    summarise(stack_, unlisted_, report_);
    if (std::string told = other_white_balances(report_, folder()); !told.empty())
        report_.warnings.push_back(std::move(told));
    report(progress_, "compare", 1);
    return std::move(report_);
}

}  // namespace

CompareReport compare(const Surface& surface, const Stack& photos, const CompareOptions& options,
                      const Progress& progress, const ComparisonSink& sink,
                      const RelightingResidual& residual) {
    validate(options);
    require_comparable(surface, photos);
    Comparison comparison(surface, photos, options, progress, residual);
    comparison.register_unlisted();
    comparison.compare_all(sink);
    return comparison.summarised();
}

Image<Rgb> as_photographed(const Image<Rgb>& linear, const Photography& photography) {
    Image<Rgb> stored;
    encode_picture(linear, photography.transfer, exposure_of(photography), stored);
    return stored;
}

void for_display(std::span<const Rgb> stored, const ComparedPictures& pictures, std::span<Rgb> shown) {
    constexpr Transfer srgb{Transfer::Kind::srgb};
    const bool true_colours = pictures.from_camera == glm::mat3(1);
    if (true_colours && pictures.transfer == srgb) {
        std::transform(stored.begin(), stored.end(), shown.begin(),
                       [](const Rgb& value) { return glm::clamp(value, 0.0f, 1.0f); });
        return;
    }
    decode_row(pictures.transfer, stored, shown);
    if (!true_colours)
        for (Rgb& value : shown) value = pictures.from_camera * value;
    encode_row(srgb, shown, shown);
}

Image<Rgb> for_display(const Image<Rgb>& stored, const ComparedPictures& pictures) {
    Image<Rgb> shown(stored.width(), stored.height());
    parallel_for(0, stored.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) for_display(stored.row(y), pictures, shown.row(y));
    });
    return shown;
}

}  // namespace tangi
