#include "capture/transfer_metadata.h"

#include <lcms2.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "capture/photo_profiles.h"
#include "surface/error.h"

namespace tangi {

namespace {

constexpr double kSame = 0.01;       // [1] of full scale: curves that are taken for the same
constexpr double kContrary = 0.08;   // [1] from which on two curves contradict each other; sRGB and 2.2: 0.01
constexpr std::size_t kTelling = 7;  // photographs: of fewer, three numbers a pixel explain nearly all
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
    const Eigen::Vector3d t = squares.ldlt().solve(products);
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

// What all photographs state; empty where they do not agree.
struct Statement {
    std::optional<StatedTransfer> stated;
    std::string contradiction;
};

std::string in_words(const std::optional<StatedTransfer>& stated) {
    if (!stated) return "nothing";
    return fmt::format("{} ({})", stated->transfer ? stated->transfer->name() : "a curve of its own",
                       stated->source);
}

Statement statement_of(const Stack& stack) {
    Statement result;
    const StackPhoto* first = nullptr;
    for (const StackPhoto& photo : stack.photos) {
        const auto stated = transfer_of_metadata(metadata_in(stack, photo.path));
        if (!first) {
            first = &photo;
            result.stated = stated;
        } else if (in_words(stated) != in_words(result.stated)) {
            result.contradiction = fmt::format(
                "{}: {} says that it is stored as {}, {} says {}; metadata are not used, and the photographs "
                "should be "
                "stored alike",
                stack.folder.string(), first->path.filename().string(), in_words(result.stated),
                photo.path.filename().string(), in_words(stated));
            result.stated.reset();
            return result;
        }
    }
    return result;
}

void append(std::string& text, const std::string& more) { text += (text.empty() ? "" : "\n") + more; }

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

TransferEstimate decide_transfer(const Stack& stack, const Survey& survey) {
    TransferEstimate result = estimate_transfer(stack, survey);
    const bool given = result.source == "given" && !stack.transfer_of_chart && !stack.development;
    if (result.source != "estimated" && !given) return result;
    const Statement said = statement_of(stack);
    if (given) {
        const StatedTransfer* stated = said.stated && said.stated->binding ? &*said.stated : nullptr;
        if (stated && stated->transfer && difference(*stated->transfer, result.transfer) > kContrary)
            append(result.warning,
                   fmt::format("{}: stored as {} by the photographs' {}, but {} is given, which is used",
                               stack.folder.string(), stated->transfer->name(), stated->source,
                               result.transfer.name()));
        return result;
    }
    if (!said.contradiction.empty()) append(result.warning, said.contradiction);
    if (!said.stated) return result;
    const std::string& source = said.stated->source;
    if (!said.stated->transfer) {
        append(result.warning,
               fmt::format(
                   "{}: the tone curve of the photographs' {} is neither linear, nor sRGB, nor a gamma, nor "
                   "smooth, and is "
                   "not used; {} was estimated from the photographs; convert them to linear light or sRGB",
                   stack.folder.string(), source, result.transfer.name()));
        return result;
    }
    const Transfer stated = *said.stated->transfer;
    const bool contrary =
        difference(stated, result.transfer) > kContrary && speaks_against(stated, result, stack, survey);
    if (!said.stated->binding && contrary) {
        append(
            result.warning,
            fmt::format("{}: the photographs' {} says {}, but they look like {}, which is used; cameras and "
                        "programs write the former blindly; if it is right, say so with --transfer {}",
                        stack.folder.string(), source, stated.name(), result.transfer.name(), stated.name()));
        return result;
    }
    if (contrary && stack.photos.size() >= kTelling)
        result.warning = fmt::format(
            "{}: stored as {} by the photographs' {}, which is used, but they look like {}, as photographs "
            "under near or unequal lamps can; only where the profile is known to be wrong, say so with "
            "--transfer {}",
            stack.folder.string(), stated.name(), source, result.transfer.name(), result.transfer.name());
    else
        result.warning.clear();
    result.doubt.clear();  // what was doubtful is settled
    result.transfer = stated;
    result.source = source;
    return result;
}

}  // namespace tangi
