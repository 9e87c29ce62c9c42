// photo_profiles.h: photographs of one stack that have not all the same ICC profile, read as if they had.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "capture/photo/photo_metadata.h"
#include "capture/stack/stack.h"

namespace tangi {

// Values stored with one profile, as they would be stored with another.
class ProfileConversion {
public:
    // Profiles (ICC.1:2010) of red, green and blue, or of grey. `known` is false where one of them is
    // damaged, of other channels, or cannot be converted from or to. `clips`: values from kClipped on say
    // only that there was more light.
    ProfileConversion(std::string_view from, std::string_view to, int channels, bool clips);
    ~ProfileConversion();
    ProfileConversion(ProfileConversion&&) noexcept;
    bool known() const { return transform_ != nullptr; }

    // Interleaved values 0..1. A colour of which a channel is clipped is not known in any other primaries,
    // and becomes NaN; one that is clipped in all stays that. Any number of threads may call it.
    void convert(std::span<float> values) const;

    // [1] Largest change of a value, of colours spread over all that can be stored.
    double largest_change() const;

private:
    void* transform_ = nullptr;
    int channels_;
    bool clips_;
};

// What is assumed and done about the profiles of a stack's photographs.
struct PhotoProfiles {
    std::string common;  // the profile that most have, and the others are converted to
    std::map<std::filesystem::path, std::shared_ptr<const ProfileConversion>> conversions;
};

// Where more than half of the photographs have an ICC profile, and not all the same, sets stack.profiles,
// with a warning that names the photographs: others are converted to the profile that most have; those
// without one are taken for theirs, or for sRGB where they say so. Profiles that change no value by more than
// 1 % are the same. Not of camera raw and floats, which are linear light. Reads headers.
void relate_profiles(Stack& stack);

// How to read a file's values; null where as they are.
const ProfileConversion* conversion_of(const Stack& stack, const std::filesystem::path& path);

// What a photograph's file says, once it is read as the others.
PhotoMetadata metadata_in(const Stack& stack, const std::filesystem::path& path);

}  // namespace tangi
