#include "capture/stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "capture/brackets.h"
#include "capture/lights_file.h"
#include "capture/raw_file.h"
#include "capture/stack_calibration.h"
#include "capture/usable_stack.h"
#include "surface/error.h"
#include "surface/parallel.h"
#include "surface/picture_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

// Photographs in a folder, by name.
std::vector<fs::path> photos_in(const fs::path& folder) {
    std::vector<fs::path> photos;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && is_photo_name(entry.path()) &&
            !entry.path().filename().string().starts_with('.'))
            photos.push_back(entry.path());
    std::sort(photos.begin(), photos.end());
    return photos;
}

// Windows programs write their folders with backslashes.
fs::path portable(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return fs::path(name);
}

// The photograph that a lights file means by `name`, tried from the strictest reading to the loosest.
std::optional<fs::path> match(const std::string& name, const fs::path& folder,
                              const std::vector<fs::path>& photos) {
    const fs::path listed = portable(name);
    std::error_code ignored;
    if (fs::is_regular_file(folder / listed, ignored)) return folder / listed;
    std::vector<fs::path> same_stem;
    for (const fs::path& photo : photos) {
        if (lower(photo.filename().string()) == lower(listed.filename().string())) return photo;
        if (lower(photo.stem().string()) == lower(listed.stem().string())) same_stem.push_back(photo);
    }
    if (same_stem.size() == 1) return same_stem.front();
    // Cameras store a JPEG beside each raw, of the same name.
    if (std::count_if(same_stem.begin(), same_stem.end(), is_raw_name) == 1)
        return *std::find_if(same_stem.begin(), same_stem.end(), is_raw_name);
    return std::nullopt;
}

Brackets brackets_of(const std::optional<std::string>& asked, const fs::path& folder,
                     const std::vector<fs::path>& photos, const std::vector<Light>& lights) {
    if (!asked) return {};
    std::vector<std::string> names;
    for (const Light& light : lights) names.push_back(light.name);
    if (*asked == "auto") {
        Brackets found = find_brackets(photos, names);
        if (found.empty())
            fail(
                "{}: no light has several photographs NAME_1, NAME_2 …; name them so, or list them in a file "
                "with "
                "--brackets FILE",
                folder.string());
        return found;
    }
    Brackets listed = read_brackets(*asked, folder);
    for (const auto& [name, files] : listed)
        if (std::find(names.begin(), names.end(), name) == names.end())
            fail("{}: '{}' is no light of the lights file", *asked, name);
    return listed;
}

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

void match_photos(Stack& stack, const std::vector<Light>& lights, const fs::path& lights_path) {
    const std::vector<fs::path> photos = photos_in(stack.folder);
    const Brackets brackets = brackets_of(stack.develop.brackets, stack.folder, photos, lights);
    std::vector<std::string> missing;
    std::map<fs::path, std::string> used;
    for (int number = 0; number < static_cast<int>(lights.size()); ++number) {
        const Light& light = lights[static_cast<std::size_t>(number)];
        const auto bracket = brackets.find(light.name);
        if (bracket != brackets.end()) {
            for (const BracketFile& file : bracket->second)
                used.emplace(file.path.lexically_normal(), light.name);
            const std::vector<Exposure> exposures = exposures_of(light.name, bracket->second);
            stack.photos.push_back({exposures.front().path, light, number, {}, exposures});
            continue;
        }
        const auto photo = match(light.name, stack.folder, photos);
        if (!photo) {
            missing.push_back(light.name);
            continue;
        }
        const auto [earlier, is_new] =
            used.emplace(photo->lexically_normal(), light.name);  // "./name" is "name"
        if (!is_new)
            fail("{}: '{}' and '{}' both mean the photograph {}", lights_path.string(), earlier->second,
                 light.name, earlier->first.string());
        stack.photos.push_back({*photo, light, number, {}, {}});
    }
    if (stack.photos.empty() && photos.size() == lights.size() && !photos.empty()) {
        for (std::size_t i = 0; i < photos.size(); ++i)
            stack.photos.push_back({photos[i], lights[i], static_cast<int>(i), {}, {}});
        if (lights.front().name.empty()) {
            for (StackPhoto& photo : stack.photos) photo.light.name = photo.path.filename().string();
            stack.warnings.push_back(fmt::format(
                "{}: does not name photographs; its lights are taken in the order of the file names in "
                "{}",
                lights_path.string(), stack.folder.string()));
            return;
        }
        stack.warnings.push_back(fmt::format(
            "{}: none of its names ('{}', …) is a photograph in {}; lights are taken in the order of the "
            "file names",
            lights_path.string(), lights.front().name, stack.folder.string()));
        return;
    }
    if (lights.front().name.empty())
        fail(
            "{}: has {} lights and does not name photographs, of which there are {} in {}; leave as many "
            "there, in "
            "the order of the lights",
            lights_path.string(), lights.size(), photos.size(), stack.folder.string());
    if (!missing.empty())
        fail("{}: {} of {} listed photographs are not in {}: {}. Put them there, or remove their lines",
             lights_path.string(), missing.size(), lights.size(), stack.folder.string(), joined(missing));
    relate_to_reference(stack.photos);
    std::vector<std::string> unlisted;
    for (const fs::path& photo : photos)
        if (!used.contains(photo.lexically_normal())) unlisted.push_back(photo.filename().string());
    if (!unlisted.empty())
        stack.warnings.push_back(fmt::format("{}: {} photographs are not listed in {} and not used: {}",
                                             stack.folder.string(), unlisted.size(),
                                             lights_path.filename().string(), joined(unlisted)));
}

void leave_out_lights_from_below(Stack& stack, const fs::path& lights_path) {
    std::vector<std::string> below;
    std::vector<StackPhoto> kept;
    for (StackPhoto& photo : stack.photos) {
        if (photo.light.direction.z > 0)
            kept.push_back(std::move(photo));
        else
            below.push_back(fmt::format("{} (z = {:.4f})", photo.light.name, photo.light.direction.z));
    }
    stack.photos = std::move(kept);
    if (below.empty()) return;
    if (below.size() > stack.photos.size())
        fail(
            "{}: {} of {} lights come from below the painting (z < 0): {}. z must point towards the camera; "
            "if all "
            "are negative, the file uses the opposite sign",
            lights_path.string(), below.size(), below.size() + stack.photos.size(), joined(below));
    stack.warnings.push_back(
        fmt::format("{}: left out {} photograph{} lit from below the painting's plane: {}",
                    lights_path.string(), below.size(), below.size() == 1 ? "" : "s", joined(below)));
}

std::string described(const PhotoHeader& header) {
    return fmt::format("{} x {}, {}", header.width, header.height, header.channels == 1 ? "grey" : "colour");
}

std::vector<fs::path> files_of(const std::vector<StackPhoto>& photos) {
    std::vector<fs::path> files;
    for (const StackPhoto& photo : photos) {
        if (photo.exposures.empty()) files.push_back(photo.path);
        for (const Exposure& exposure : photo.exposures) files.push_back(exposure.path);
    }
    return files;
}

void leave_out_damaged(Stack& stack) {
    std::string first;
    std::erase_if(stack.photos, [&](const StackPhoto& photo) {
        for (const fs::path& path : files_of({photo})) try {
                PhotoFile(path).header();
            } catch (const Error& error) {
                if (first.empty()) first = error.what();
                stack.warnings.push_back(fmt::format("left out: {}", error.what()));
                return true;
            }
        return false;
    });
    if (stack.photos.empty() && !first.empty()) throw Error(first);
}

// Opens every photograph once, so that the first bad one is named before any work is done.
void check_headers(Stack& stack) {
    std::optional<PhotoHeader> first;
    const std::vector<fs::path> files = files_of(stack.photos);
    for (const fs::path& path : files) {
        const PhotoHeader header = PhotoFile(path).header();
        if (!first) first = header;
        if (header.width != first->width || header.height != first->height)
            fail("{}: is {}, but {} is {}; all photographs of a stack must have the same size", path.string(),
                 described(header), files.front().filename().string(), described(*first));
        if (header.channels != first->channels)
            fail("{}: is {}, but {} is {}; convert it, or remove it from the lights file", path.string(),
                 described(header), files.front().filename().string(), described(*first));
        if (header.bits != first->bits || header.is_float != first->is_float ||
            header.is_raw != first->is_raw)
            fail(
                "{}: has {} bits a sample{}, but {} has {}{}; all photographs of a stack must be stored "
                "alike",
                path.string(), header.bits, header.is_raw ? " (raw)" : "", files.front().filename().string(),
                first->bits, first->is_raw ? " (raw)" : "");
        if (header.orientation != first->orientation)
            fail("{}: its EXIF orientation is {}, that of {} is {}; turn the photographs alike first",
                 path.string(), header.orientation, files.front().filename().string(), first->orientation);
    }
    if (first->orientation != 1)
        stack.warnings.push_back(
            fmt::format("{}: the EXIF orientation ({}) is not applied; lights and maps are in the frame of "
                        "the stored pixels",
                        stack.folder.string(), first->orientation));
    stack.channels = first->channels;
    stack.bits = first->bits;
    stack.is_raw = first->is_raw;
    stack.crop = {0, 0, first->width, first->height};
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
    const Image<Rgb> picture = read_picture(path);
    if (picture.region() != photo)
        fail("{}: the mask is {} x {}, the photographs are {} x {}", path.string(), picture.width(),
             picture.height(), photo.width(), photo.height());
    stack.mask = Image<unsigned char>(stack.width(), stack.height());
    bool any = false;
    for (int y = 0; y < stack.height(); ++y)
        for (int x = 0; x < stack.width(); ++x) {
            glm::dvec2 place(x + stack.crop.x0, y + stack.crop.y0);
            if (stack.geometry) place = glm::round(stack.geometry->place_in_photo(place));
            if (!(place.x >= 0 && place.y >= 0 && place.x < picture.width() && place.y < picture.height()))
                continue;
            const Rgb& value = picture(static_cast<int>(place.x), static_cast<int>(place.y));
            const bool keep = std::max({value.r, value.g, value.b}) > 0.5f;
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

Stack open_photographs(const std::vector<fs::path>& paths, const StackOptions& options) {
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
    check_headers(stack);
    return stack;
}

namespace {

Stack opened(const fs::path& folder, const StackOptions& options, bool all_or_none) {
    if (!fs::exists(folder)) fail("{}: no such folder", folder.string());
    if (!fs::is_directory(folder))
        fail("{}: is not a folder; give the folder that holds the photographs", folder.string());
    Stack stack;
    stack.folder = folder;
    stack.develop = options.develop;
    StackCalibration calibration = read_stack_calibration(folder, options);
    stack.warnings = calibration.warnings;
    match_photos(stack, calibration.lights, calibration.lights_path);
    leave_out_lights_from_below(stack, calibration.lights_path);
    if (!all_or_none) leave_out_damaged(stack);
    check_headers(stack);
    const Region photo = stack.crop;
    apply_geometry(stack, calibration);
    if (options.crop) apply_crop(stack, *options.crop);
    stack.transfer = options.transfer;
    apply_calibration(stack, calibration);
    if (options.mask_file) apply_mask(stack, *options.mask_file, photo);
    return stack;
}

}  // namespace

Stack open_stack(const fs::path& folder, const StackOptions& options) {
    return opened(folder, options, true);
}

Stack open_usable_stack(const fs::path& folder, const StackOptions& options) {
    return opened(folder, options, false);
}

}  // namespace tangi
