#include "fit/compare.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capture/left_out.h"
#include "surface/error.h"
#include "surface/parallel.h"
#include "surface/relight.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr int kBandRows = 256;  // decoded at once
constexpr double kDegree = std::numbers::pi / 180;

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
            "fitted from, "
            "with the same crop and capture file",
            stack.folder.string(), stack.width(), stack.height(), surface.width(), surface.height());
    if (stack.photos.empty() && stack.held_out.empty())
        fail("{}: no photographs to compare with", stack.folder.string());
}

Mask pixels_to_compare(const Surface& surface, const Stack& stack) {
    Mask mask = measured(surface.confidence);
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

// The one photograph of a stack, values as stored; grey becomes RGB.
Image<Rgb> stored_picture(const Stack& stack) {
    StackReader reader(stack);
    Image<Rgb> picture(stack.width(), stack.height());
    for (int y0 = 0; y0 < stack.height(); y0 += kBandRows) {
        const Band band = reader.read(y0, std::min(y0 + kBandRows, stack.height()), Transfer{});
        for (int y = y0; y < band.y1(); ++y)
            for (int c = 0; c < 3; ++c) {
                const float* row = band.row(0, std::min(c, stack.channels - 1), y);
                for (int x = 0; x < stack.width(); ++x) picture(x, y)[c] = row[x];
            }
    }
    return picture;
}

// A mask less the pixels that a registered photograph does not reach (NaN), which become black.
Mask without_missing(Mask mask, Image<Rgb>& photo) {
    for (std::size_t i = 0; i < photo.size(); ++i) {
        Rgb& value = photo.pixels()[i];
        if (!std::isnan(value.r + value.g + value.b)) continue;
        value = Rgb(0);
        mask.pixels()[i] = 0;
    }
    return mask;
}

Image<Rgb> decoded(const Image<Rgb>& stored, const Transfer& transfer) {
    Image<Rgb> linear(stored.width(), stored.height());
    parallel_for(0, stored.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < stored.width(); ++x)
                for (int c = 0; c < 3; ++c)
                    linear(x, y)[c] = transfer.decode(std::min(stored(x, y)[c], 1.0f));
    });
    return linear;
}

Image<Rgb> encoded(const Image<Rgb>& linear, const Transfer& transfer, const glm::mat3& colour) {
    Image<Rgb> stored(linear.width(), linear.height());
    parallel_for(0, linear.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < linear.width(); ++x)
                stored(x, y) = glm::min(transfer.encode(colour * linear(x, y)), Rgb(1));
    });
    return stored;
}

// Multiplies every colour.
Image<Rgb> recoloured(Image<Rgb> linear, const glm::mat3& colour) {
    for (Rgb& value : linear.pixels()) value = colour * value;
    return linear;
}

// What a camera with these channels saw of radiance in linear Rec. 709.
glm::mat3 exposure_of(const Photography& photography) {
    return static_cast<float>(photography.white_level) *
           glm::mat3(photography.to_camera.value_or(glm::dmat3(1)));
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

void measure(const ComparedPictures& pictures, Image<float>& delta_e, PhotoComparison& result) {
    delta_e = delta_e_2000_map(recoloured(decoded(pictures.photo, pictures.transfer), pictures.from_camera),
                               recoloured(decoded(pictures.relit, pictures.transfer), pictures.from_camera));
    result.psnr_db = std::min(psnr_db(pictures.photo, pictures.relit, pictures.mask), kPsnrCap_db);
    result.ssim = ssim(pictures.photo, pictures.relit, pictures.mask);
    result.delta_e_2000 = mean(delta_e, pictures.mask);
    result.delta_e_2000_p95 = percentile(delta_e, 0.95, pictures.mask);
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
        if (photo.faithful_psnr_db)
            mean.faithful_psnr_db = mean.faithful_psnr_db.value_or(0) + *photo.faithful_psnr_db;
    }
    const double n = std::max(mean.count, 1);
    if (mean.faithful_psnr_db) *mean.faithful_psnr_db /= n;
    return {mean.count, mean.psnr_db / n, mean.ssim / n, mean.delta_e_2000 / n, mean.faithful_psnr_db};
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
            "they count as held out, and their lights as of gain 1",
            stack.folder.string(), unknown, report.photos.size()));
}

// Names come from file systems, where any bytes are allowed; JSON wants UTF-8.
std::string valid_utf8(const std::string& text) {
    const std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
    return json::parse(quoted).get<std::string>();
}

}  // namespace

CompareReport compare(const Surface& surface, const Stack& photos, const CompareOptions& options,
                      const Progress& progress, const ComparisonSink& sink,
                      const FaithfulResidual& residual) {
    validate(options);
    require_comparable(surface, photos);
    CompareReport report_;
    report_.width = surface.width();
    report_.height = surface.height();
    report_.options = options;
    report_.warnings = photos.warnings;
    report_.transfer = encoding_of(photos, surface.photography, report_.warnings);
    const Mask mask = pixels_to_compare(surface, photos);

    std::vector<StackPhoto> all = photos.photos;
    all.insert(all.end(), photos.held_out.begin(), photos.held_out.end());
    Stack one = photos;  // one photograph is open at a time
    one.held_out.clear();
    const RelightOptions relighting{.cast_shadows = options.cast_shadows,
                                    .light_radius_deg = options.light_radius_deg};
    int unknown = 0;
    std::vector<LeftOut> left_out;
    for (std::size_t i = 0; i < all.size(); ++i) {
        report(progress, "compare", static_cast<double>(i) / static_cast<double>(all.size()));
        one.photos = {all[i]};
        const Photography::Photo* known = find_photo(surface.photography, all[i].light);
        unknown += known == nullptr;
        // As the fit registered it; a photograph that the painting does not know is taken as it is.
        if (known) one.photos.front().homography = known->homography;
        PhotoComparison result = described(all[i], surface.photography);
        Image<Rgb> photo;
        try {
            photo = stored_picture(one);
        } catch (const PhotoError& error) {
            left_out.push_back({all[i].light.name, error.what()});
            report_.warnings.push_back(fmt::format("{}; left out", error.what()));
            require_few(left_out, all.size(), 1, photos.folder.string());
            continue;
        }
        const Mask present = without_missing(mask, photo);
        Image<Rgb> linear = relight(surface, {&result.light, 1}, relighting);
        const Image<Rgb> relit = encoded(linear, report_.transfer, exposure_of(surface.photography));
        if (!residual.empty()) {
            add_residual(residual, surface, {&result.light, 1}, {}, linear);
            const Image<Rgb> faithful = encoded(linear, report_.transfer, exposure_of(surface.photography));
            result.faithful_psnr_db = std::min(psnr_db(photo, faithful, present), kPsnrCap_db);
        }
        Image<float> delta_e;
        const ComparedPictures pictures{static_cast<int>(i),
                                        result,
                                        photo,
                                        relit,
                                        delta_e,
                                        present,
                                        report_.transfer,
                                        glm::mat3(from_camera(surface.photography))};
        measure(pictures, delta_e, result);
        if (sink) sink(pictures);
        report_.photos.push_back(std::move(result));
    }
    summarise(photos, unknown, report_);
    report(progress, "compare", 1);
    return report_;
}

json to_json(const CompareReport& report) {
    json photos = json::array();
    for (const PhotoComparison& p : report.photos) {
        const Vec3& l = p.light.direction;
        photos.push_back({{"name", valid_utf8(p.name)},
                          {"fitted", p.fitted},
                          {"light", {l.x, l.y, l.z}},
                          {"elevation_deg", p.elevation_deg},
                          {"azimuth_deg", p.azimuth_deg},
                          {"psnr_db", p.psnr_db},
                          {"ssim", p.ssim},
                          {"delta_e_2000", p.delta_e_2000},
                          {"delta_e_2000_p95", p.delta_e_2000_p95},
                          {"bias", p.bias}});
        if (p.faithful_psnr_db) photos.back()["faithful_psnr_db"] = *p.faithful_psnr_db;
    }
    const auto mean = [](const ComparisonMean& m) {
        const auto number = [&](double value) { return m.count > 0 ? json(value) : json(nullptr); };
        json means = {{"count", m.count},
                      {"psnr_db", number(m.psnr_db)},
                      {"ssim", number(m.ssim)},
                      {"delta_e_2000", number(m.delta_e_2000)}};
        if (m.faithful_psnr_db) means["faithful_psnr_db"] = *m.faithful_psnr_db;
        return means;
    };
    json warnings = json::array();
    for (const std::string& warning : report.warnings) warnings.push_back(valid_utf8(warning));
    return {
        {"photos", std::move(photos)},
        {"mean",
         {{"held_out", mean(report.held_out)}, {"fitted", mean(report.fitted)}, {"all", mean(report.all)}}},
        {"worst", valid_utf8(report.worst)},
        {"transfer", report.transfer.name()},
        {"width", report.width},
        {"height", report.height},
        {"options", to_json<CompareOptions>(report.options)},
        {"warnings", std::move(warnings)}};
}

Image<Rgb> as_photographed(const Image<Rgb>& linear, const Photography& photography) {
    return encoded(linear, photography.transfer, exposure_of(photography));
}

Image<Rgb> for_display(const Image<Rgb>& stored, const ComparedPictures& pictures) {
    return encoded(decoded(stored, pictures.transfer), {Transfer::Kind::srgb}, pictures.from_camera);
}

}  // namespace tangi
