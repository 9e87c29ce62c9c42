// surface.h: the noun of the toolkit: a painting as per-pixel maps of shape and reflectance.
//
// Frame: x right, y up, z towards the viewer, origin at the centre of the picture; rows run downwards, so y =
// -row. docs/reference/quantities.md defines every map: symbol, unit, frame, range.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surface/image/colour.h"
#include "surface/image/homography.h"
#include "surface/image/image.h"
#include "surface/maps/light.h"
#include "surface/maps/light_model.h"
#include "surface/reflectance/anisotropy.h"
#include "surface/reflectance/ward.h"

namespace tangi {

// How the photographs that a surface was fitted from relate to it, so that relit pictures can be encoded
// alike:
//   encoded = transfer(white_level * gain * to_camera (pi f cos(theta_i)))
struct Photography {
    struct Photo {
        Light light;         // light.name is the photograph's name
        bool fitted = true;  // false: held out, the fit never saw it
        // Pixel of the reference photograph's frame -> pixel of this photograph, both whole; where the camera
        // moved.
        std::optional<Homography> homography{};
        // [unit vector] As the lights file says, where light.direction is a correction of it.
        std::optional<Vec3> listed_direction{};
    };
    Transfer transfer;
    double white_level = 1;  // [1] linear pixel value of a matt white that faces a light of gain 1
    std::vector<Photo> photos;
    Rig rig;
    std::optional<LightModel> light_model{};  // of the fitted photographs; empty where lights count as equal
    std::optional<BeamModel> beams{};         // likewise; empty where they count as even
    std::optional<DirectionModel> directions{};  // likewise; empty where they count as listed
    // Linear Rec. 709 -> the photographs' linear channels, white balance included, where a colour chart told;
    // the same where empty.
    std::optional<glm::dmat3> to_camera{};
};

// [linear, Rec. 709] of what the photographs' channels saw: the inverse of to_camera, 1 where there is none.
glm::dmat3 from_camera(const Photography& photography);

// The photograph of this name and light, or null. The light counts too, within 3 degrees of what the fit
// found or of what its lights file said: photographs of different stacks have the same names (image00.jpg).
const Photography::Photo* find_photo(const Photography& photography, const Light& light);

// Of the photographs that were fitted: what light_model and beams are of, and directions of both.
std::vector<Light> fitted_lights(const Photography& photography);
std::vector<Vec3> directions_as_listed(const Photography& photography);

// The light of a lights file with the strength (and, unless it has a position, with direction and position)
// that it had in its photograph; where there is none, as strong, as near and as far from where it is listed
// as the lights that were photographed make likely.
Light as_photographed(const Light& light, const Photography& photography);

// Where a surface lies in a painting that it is a part of.
struct PartOfPainting {
    int left = 0, top = 0;  // [pixels] of its upper left pixel
    // [pixels] of the whole; no whole number where a pixel stands for several of the painting.
    double width = 0, height = 0;
};

// All maps have the same size. A pixel that was not measured has confidence 0, normal (0, 0, 1) and rho_d =
// 0.
struct Surface {
    Image<float> height_mm;   // [mm] above the mean plane of the support
    Image<Vec3> normal;       // [unit vector], z > 0
    Image<Rgb> diffuse;       // [1] rho_d, reflectance, linear Rec. 709
    Image<float> specular;    // [1] rho_s
    Image<float> roughness;   // [1] alpha, rms slope of the microfacets
    Image<float> confidence;  // [1] 0 = not measured .. 1 = certain
    // [1] What rho_s is multiplied by in each channel, 0..1, 1 in the largest: white, as a dielectric's, or a
    // metal's colour. Empty: all are white.
    Image<Rgb> specular_colour;
    Image<LobeAxes> lobe_axes;  // empty: all lobes are isotropic

    ReflectanceModel reflectance_model;  // of the whole painting
    double mm_per_pixel = 1;             // [mm] > 0; 1 where unknown
    bool scale_known = false;            // false: mm_per_pixel is a guess; what heights are in: height_unit.h
    Photography photography;             // empty where the surface does not come from photographs
    std::string provenance;              // JSON: program, version, options, inputs
    // Where it is a part of a painting: then its frame has its origin at the painting's centre.
    std::optional<PartOfPainting> part_of{};

    Surface() = default;
    Surface(int width, int height);  // flat, matt, black, not measured

    int width() const { return height_mm.width(); }
    int height() const { return height_mm.height(); }
    Vec3 point_mm(int x, int y) const;  // [mm] of a pixel's centre in the surface frame
};

// Throws ContractError where the maps differ in size; specular_colour and lobe_axes may be empty.
void require_consistent(const Surface& surface);

// z-gradient (dz/dx, dz/dy) [1] of a unit normal with z > 0, y up; and back.
struct Slope {
    float x = 0, y = 0;
};
inline Slope slope_of(const Vec3& n) { return {-n.x / n.z, -n.y / n.z}; }
inline Vec3 normal_of(const Slope& s) {
    const float inverse = 1 / std::sqrt(1 + s.x * s.x + s.y * s.y);
    return {-s.x * inverse, -s.y * inverse, inverse};
}

// Normals of a height map by central differences, one-sided at the borders (thesis eq. 3.5 to 3.9).
Image<Vec3> normals_of(const Image<float>& height_mm, double mm_per_pixel);

// z of the plane a x + b y + c [mm] that fits best in the sense of least squares; x, y in pixels from the
// centre, y up. `weight` may be empty (all alike).
struct Plane {
    double a = 0, b = 0, c = 0;
};
Plane best_plane(const Image<float>& height_mm, const Image<float>& weight);
void subtract(const Plane& plane, Image<float>& height_mm);

}  // namespace tangi
