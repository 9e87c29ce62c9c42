#include "capture/stack/profile_colours.h"

#include <lcms2.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "capture/stack/photo_profiles.h"

namespace tangi {

using glm::dmat3;
using glm::dvec3;

namespace {

constexpr double kSamePrimaries = 0.02;  // [1] of white, in any channel

using Profile = std::unique_ptr<void, cmsBool (*)(cmsHPROFILE)>;

Profile owned(cmsHPROFILE profile) {
    return {profile, [](cmsHPROFILE p) { return p ? cmsCloseProfile(p) : 1; }};
}

// XYZ under D50 of full red, green and blue.
std::optional<dmat3> colorants_of(const Profile& profile) {
    if (!profile) return {};
    dmat3 result;
    int column = 0;
    for (const cmsTagSignature tag : {cmsSigRedColorantTag, cmsSigGreenColorantTag, cmsSigBlueColorantTag}) {
        const auto* xyz = static_cast<const cmsCIEXYZ*>(
            cmsIsTag(profile.get(), tag) ? cmsReadTag(profile.get(), tag) : nullptr);
        if (!xyz) return {};
        result[column++] = {xyz->X, xyz->Y, xyz->Z};
    }
    const double volume = glm::determinant(result);
    return std::isfinite(volume) && std::abs(volume) > 1e-6 ? std::optional(result) : std::nullopt;
}

double largest_difference(const dmat3& a, const dmat3& b) {
    double most = 0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) most = std::max(most, std::abs(a[column][row] - b[column][row]));
    return most;
}

}  // namespace

std::optional<dmat3> to_camera_of_icc(std::string_view bytes) {
    // Complaints of the library would go to stderr; what is wrong shows in what is missing.
    cmsSetLogErrorHandler([](cmsContext, cmsUInt32Number, const char*) {});
    const auto own =
        colorants_of(owned(cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size()))));
    const auto rec709 = colorants_of(owned(cmsCreate_sRGBProfile()));
    if (!own || !rec709) return {};
    dmat3 to_camera = glm::inverse(*own) * *rec709;
    // Rounded colorants do not quite add up to D50.
    const dvec3 white = to_camera * dvec3(1);
    for (int column = 0; column < 3; ++column) to_camera[column] /= white;
    const bool usable = largest_difference(to_camera, dmat3(0)) < 10;
    if (!usable || largest_difference(to_camera, dmat3(1)) < kSamePrimaries) return {};
    return to_camera;
}

std::optional<CaptureColour> colour_of_profiles(const Stack& stack) {
    if (stack.channels != 3 || stack.is_raw || stack.photos.empty()) return {};
    std::optional<dmat3> common;
    for (const StackPhoto& photo : stack.photos) {
        const auto own = to_camera_of_icc(metadata_in(stack, photo.path).icc_profile);
        if (!own || (common && largest_difference(*own, *common) > kSamePrimaries)) return {};
        if (!common) common = own;
    }
    CaptureColour colour;
    colour.to_camera = *common;
    return colour;
}

}  // namespace tangi
