// display_profile.h: the colours of this monitor, as its ICC profile describes them, so that a painting looks
// on it as it is.
//
// What is drawn is linear Rec. 709; lcms2 says what the monitor has to be told for it. The window asks a
// table of that for each pixel (Renderer::set_monitor); pictures that are made beside it are changed as they
// are. Files stay sRGB.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tangi {

enum class RenderingIntent {
    relative,   // relative colorimetric: colours that the monitor has stay; others become its nearest
    perceptual  // all colours give way a little, where the profile has a table for that
};

// Values for the monitor [0..65535], red, green and blue, for all colours whose linear values are (i / (side
// - 1))^3: steps that are even to the eye. Red runs fastest.
struct MonitorTable {
    int side = 0;
    std::vector<std::uint16_t> rgb;
};

class Monitor {
public:
    // An ICC profile; `source` names it in errors. Throws Error where it is none, or not of a display in RGB.
    Monitor(const std::string& icc, const std::string& source);
    ~Monitor();
    Monitor(Monitor&&) noexcept;
    Monitor& operator=(Monitor&&) noexcept;

    static Monitor read(const std::filesystem::path& file);

    const std::string& name() const;  // as the profile describes itself
    RenderingIntent intent() const;
    void set_intent(RenderingIntent intent);  // black becomes the monitor's black with both

    MonitorTable table(int side = 65) const;
    // sRGB to the monitor's values, in place: three bytes a pixel.
    void apply(std::span<std::uint8_t> rgb) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// What X says of the screen (the property _ICC_PROFILE of its root window, as desktops set it); nothing where
// it says nothing or there is no X.
std::optional<std::string> profile_of_the_screen();

}  // namespace tangi
