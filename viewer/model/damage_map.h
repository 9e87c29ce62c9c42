// damage_map.h: damage, suggestions or additions as a picture that lies over the painting. No OpenGL.
#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "retouch/treatment/treatment.h"
#include "viewer/model/treatment_state.h"

namespace tangi {

// What was added, by pixel; what lies on top counts.
enum class Addition : std::uint8_t { none, varnish, fill, retouch, beside };
Image<std::uint8_t> additions_of(const Canvas& canvas, const std::vector<TreatmentLayer>& layers,
                                 const Mask& belongs);

class DamageMap {
public:
    static constexpr int kMostPixels = 4096;  // of a side: larger paintings have a coarser map

    DamageMap() = default;
    DamageMap(int width, int height);  // of the painting

    using Picture = Image<glm::u8vec4>;  // sRGB, not multiplied by alpha
    const Picture& picture() const { return picture_; }
    int reduced() const { return reduced_; }  // pixels of the painting for one of the map, along a side

    // Of the painting's size; the part that changed. A hair line counts whole: it must be seen.
    void set(DamageClass damage, const Mask& mask, const Region& changed);
    void set(DamageClass damage, const Mask& mask) { set(damage, mask, mask.region()); }
    void set_suggestion(const Mask& mask);  // empty: there is none
    void set_additions(const Image<std::uint8_t>& additions);

    // Draws the picture anew within a region of the painting; gives that of the picture.
    struct Style {
        std::array<bool, kDamageClasses.size()> shown{};
        MapStyle style = MapStyle::filled;
        bool additions = false;  // instead of damage
        friend bool operator==(const Style&, const Style&) = default;
    };
    Region compose(const Style& style, const Region& region);
    Region compose(const Style& style);

private:
    using Coverage = Image<std::uint8_t>;  // of the picture's size
    Region in_picture(const Region& region) const;
    void reduce(const Mask& mask, const Region& picture, Coverage& to) const;
    float alpha(const Coverage& coverage, int x, int y, MapStyle style, bool falling) const;

    int width_ = 0, height_ = 0, reduced_ = 1;
    std::array<Coverage, kDamageClasses.size()> classes_;
    Coverage suggestion_, additions_;
    Picture picture_;
};

}  // namespace tangi
