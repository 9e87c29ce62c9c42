#include "capture/stack/stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "capture/photo/brackets.h"
#include "capture/photo/photo_folder.h"
#include "capture/stack/open_screened.h"
#include "capture/stack/photo_matching.h"
#include "capture/stack/photo_profiles.h"
#include "capture/stack/photo_screening.h"
#include "capture/stack/stack_calibration.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_rows.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFewestPhotos = 4;  // that photometric stereo needs

// Exposures in units of one that is the same for all lights: the median. A bracket's `path` is the photograph
// nearest to it.
void relate_to_reference(std::vector<StackPhoto>& photos) {
    std::vector<double> all;
    for (const StackPhoto& photo : photos)
        for (const Exposure& exposure : photo.exposures) all.push_back(exposure.relative);
    if (all.empty()) return;
    std::sort(all.begin(), all.end());
    const double reference = all[(all.size() - 1) / 2];
    for (StackPhoto& photo : photos) {
        double nearest = std::numeric_limits<double>::infinity();
        for (Exposure& exposure : photo.exposures) {
            exposure.relative /= reference;
            if (const double off = std::abs(std::log(exposure.relative)); off < nearest) {
                nearest = off;
                photo.path = exposure.path;
            }
        }
    }
}

void leave_out_lights_from_below(Stack& stack, const fs::path& lights_path,
                                 std::vector<RejectedPhoto>& rejected) {
    std::vector<std::string> below;
    std::vector<StackPhoto> kept;
    for (StackPhoto& photo : stack.photos) {
        if (photo.light.direction.z > 0) {
            kept.push_back(std::move(photo));
            continue;
        }
        const double z = photo.light.direction.z;
        below.push_back(fmt::format("{} (z = {:.4f})", photo.light.name, z));
        rejected.push_back(
            {photo.light.name,
             fmt::format("{}: its light comes from below the painting's plane (z = {:.4f}); correct it there",
                         lights_path.string(), z)});
    }
    stack.photos = std::move(kept);
    if (below.empty()) return;
    if (below.size() > stack.photos.size())
        fail(
            "{}: {} of {} lights come from below the painting (z < 0): {}. z must point towards the camera; "
            "if all are negative, the file uses the opposite sign",
            lights_path.string(), below.size(), below.size() + stack.photos.size(), joined(below));
    stack.warnings.push_back(
        fmt::format("{}: rejected {} photograph{} lit from below the painting's plane: {}",
                    lights_path.string(), below.size(), below.size() == 1 ? "" : "s", joined(below)));
}

// Opens every photograph once, so that the first bad one is named before any work is done.
void check_headers(Stack& stack) {
    std::optional<PhotoHeader> first;
    std::string name;
    std::map<std::string, std::vector<std::string>> doubted;  // by doubt: files
    for (const StackPhoto& photo : stack.photos)
        for (const fs::path& path : files_of(photo)) {
            const PhotoHeader header = PhotoFile(path).header();
            if (!first) first = header, name = path.filename().string();
            if (const std::string why = difference(header, *first, name); !why.empty())
                fail("{}: {}", path.string(), why);
            for (const std::string& doubt : header.doubts) doubted[doubt].push_back(path.filename().string());
        }
    for (const auto& [doubt, names] : doubted)
        stack.warnings.push_back(fmt::format(
            "{}: {}{}", (stack.folder / names.front()).string(), doubt,
            names.size() == 1 ? std::string() : fmt::format(" (so {} of the photographs)", names.size())));
    if (first->orientation != 1)
        stack.warnings.push_back(
            fmt::format("{}: the EXIF orientation ({}) is not applied; lights and maps are in the frame of "
                        "the stored pixels",
                        stack.folder.string(), first->orientation));
    stack.channels = first->channels;
    stack.bits = first->bits;
    stack.is_raw = first->is_raw;
    stack.says_linear = first->says_linear;
    stack.orientation = first->orientation;
    stack.crop = {0, 0, first->width, first->height};
}

// Pixels that are not square: normals are right, which lights alone tell, and all that is measured along the
// rows is not. Resampling would hide that the entry itself is wrong, as of scanners and editors it often is.
std::string doubt_of_pixels(const Stack& stack) {
    if (stack.is_raw || stack.photos.empty()) return {};
    const double aspect = static_cast<double>(PictureRows(stack.photos.front().path).content().pixel_aspect);
    if (!(aspect > 0) || !(std::abs(aspect - 1) > kSquarePixels)) return {};
    return fmt::format(
        "{}: pixels that are {:.3g} times as wide as they are high are taken for squares: lengths along the "
        "rows are off by that factor, and heights with them, where slopes of 45° become {:.0f}°; resample "
        "the photographs to square pixels, or correct that entry",
        stack.photos.front().path.string(), aspect, std::atan(1 / aspect) * 180 / std::numbers::pi);
}

void apply_crop(Stack& stack, const Region& crop) {
    if (crop.empty() || crop.x0 < 0 || crop.y0 < 0 || crop.x1 > stack.crop.x1 || crop.y1 > stack.crop.y1)
        fail("the crop {},{} to {},{} does not lie in the {} of {}, which are {} x {}", crop.x0, crop.y0,
             crop.x1, crop.y1, stack.geometry ? "rectified photographs" : "photographs",
             stack.folder.string(), stack.crop.x1, stack.crop.y1);
    stack.crop = crop;
}

// The mask is a picture like a photograph; where these are resampled, so is it.
void apply_mask(Stack& stack, const fs::path& path, const Region& photo) {
    // Before it is unpacked: another picture may be of any size.
    if (const PictureContent size = PictureRows(path).content();
        size.width != photo.width() || size.height != photo.height())
        fail("{}: the mask is {} x {}, the photographs are {} x {}", path.string(), size.width, size.height,
             photo.width(), photo.height());
    const Image<float> picture = read_photo_mask(path);
    stack.mask = Image<unsigned char>(stack.width(), stack.height());
    bool any = false;
    for (int y = 0; y < stack.height(); ++y)
        for (int x = 0; x < stack.width(); ++x) {
            glm::dvec2 place(x + stack.crop.x0, y + stack.crop.y0);
            if (stack.geometry) place = glm::round(stack.geometry->place_in_photo(place));
            if (!(place.x >= 0 && place.y >= 0 && place.x < picture.width() && place.y < picture.height()))
                continue;
            const bool keep = picture(static_cast<int>(place.x), static_cast<int>(place.y)) > 0.5f;
            stack.mask(x, y) = keep;
            any = any || keep;
        }
    if (!any)
        fail("{}: the mask leaves nothing of the picture; white marks what is to be fitted", path.string());
}

}  // namespace

std::vector<Light> Stack::lights() const {
    std::vector<Light> result;
    for (const StackPhoto& photo : photos) result.push_back(photo.light);
    return result;
}

namespace {

Stack photographs_of(const std::vector<fs::path>& paths, const StackOptions& options) {
    TP_REQUIRE(!paths.empty(), "there are photographs");
    Stack stack;
    stack.folder = paths.front().parent_path();
    stack.develop = options.develop;
    stack.transfer = options.transfer;
    Brackets brackets;
    if (options.develop.brackets == "auto") {
        std::vector<std::string> names;
        for (const fs::path& path : paths) {
            std::string name = path.stem().string();
            name.erase(name.find_last_not_of("0123456789") + 1);
            if (name.size() > 1 && (name.back() == '_' || name.back() == '-')) {
                name.pop_back();
                if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
            }
        }
        brackets = find_brackets(paths, names);
        if (brackets.empty())
            fail(
                "{}: no light has several photographs NAME_1, NAME_2 …; name them so, or list them in a file "
                "with --brackets FILE",
                stack.folder.string());
    } else if (options.develop.brackets) {
        brackets = read_brackets(*options.develop.brackets, stack.folder);
    }
    std::set<fs::path> in_brackets;
    const auto add = [&](const fs::path& path, const std::string& name, std::vector<Exposure> exposures) {
        stack.photos.push_back({path,
                                distant_light({0, 0, 1}, name),
                                static_cast<int>(stack.photos.size()),
                                {},
                                std::move(exposures)});
    };
    for (const auto& [name, files] : brackets) {
        for (const BracketFile& file : files) in_brackets.insert(file.path.lexically_normal());
        const std::vector<Exposure> exposures = exposures_of(name, files);
        add(exposures.front().path, name, exposures);
    }
    for (const fs::path& path : paths)
        if (!in_brackets.contains(path.lexically_normal())) add(path, path.filename().string(), {});
    relate_to_reference(stack.photos);
    return stack;
}

// `usable`: null where all photographs must be usable.
UsableStack opened(const fs::path& folder, const StackOptions& options, const UsableOptions* usable) {
    require_folder(folder);
    UsableStack result;
    Stack& stack = result.stack;
    stack.folder = folder;
    stack.develop = options.develop;
    StackCalibration calibration =
        read_stack_calibration(folder, options, usable ? usable->light_axes : LightAxes{});
    stack.warnings = calibration.warnings;
    result.poor = calibration.poor;
    PhotoMatch match = match_photos(folder, options.develop, calibration, usable == nullptr);
    stack.photos = std::move(match.photos);
    stack.warnings.insert(stack.warnings.end(), match.warnings.begin(), match.warnings.end());
    result.lights_by_order = match.by_order;
    relate_to_reference(stack.photos);
    if (usable) {
        result.rejected = calibration.rejected;
        result.rejected.insert(result.rejected.end(), match.rejected.begin(), match.rejected.end());
        tell(match.rejected, 0, stack.warnings);
        leave_out_unusable(stack, result.rejected);
        if (!usable->any_loss || stack.photos.empty())
            require_few(result.rejected, stack.photos.size() + result.rejected.size(), kFewestPhotos,
                        folder.string());
    }
    leave_out_lights_from_below(stack, calibration.lights_path, result.rejected);
    check_headers(stack);
    relate_profiles(stack);
    if (std::string doubt = doubt_of_pixels(stack); !doubt.empty()) result.poor.push_back(std::move(doubt));
    const Region photo = stack.crop;
    apply_geometry(stack, calibration);
    if (options.crop) apply_crop(stack, *options.crop);
    stack.transfer = options.transfer;
    apply_calibration(stack, calibration);
    if (options.mask_file)
        apply_mask(stack, *options.mask_file, photo);
    else if (usable && usable->finds_mask &&
             (result.found_mask = mask_among(match.masks, photo, stack.warnings)))
        apply_mask(stack, *result.found_mask, photo);
    return result;
}

}  // namespace

Stack open_photographs(const std::vector<fs::path>& paths, const StackOptions& options) {
    Stack stack = photographs_of(paths, options);
    check_headers(stack);
    relate_profiles(stack);
    return stack;
}

Stack open_usable_photographs(const std::vector<fs::path>& paths, const StackOptions& options,
                              std::vector<RejectedPhoto>& rejected) {
    Stack stack = photographs_of(paths, options);
    leave_out_unusable(stack, rejected);
    require_few(rejected, stack.photos.size() + rejected.size(), 1, stack.folder.string());
    check_headers(stack);
    relate_profiles(stack);
    return stack;
}

Stack open_stack(const fs::path& folder, const StackOptions& options) {
    return opened(folder, options, nullptr).stack;
}

UsableStack open_usable_stack(const fs::path& folder, const StackOptions& options,
                              const UsableOptions& usable) {
    return opened(folder, options, &usable);
}

}  // namespace tangi
