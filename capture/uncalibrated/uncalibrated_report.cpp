#include "capture/uncalibrated/uncalibrated_report.h"

#include <algorithm>

#include "capture/photo/photo_metadata.h"
#include "capture/photo/stated_transfer.h"
#include "capture/stack/grey_photos.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"
#include "surface/report/html_report.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kReducedPixels = 128 * 128;  // of a reduced picture
constexpr float kBlack = 0.02f;                    // [1] as stored: brighter nowhere

Transfer transfer_for(const PhotoSet& set, const UncalibratedStackOptions& options,
                      std::vector<std::string>& warnings) {
    if (set.developed()) return {};
    if (options.transfer) return *options.transfer;
    if (const auto stated = transfer_of_metadata(set.metadata(0)); stated && stated->transfer)
        return *stated->transfer;
    warnings.push_back(fmt::format(
        "{}: does not say how it is encoded; taken to be linear light, give --transfer if it is not",
        set.folder().string()));
    return {};
}

std::string figure(const Image<glm::vec2>& slopes, const fs::path& scratch, const std::string& caption) {
    const Image<float> relief = relief_picture(slopes);
    Image<Rgb> picture(relief.width(), relief.height());
    for (std::size_t i = 0; i < relief.size(); ++i) picture.pixels()[i] = Rgb(relief.pixels()[i]);
    return fmt::format(
        "<figure class=\"card\"><img src=\"{}\" width=\"360\" "
        "alt=\"relief\"><figcaption>{}</figcaption></figure>",
        picture_url(picture, scratch), caption);
}

}  // namespace

UncalibratedStack calibrate_uncalibrated(const PhotoSet& set, const UncalibratedStackOptions& options,
                                         const Progress& progress) {
    UncalibratedStack result;
    SphereCalibration& c = result.calibration;
    const GreyPhotos photos = read_grey_photos(set, progress, set.size() * kReducedPixels);
    require_same_subject(set, find_camera_motions(photos, progress));
    result.transfer = transfer_for(set, options, c.warnings);
    c.method = "uncalibrated";
    c.width = photos.width, c.height = photos.height;
    c.origin_px = {(photos.width - 1) / 2.0, (photos.height - 1) / 2.0};
    c.camera.principal_px = c.origin_px;
    c.drifts.photos.resize(set.size());
    std::vector<Image<float>> pictures;
    for (std::size_t i = 0; i < set.size(); ++i) {
        CalibratedLight& light = c.lights.emplace_back();
        light.path = set.path(i);
        light.name = set.name(i);
        const auto stored = photos.mean[i].pixels();
        if (*std::max_element(stored.begin(), stored.end()) < kBlack) {
            light.reason = "black";
            continue;
        }
        Image<float>& picture = pictures.emplace_back(photos.mean[i]);
        for (float& value : picture.pixels()) value = result.transfer.decode(value);
    }
    const std::string folder = set.folder().string();
    try {
        // Where one pixel of a square is clipped, its mean is a little below that.
        result.found = uncalibrated_lights(pictures, result.transfer.decode(kClipped),
                                           {.inverted = options.inverted}, progress);
    } catch (const Error& error) {
        fail("{}: {}", folder, error.what());
    }
    std::size_t next = 0;
    for (CalibratedLight& light : c.lights) {
        if (!light.reason.empty()) continue;
        light.direction = result.found.directions[next];
        light.direction_sigma_deg = result.found.sigma_deg[next++];
    }
    for (const std::string& warning : result.found.warnings) c.poor.push_back(folder + ": " + warning);
    return result;
}

std::string readings_section(const UncalibratedLights& found, const fs::path& scratch) {
    Image<glm::vec2> other = found.slopes;
    for (glm::vec2& slope : other.pixels()) slope = -slope;
    return "<h2>Hills or valleys</h2><p>No photograph tells a relief from its inverse under lights on the "
           "other side. If the second picture is right, calibrate again with <code>--inverted</code> added, "
           "or "
           "without it if it was given. Both are drawn as if lit from the top left.</p><div class=\"row\">" +
           figure(found.slopes, scratch, "<b>As written to the lights file</b>") +
           figure(other, scratch, "<b>The other reading</b>") + "</div>";
}

}  // namespace tangi
