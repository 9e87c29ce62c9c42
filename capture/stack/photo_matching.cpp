#include "capture/stack/photo_matching.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "capture/formats/lights_file.h"
#include "capture/photo/brackets.h"
#include "capture/photo/photo_folder.h"
#include "capture/photo/photo_names.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

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
                "with --brackets FILE",
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
        for (const RejectedPhoto& light : calibration.rejected)
            if (const auto photo = photo_named(light.name, folder_, pictures_).photo)
                used_.emplace(photo->lexically_normal(), light.name);
        brackets_ = brackets_of(develop.brackets, folder_, photos_, lights_);
    }

    PhotoMatch run() {
        for (std::size_t i = 0; i < lights_.size(); ++i) add(i);
        if (result_.photos.empty() && pictures_.empty()) take_from_elsewhere();
        if (result_.photos.empty() && photos_.size() == lights_.size() && !photos_.empty()) {
            take_by_order();
            return std::move(result_);
        }
        if (lights_.front().name.empty())
            fail(
                "{}: has {} lights and does not name photographs, of which there are {} in {}; leave as many "
                "there, in the order of the lights",
                lights_path_.string(), lights_.size(), photos_.size(), folder_.string());
        tell_missing();
        tell_choices();
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
        const NamedPhoto named = photo_named(light.name, folder_, pictures_);
        const std::optional<fs::path>& photo = named.photo;
        if (!photo) {
            (named.candidates.empty() ? missing_ : ambiguous_).push_back(light.name);
            if (!named.candidates.empty() && ambiguous_.size() == 1) candidates_ = named.candidates;
            return;
        }
        note_choice(light.name, named);
        const auto [earlier, is_new] =
            used_.emplace(photo->lexically_normal(), light.name);  // "./name" is "name"
        if (is_new)
            result_.photos.push_back({*photo, light, position, {}, {}});
        else
            add_again(*earlier, light);
    }

    // What was not meant by the letter.
    void note_choice(const std::string& name, const NamedPhoto& named) {
        for (const fs::path& file : named.beside) beside_.push_back(file.lexically_normal());
        if (!named.beside.empty()) chosen_.push_back(named.photo->filename().string());
        const auto listed = file_listed(name, lights_path_);
        std::error_code unknown;
        if (listed && !fs::equivalent(*listed, *named.photo, unknown) && !unknown)
            elsewhere_.push_back(*listed);
    }

    // A folder without photographs holds a lights file that says where they are.
    void take_from_elsewhere() {
        for (std::size_t i = 0; i < lights_.size(); ++i)
            if (const auto file = file_listed(lights_[i].name, lights_path_);
                file && used_.emplace(*file, lights_[i].name).second) {
                std::erase(missing_, lights_[i].name);
                result_.photos.push_back({*file, lights_[i], static_cast<int>(i), {}, {}});
            }
        if (!result_.photos.empty())
            result_.warnings.push_back(fmt::format(
                "{}: holds no photographs, and those that {} lists are used, in {}", folder_.string(),
                lights_path_.filename().string(), result_.photos.front().path.parent_path().string()));
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
        result_.rejected.push_back(
            {same->light.name, what + ", under different lights; remove the line that is wrong"});
        result_.photos.erase(same);
    }

    void take_by_order() {
        // Lights are numbered as people count, unless the file's own names show that a program sorted them.
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
        if (!ambiguous_.empty()) {
            std::vector<std::string> files;
            for (const fs::path& file : candidates_) files.push_back(file.filename().string());
            leave_out(
                ambiguous_,
                fmt::format("{}: {} of {} listed photographs may be one of several files in {}: '{}' {}. "
                            "Name the one that is meant with its extension, or leave one there",
                            lights_path_.string(), ambiguous_.size(), lights_.size(), folder_.string(),
                            ambiguous_.front(), joined(files)));
        }
        if (missing_.empty()) return;
        std::string what = fmt::format(
            "{}: {} of {} listed photographs are not in {}: {}. Put them there, or remove their "
            "lines",
            lights_path_.string(), missing_.size(), lights_.size(), folder_.string(), joined(missing_));
        if (const auto unread = unread_pictures(missing_.front(), folder_); !unread.empty())
            what += fmt::format(". {} is there, but {} files are not read: convert them to TIFF or PNG",
                                unread.front().filename().string(), lower_extension(unread.front()));
        leave_out(missing_, what);
    }

    void leave_out(const std::vector<std::string>& names, const std::string& what) {
        if (all_or_none_) throw Error(what);
        for (const std::string& name : names) result_.rejected.push_back({name, what});
    }

    void tell_choices() {
        if (!chosen_.empty())
            result_.warnings.push_back(fmt::format(
                "{}: several files have the names of listed photographs; {} are used, and not the "
                "JPEG files beside them",
                folder_.string(), joined(chosen_)));
        if (!elsewhere_.empty())
            result_.warnings.push_back(
                fmt::format("{}: lists {} of {} photographs in another folder ({}); those of the same names "
                            "in {} are used, "
                            "as that folder was named",
                            lights_path_.string(), elsewhere_.size(), lights_.size(),
                            elsewhere_.front().parent_path().string(), folder_.string()));
    }

    // What a fit of them made may lie beside photographs, and is none.
    static bool is_painting_file(const fs::path& file) {
        return lower_extension(file) == ".exr" && is_painting(file);
    }

    void tell_unlisted() {
        std::vector<std::string> unlisted;
        for (const fs::path& photo : photos_)
            if (const fs::path normal = photo.lexically_normal();
                !used_.contains(normal) &&
                std::find(beside_.begin(), beside_.end(), normal) == beside_.end() &&
                !is_painting_file(photo))
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
    std::vector<std::string> missing_, ambiguous_;  // names of lights
    std::vector<fs::path> candidates_;              // of the first ambiguous one
    std::vector<fs::path> beside_, elsewhere_;      // files that were not meant
    std::vector<std::string> chosen_;               // files that were, beside others
    PhotoMatch result_;
};

}  // namespace

PhotoMatch match_photos(const fs::path& folder, const DevelopOptions& develop,
                        const StackCalibration& calibration, bool all_or_none) {
    return Matcher(folder, develop, calibration, all_or_none).run();
}

}  // namespace tangi
