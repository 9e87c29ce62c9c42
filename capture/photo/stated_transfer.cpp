#include "capture/photo/stated_transfer.h"

#include <lcms2.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr double kSame = 0.01;  // [1] of full scale: curves that are taken for the same
constexpr int kSteps = 256;

Transfer gamma_of(double gamma) {
    return {Transfer::Kind::gamma, std::round(std::clamp(gamma, 0.2, 5.0) * 1000) / 1000};
}

template <class Curve>
double distance(const Curve& curve, const Transfer& transfer) {
    double most = 0;
    for (int i = 0; i <= kSteps; ++i) {
        const float stored = static_cast<float>(i) / kSteps;
        most = std::max(most, std::abs(static_cast<double>(curve(stored) - transfer.decode(stored))));
    }
    return most;
}

// Transfer::Kind::curve by least squares of linear values: their logarithms over ln e are a parabola of e.
template <class Curve>
Transfer curve_through(const Curve& curve) {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d products = Eigen::Vector3d::Zero();
    for (int i = 1; i < kSteps; ++i) {
        const double e = i / static_cast<double>(kSteps), linear = static_cast<double>(curve(float(e)));
        if (!(linear > 0)) continue;
        const double weight = std::pow(linear * std::log(e), 2);  // an error of the exponent in linear light
        const Eigen::Vector3d terms(1, e, e * e);
        squares += weight * terms * terms.transpose();
        products += weight * std::log(linear) / std::log(e) * terms;
    }
    const Eigen::Vector3d t = solve_symmetric(squares, products).x;
    const auto rounded = [](double v) { return std::round(v * 1000) / 1000; };
    Transfer result{Transfer::Kind::curve, rounded(t[0])};
    result.bend = rounded(t[1]), result.bow = rounded(t[2]);
    return result;
}

std::optional<Transfer> named_curve(const cmsToneCurve* curve) {
    const auto value = [&](float stored) { return cmsEvalToneCurveFloat(curve, stored); };
    Transfer best;
    double least = distance(value, best);
    const auto offer = [&](const Transfer& transfer, double handicap) {
        if (const double d = distance(value, transfer); d * handicap < least) {
            best = transfer;
            least = d;
        }
    };
    offer({Transfer::Kind::srgb}, 1);
    // The gamma through the middle; one that fits as badly as sRGB is sRGB rounded to 8 bits, not a gamma.
    if (const float middle = value(0.5f); middle > 0 && middle < 1)
        offer(gamma_of(std::log(static_cast<double>(middle)) / std::log(0.5)), 1.5);
    // What is none of these may be as smooth: CIE L*, as of eciRGB v2.
    if (least > kSame)
        if (const Transfer smooth = curve_through(value); smooth.is_increasing()) offer(smooth, 1);
    return least <= kSame ? std::optional(best) : std::nullopt;
}

}  // namespace

double difference(const Transfer& a, const Transfer& b) {
    return distance([&](float stored) { return a.decode(stored); }, b);
}

std::optional<Transfer> transfer_of_icc(std::string_view bytes) {
    // Complaints of the library would go to stderr; what is wrong shows in what is missing.
    cmsSetLogErrorHandler([](cmsContext, cmsUInt32Number, const char*) {});
    const std::unique_ptr<void, cmsBool (*)(cmsHPROFILE)> profile(
        cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())),
        [](cmsHPROFILE p) { return p ? cmsCloseProfile(p) : 1; });
    if (!profile) return std::nullopt;
    const auto curve = [&](cmsTagSignature tag) {
        return static_cast<const cmsToneCurve*>(cmsIsTag(profile.get(), tag) ? cmsReadTag(profile.get(), tag)
                                                                             : nullptr);
    };
    if (const cmsToneCurve* grey = curve(cmsSigGrayTRCTag)) return named_curve(grey);
    std::optional<Transfer> common;
    for (const cmsTagSignature tag : {cmsSigGreenTRCTag, cmsSigRedTRCTag, cmsSigBlueTRCTag}) {
        const cmsToneCurve* found = curve(tag);
        const auto transfer = found ? named_curve(found) : std::nullopt;
        if (!transfer || (common && difference(*common, *transfer) > kSame)) return std::nullopt;
        if (!common) common = transfer;
    }
    return common;
}

std::optional<StatedTransfer> transfer_of_metadata(const PhotoMetadata& m) {
    constexpr Transfer srgb{Transfer::Kind::srgb};
    if (!m.icc_profile.empty()) return StatedTransfer{transfer_of_icc(m.icc_profile), "ICC profile", true};
    // sRGB files carry a gAMA chunk of 1/2.2 for old readers (ISO/IEC 15948, 11.3.3.5).
    const bool gamma_of_srgb = m.png_gamma && std::abs(*m.png_gamma - 1 / 2.2) < 0.005;
    if (m.png_srgb) return StatedTransfer{srgb, "PNG sRGB chunk", false};
    if (m.png_gamma && !gamma_of_srgb)
        return StatedTransfer{std::abs(*m.png_gamma - 1) < 0.005 ? Transfer{} : gamma_of(1 / *m.png_gamma),
                              "PNG gAMA chunk", true};
    if (gamma_of_srgb) return StatedTransfer{srgb, "PNG gAMA chunk", false};
    if (m.exif_colour == 1) return StatedTransfer{srgb, "EXIF ColorSpace", false};
    return std::nullopt;
}

}  // namespace tangi
