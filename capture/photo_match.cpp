#include "capture/photo_match.h"

#include <utf8proc.h>

#include <algorithm>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <map>
#include <string_view>
#include <utility>

#include "capture/brackets.h"
#include "capture/lights_file.h"
#include "capture/raw_file.h"
#include "surface/error.h"
#include "surface/letter_case.h"
#include "surface/painting_file.h"
#include "surface/picture_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Names are alike in whatever case, and whether a letter with a mark is one code point (as most programs
// write it) or two (as macOS does). What is no UTF-8 is alike in its bytes.
std::string alike(const std::string& text) {
    utf8proc_uint8_t* mapped = nullptr;
    const utf8proc_ssize_t size = utf8proc_map(
        reinterpret_cast<const utf8proc_uint8_t*>(text.data()), static_cast<utf8proc_ssize_t>(text.size()),
        &mapped, static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_DECOMPOSE | UTF8PROC_CASEFOLD));
    if (size < 0) return lower_case(text);
    std::string result(reinterpret_cast<const char*>(mapped), static_cast<std::size_t>(size));
    std::free(mapped);
    return result;
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
        if (alike(photo.filename().string()) == alike(listed.filename().string())) return photo;
        if (alike(photo.stem().string()) == alike(listed.stem().string())) same_stem.push_back(photo);
    }
    if (same_stem.size() == 1) return same_stem.front();
    // Cameras store a JPEG beside each raw, of the same name.
    if (std::count_if(same_stem.begin(), same_stem.end(), is_raw_name) == 1)
        return *std::find_if(same_stem.begin(), same_stem.end(), is_raw_name);
    return std::nullopt;
}

// As people count: photo_2 before photo_10.
bool before_as_counted(std::string_view a, std::string_view b) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto number = [&](std::string_view& text) {
        std::size_t end = 0;
        while (end < text.size() && is_digit(text[end])) ++end;
        std::string_view digits = text.substr(0, end);
        text.remove_prefix(end);
        while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
        return digits;
    };
    const std::string_view whole_a = a, whole_b = b;
    while (!a.empty() && !b.empty()) {
        if (is_digit(a.front()) && is_digit(b.front())) {
            const std::string_view of_a = number(a), of_b = number(b);
            if (of_a.size() != of_b.size()) return of_a.size() < of_b.size();
            if (of_a != of_b) return of_a < of_b;
        } else {
            if (a.front() != b.front()) return a.front() < b.front();
            a.remove_prefix(1), b.remove_prefix(1);
        }
    }
    return a.empty() && b.empty() ? whole_a < whole_b : a.empty();
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

// One matching at work.
class Matcher {
public:
    Matcher(const fs::path& folder, const DevelopOptions& develop, const StackCalibration& calibration,
            bool all_or_none)
        : folder_(folder),
          lights_(calibration.lights),
          lights_path_(calibration.lights_path),
          all_or_none_(all_or_none),
          pictures_(photos_in(folder)),
          photos_(pictures_) {
        result_.masks = take_masks(photos_);
        // Photographs of lights that cannot be read are known, and need no second warning.
        for (const LeftOut& light : calibration.left_out)
            if (const auto photo = match(light.name, folder_, pictures_))
                used_.emplace(photo->lexically_normal(), light.name);
        brackets_ = brackets_of(develop.brackets, folder_, photos_, lights_);
    }

    PhotoMatch run() {
        for (std::size_t i = 0; i < lights_.size(); ++i) add(i);
        if (result_.photos.empty() && photos_.size() == lights_.size() && !photos_.empty()) {
            take_by_order();
            return std::move(result_);
        }
        if (lights_.front().name.empty())
            fail(
                "{}: has {} lights and does not name photographs, of which there are {} in {}; leave as many "
                "there, in "
                "the order of the lights",
                lights_path_.string(), lights_.size(), photos_.size(), folder_.string());
        tell_missing();
        tell_unlisted();
        return std::move(result_);
    }

private:
    void add(std::size_t number) {
        const Light& light = lights_[number];
        const int position = static_cast<int>(number);
        if (const auto bracket = brackets_.find(light.name); bracket != brackets_.end()) {
            for (const BracketFile& file : bracket->second)
                used_.emplace(file.path.lexically_normal(), light.name);
            const std::vector<Exposure> exposures = exposures_of(light.name, bracket->second);
            result_.photos.push_back({exposures.front().path, light, position, {}, exposures});
            return;
        }
        const auto photo = match(light.name, folder_, pictures_);
        if (!photo) {
            missing_.push_back(light.name);
            return;
        }
        const auto [earlier, is_new] =
            used_.emplace(photo->lexically_normal(), light.name);  // "./name" is "name"
        if (is_new)
            result_.photos.push_back({*photo, light, position, {}, {}});
        else
            add_again(*earlier, light);
    }

    // A photograph that an earlier light has already.
    void add_again(const std::pair<const fs::path, std::string>& earlier, const Light& light) {
        const std::string what =
            fmt::format("{}: '{}' and '{}' both mean the photograph {}", lights_path_.string(),
                        earlier.second, light.name, earlier.first.string());
        if (all_or_none_) throw Error(what);
        const auto same = std::find_if(
            result_.photos.begin(), result_.photos.end(),
            [&](const StackPhoto& photo) { return photo.path.lexically_normal() == earlier.first; });
        if (same != result_.photos.end() &&
            glm::length(same->light.direction - light.direction) < kSameDirection) {
            result_.warnings.push_back(what + ", under the same light; it is used once");
            return;
        }
        if (same == result_.photos.end()) return;  // a third light of it
        result_.left_out.push_back(
            {same->light.name, what + ", under different lights; remove the line that is wrong"});
        result_.photos.erase(same);
    }

    void take_by_order() {
        // Lamps are numbered as people count, unless the file's own names show that a program sorted them.
        std::vector<std::string> names;
        for (const Light& light : lights_) names.push_back(light.name);
        const bool by_letters = !lights_.front().name.empty() && std::is_sorted(names.begin(), names.end()) &&
                                !std::is_sorted(names.begin(), names.end(), before_as_counted);
        if (!by_letters)
            std::sort(photos_.begin(), photos_.end(), [](const fs::path& a, const fs::path& b) {
                return before_as_counted(a.filename().string(), b.filename().string());
            });
        for (std::size_t i = 0; i < photos_.size(); ++i)
            result_.photos.push_back({photos_[i], lights_[i], static_cast<int>(i), {}, {}});
        result_.by_order = true;
        const std::string order =
            fmt::format("the order of the file names: the first is {}'s, the last {}'s",
                        photos_.front().filename().string(), photos_.back().filename().string());
        if (lights_.front().name.empty()) {
            for (StackPhoto& photo : result_.photos) photo.light.name = photo.path.filename().string();
            result_.warnings.push_back(fmt::format(
                "{}: does not name photographs; its lights are taken in {}", lights_path_.string(), order));
            return;
        }
        result_.warnings.push_back(
            fmt::format("{}: none of its names ('{}', …) is a photograph in {}; lights are taken in {}",
                        lights_path_.string(), lights_.front().name, folder_.string(), order));
    }

    void tell_missing() {
        if (missing_.empty()) return;
        const std::string what = fmt::format(
            "{}: {} of {} listed photographs are not in {}: {}. Put them there, or remove their "
            "lines",
            lights_path_.string(), missing_.size(), lights_.size(), folder_.string(), joined(missing_));
        if (all_or_none_) throw Error(what);
        for (const std::string& name : missing_) result_.left_out.push_back({name, what});
    }

    // What a fit of them made may lie beside photographs, and is none.
    static bool is_painting_file(const fs::path& file) {
        return lower_extension(file) == ".exr" && is_painting(file);
    }

    void tell_unlisted() {
        std::vector<std::string> unlisted;
        for (const fs::path& photo : photos_)
            if (!used_.contains(photo.lexically_normal()) && !is_painting_file(photo))
                unlisted.push_back(photo.filename().string());
        std::erase_if(result_.masks,
                      [&](const fs::path& mask) { return used_.contains(mask.lexically_normal()); });
        if (!unlisted.empty())
            result_.warnings.push_back(fmt::format("{}: {} photographs are not listed in {} and not used: {}",
                                                   folder_.string(), unlisted.size(),
                                                   lights_path_.filename().string(), joined(unlisted)));
    }

    const fs::path& folder_;
    const std::vector<Light>& lights_;
    const fs::path& lights_path_;
    const bool all_or_none_;
    const std::vector<fs::path> pictures_;  // masks too
    std::vector<fs::path> photos_;          // without them
    Brackets brackets_;
    std::map<fs::path, std::string> used_;
    std::vector<std::string> missing_;
    PhotoMatch result_;
};

}  // namespace

void require_folder(const fs::path& folder) {
    std::error_code reason;
    if (!fs::exists(folder, reason) && !reason) fail("{}: no such folder", folder.string());
    if (!reason && !fs::is_directory(folder, reason))
        fail("{}: is not a folder; give the folder that holds the photographs", folder.string());
    if (!reason) (void)fs::directory_iterator(folder, reason);
    if (reason)
        fail("{}: the folder cannot be read: {}; give yourself the right to, or copy it to another place",
             folder.string(), reason.message());
}

std::vector<fs::path> photos_in(const fs::path& folder) {
    std::vector<fs::path> photos;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && is_photo_name(entry.path()) &&
            !entry.path().filename().string().starts_with('.'))
            photos.push_back(entry.path());
    std::sort(photos.begin(), photos.end());
    return photos;
}

std::vector<fs::path> take_masks(std::vector<fs::path>& pictures) {
    const auto says_mask = [](const fs::path& path) {
        return alike(path.filename().string()).find("mask") != std::string::npos;
    };
    std::vector<fs::path> masks;
    std::copy_if(pictures.begin(), pictures.end(), std::back_inserter(masks), says_mask);
    if (2 * masks.size() >= pictures.size()) return {};
    std::erase_if(pictures, says_mask);
    return masks;
}

PhotoMatch match_photos(const fs::path& folder, const DevelopOptions& develop,
                        const StackCalibration& calibration, bool all_or_none) {
    return Matcher(folder, develop, calibration, all_or_none).run();
}

}  // namespace tangi
