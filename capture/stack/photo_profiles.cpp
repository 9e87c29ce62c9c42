#include "capture/stack/photo_profiles.h"

#include <lcms2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "capture/stack/photo_screening.h"
#include "capture/stack/stack_calibration.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"
#include "surface/image_file/icc_profile.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kSameProfile = 0.01;  // [1] of full scale, as curves that are taken for the same

cmsHPROFILE opened_profile(std::string_view bytes, int channels) {
    cmsHPROFILE profile = cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size()));
    if (profile && cmsGetColorSpace(profile) == (channels == 1 ? cmsSigGrayData : cmsSigRgbData))
        return profile;
    if (profile) cmsCloseProfile(profile);
    return nullptr;
}

}  // namespace

ProfileConversion::ProfileConversion(std::string_view from, std::string_view to, int channels, bool clips)
    : channels_(channels), clips_(clips) {
    // Complaints of the library would go to stderr; what is wrong shows in what is missing.
    cmsSetLogErrorHandler([](cmsContext, cmsUInt32Number, const char*) {});
    const cmsHPROFILE source = opened_profile(from, channels), target = opened_profile(to, channels);
    const cmsUInt32Number format = channels == 1 ? TYPE_GRAY_FLT : TYPE_RGB_FLT;
    // As the profiles say, colour by colour: what is optimised is off by some codes of 16 bits.
    if (source && target)
        transform_ = cmsCreateTransform(source, format, target, format, INTENT_RELATIVE_COLORIMETRIC,
                                        static_cast<cmsUInt32Number>(cmsFLAGS_NOCACHE | cmsFLAGS_NOOPTIMIZE));
    for (const cmsHPROFILE profile : {source, target})
        if (profile) cmsCloseProfile(profile);
}

ProfileConversion::~ProfileConversion() {
    if (transform_) cmsDeleteTransform(transform_);
}

ProfileConversion::ProfileConversion(ProfileConversion&& other) noexcept
    : transform_(std::exchange(other.transform_, nullptr)),
      channels_(other.channels_),
      clips_(other.clips_) {}

void ProfileConversion::convert(std::span<float> values) const {
    constexpr std::size_t at_once = 4096;  // pixels
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const auto channels = static_cast<std::size_t>(channels_);
    const float clipped = clips_ ? kClipped : std::numeric_limits<float>::infinity();
    std::vector<float> converted(at_once * channels);
    for (std::size_t first = 0; first < values.size(); first += at_once * channels) {
        const std::span<float> part =
            values.subspan(first, std::min(at_once * channels, values.size() - first));
        cmsDoTransform(transform_, part.data(), converted.data(),
                       static_cast<cmsUInt32Number>(part.size() / channels));
        for (std::size_t i = 0; i < part.size(); i += channels) {
            const auto [low, high] = std::minmax_element(&part[i], &part[i] + channels);
            if (*low >= clipped) continue;
            const bool known = *high < clipped && !std::isnan(*low + *high);
            for (std::size_t c = 0; c < channels; ++c)
                part[i + c] =
                    known ? std::max(clips_ ? std::min(converted[i + c], kClipped) : converted[i + c], 0.0f)
                          : nan;
        }
    }
}

double ProfileConversion::largest_change() const {
    constexpr int steps = 9;
    std::vector<float> colours;
    const int whole = channels_ == 1 ? steps * steps * steps : steps;
    if (channels_ == 1)
        for (int i = 0; i < whole; ++i)
            colours.push_back(static_cast<float>(i) / static_cast<float>(whole - 1));
    else
        for (int i = 0; i < steps * steps * steps; ++i)
            for (const int part : {i / steps / steps, i / steps % steps, i % steps})
                colours.push_back(static_cast<float>(part) / (steps - 1));
    std::vector<float> converted(colours.size());
    cmsDoTransform(transform_, colours.data(), converted.data(),
                   static_cast<cmsUInt32Number>(colours.size() / static_cast<std::size_t>(channels_)));
    double most = 0;
    for (std::size_t i = 0; i < colours.size(); ++i)
        most =
            std::max(most, static_cast<double>(std::abs(colours[i] - std::clamp(converted[i], 0.0f, 1.0f))));
    return most;
}

namespace {

// The files of a stack that say what profile they have, and those that do not.
class ProfileCensus {
public:
    explicit ProfileCensus(const Stack& stack) : stack_(stack), clips_(stack.bits != 32) {
        for (const StackPhoto& photo : stack.photos)
            for (const fs::path& path : files_of(photo)) add(path);
    }

    std::size_t with() const { return with_; }
    std::size_t all() const { return files_.size(); }
    const std::string& most_frequent() const {
        const Kind* most = &kinds_.front();
        for (const Kind& kind : kinds_)
            if (kind.files > most->files) most = &kind;
        return most->profile;
    }
    bool uniform() const { return kinds_.size() <= 1 && with_ == files_.size(); }

    struct File {
        fs::path path;
        std::string profile;     // empty where it has none
        bool says_srgb = false;  // without a profile
    };
    const std::vector<File>& files() const { return files_; }

    // From one profile to another; null where they are the same.
    std::shared_ptr<const ProfileConversion> conversion(const std::string& from, const std::string& to) {
        const auto [known, is_new] = conversions_.try_emplace(from);
        if (!is_new) return known->second;
        auto made = std::make_shared<ProfileConversion>(from, to, stack_.channels, clips_);
        if (made->known() && made->largest_change() > kSameProfile) known->second = std::move(made);
        return known->second;
    }

private:
    struct Kind {
        std::string profile;
        std::size_t files = 0;
    };

    void add(const fs::path& path) {
        PhotoMetadata said = read_photo_metadata(path);
        File file{path, std::move(said.icc_profile)};
        if (!file.profile.empty() && !known(file.profile)) file.profile.clear();
        if (file.profile.empty())
            file.says_srgb = said.png_srgb || said.exif_colour == 1;
        else
            count(file.profile);
        files_.push_back(std::move(file));
    }

    // Whether it can be read, and is of such channels.
    bool known(const std::string& profile) {
        for (const Kind& kind : kinds_)
            if (kind.profile == profile) return true;
        return ProfileConversion(profile, profile, stack_.channels, clips_).known();
    }

    void count(const std::string& profile) {
        ++with_;
        for (Kind& kind : kinds_)
            if (kind.profile == profile) {
                ++kind.files;
                return;
            }
        kinds_.push_back({profile, 1});
    }

    const Stack& stack_;
    const bool clips_;
    std::vector<File> files_;
    std::vector<Kind> kinds_;
    std::size_t with_ = 0;
    std::map<std::string, std::shared_ptr<const ProfileConversion>> conversions_;
};

void tell(Stack& stack, const std::vector<std::string>& names, const char* one, const char* several) {
    if (names.empty()) return;
    stack.warnings.push_back(fmt::format("{}: {} photograph{}: {}", stack.folder.string(), names.size(),
                                         names.size() == 1 ? one : several, joined(names)));
}

}  // namespace

void relate_profiles(Stack& stack) {
    if (stack.is_raw || stack.bits == 32 || stack.photos.empty()) return;
    ProfileCensus census(stack);
    if (census.uniform() || 2 * census.with() <= census.all()) return;
    const auto profiles = std::make_shared<PhotoProfiles>();
    profiles->common = census.most_frequent();
    std::vector<std::string> converted, srgb, assumed;
    for (const ProfileCensus::File& file : census.files()) {
        const bool has_none = file.profile.empty();
        const std::string name = file.path.filename().string();
        if (has_none && !file.says_srgb) {
            assumed.push_back(name);
            continue;
        }
        if (has_none && stack.channels == 1) continue;
        auto conversion = census.conversion(has_none ? srgb_icc_profile() : file.profile, profiles->common);
        if (!conversion) continue;
        (has_none ? srgb : converted).push_back(name);
        profiles->conversions.emplace(file.path, std::move(conversion));
    }
    tell(stack, converted, " has another ICC profile than the others, and is converted to theirs",
         "s have another ICC profile than the others, and are converted to theirs");
    tell(stack, srgb, " has no ICC profile but says that it is sRGB, and is converted to that of the others",
         "s have no ICC profile but say that they are sRGB, and are converted to that of the others");
    tell(stack, assumed, " has no ICC profile that can be used, and is taken to have that of the others",
         "s have no ICC profile that can be used, and are taken to have that of the others");
    stack.profiles = profiles;
}

const ProfileConversion* conversion_of(const Stack& stack, const fs::path& path) {
    if (!stack.profiles) return nullptr;
    const auto found = stack.profiles->conversions.find(path);
    return found == stack.profiles->conversions.end() ? nullptr : found->second.get();
}

PhotoMetadata metadata_in(const Stack& stack, const fs::path& path) {
    PhotoMetadata metadata = read_photo_metadata(path);
    if (stack.profiles) metadata.icc_profile = stack.profiles->common;
    return metadata;
}

}  // namespace tangi
