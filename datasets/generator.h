// generator.h: stacks of photographs with ground truth, rendered from a painting that is known exactly.
//
// Radiometry: linear pixel value = white_level * gain * pi * f * cos(theta), so that a matt white (rho_d = 1)
// that faces a light of gain 1 has the value white_level. The viewer is orthographic, straight ahead: v = (0,
// 0, 1). Frame and units as in surface.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "datasets/procedural_painting.h"
#include "surface/image/colour.h"
#include "surface/maps/light.h"

namespace tangi {

enum class Arrangement {
    dome,    // rings of lights, each turned against its neighbour; rings hold lights in proportion to their
             // length
    spiral,  // a golden-angle spiral, which spreads evenly over the hemisphere
};
enum class Reflectance {
    ggx,  // f = rho_d / pi + GGX lobe (ggx.h), F0 = specular. rho_d is not reduced by the lobe's share: it
          // is the albedo that a photograph without highlights shows
    ward_bounded,  // f = rho_d / pi + rho_s * bounded Ward lobe (surface/reflectance/ward.h), rho_s =
                   // specular: what the fit assumes
    lambert,       // f = rho_d / pi
};
enum class GeneratorFormat { png16, png8, jpg, exr, tif };

std::string_view name_of(Arrangement arrangement);
std::string_view name_of(Reflectance reflectance);
std::string_view name_of(GeneratorFormat format);
std::optional<Arrangement> arrangement_named(std::string_view name);
std::optional<Reflectance> reflectance_named(std::string_view name);
std::optional<GeneratorFormat> generator_format_named(std::string_view name);

struct GeneratorOptions {
    std::uint64_t seed = 1;  // of noise, gains, held-out lights and errors of direction

    int lights = 48;
    int held_out = 6;  // photographs for comparison, lit from other directions within the same elevations
    Arrangement arrangement = Arrangement::dome;
    double min_elevation_deg = 15;        // [deg] above the picture's plane
    double max_elevation_deg = 80;        // [deg]
    std::optional<double> distance = {};  // [picture widths] of near lights from the centre; empty: distant
    double gain_min = 1;                  // [1] strength of the lights, log-uniform between
    double gain_max = 1;                  // [1]
    // [deg] from its axis at which a near light's beam is half as strong, as a power of the cosine; 0: even
    double beam_deg = 0;
    double aim_error =
        0;  // [picture widths] rms distance, in x and y each, of where lights are aimed from the centre
    double nominal_direction_error_deg = 0;  // [deg] rms angle between lights.lp and the true directions

    Reflectance reflectance = Reflectance::ggx;
    bool cast_shadows = true;
    double light_radius_deg = 0.25;  // [deg] angular radius of the lights: softness of cast shadows
    double ambient = 0;          // [1] part of rho_d that shines without any light, in units of white_level
    double interreflection = 0;  // [1] part of the light on the picture that comes back from around it

    double white_level = 0.75;           // [1] exposure: see above
    bool sensor_noise = true;            // false: neither noise nor quantisation nor clipping by the ADC
    double full_well_electrons = 30000;  // [electrons] at the linear value 1, where the sensor clips
    double read_noise_electrons = 6;     // [electrons] standard deviation
    int adc_bits = 12;
    Transfer transfer = {};  // from linear values to those in the files
    GeneratorFormat format = GeneratorFormat::png16;
    int jpeg_quality = 95;

    static constexpr std::string_view name = "generator";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"seed", 0, 9e15, "1", "other noise, gains and held-out lights for each number"},
              self.seed);
        visit(FieldInfo{"lights", 1, 10000, "1", "photographs to fit"}, self.lights);
        visit(FieldInfo{"held_out", 0, 10000, "1", "photographs to compare with"}, self.held_out);
        visit(FieldInfo{"min_elevation_deg", 1, 90, "deg", "lowest lights"}, self.min_elevation_deg);
        visit(FieldInfo{"max_elevation_deg", 1, 90, "deg", "highest lights"}, self.max_elevation_deg);
        visit(FieldInfo{"distance", 0.2, 1000, "picture widths", "distance of near lights"}, self.distance);
        visit(FieldInfo{"gain_min", 1e-3, 1e3, "1", "weakest light"}, self.gain_min);
        visit(FieldInfo{"gain_max", 1e-3, 1e3, "1", "strongest light"}, self.gain_max);
        visit(FieldInfo{"beam_deg", 0, 60, "deg",
                        "angle from its axis at which a near light is half as strong (0 = even)"},
              self.beam_deg);
        visit(
            FieldInfo{"aim_error", 0, 10, "picture widths", "how far from the centre lights are aimed, rms"},
            self.aim_error);
        visit(FieldInfo{"nominal_direction_error_deg", 0, 30, "deg", "error of the directions in lights.lp"},
              self.nominal_direction_error_deg);
        visit(FieldInfo{"cast_shadows", 0, 1, "", "shadows that the relief casts"}, self.cast_shadows);
        visit(FieldInfo{"light_radius_deg", 0, 45, "deg", "angular radius of the lights"},
              self.light_radius_deg);
        visit(FieldInfo{"ambient", 0, 1, "1", "part of the diffuse colour seen without any light"},
              self.ambient);
        visit(FieldInfo{"interreflection", 0, 1, "1", "light from the picture that comes back to it"},
              self.interreflection);
        visit(FieldInfo{"white_level", 1e-3, 100, "1", "linear value of a matt white facing a light"},
              self.white_level);
        visit(FieldInfo{"sensor_noise", 0, 1, "", "noise and quantisation of a sensor"}, self.sensor_noise);
        visit(FieldInfo{"full_well_electrons", 10, 1e9, "electrons", "at the linear value 1"},
              self.full_well_electrons);
        visit(FieldInfo{"read_noise_electrons", 0, 1e6, "electrons", "noise without light"},
              self.read_noise_electrons);
        visit(FieldInfo{"adc_bits", 4, 24, "1", "bits of the analogue-to-digital converter"}, self.adc_bits);
        visit(FieldInfo{"jpeg_quality", 1, 100, "1", "quality of JPEG files"}, self.jpeg_quality);
    }
};

// Intervals of the fields, and what must hold between them: min <= max, EXR files are linear. Throws Error.
void require_valid(const GeneratorOptions& options);

// All options, the names of the enumerations included.
nlohmann::json to_json(const GeneratorOptions& options);

// The true lights (photographs to fit first), with the names of their files, the transfer curve and white
// level.
Photography photography_of(const PaintingTruth& truth, const GeneratorOptions& options);

// [1] Irradiance at a point of the picture over that in its centre, as far as the light's beam makes it.
// Where it is aimed is a matter of chance, by the seed and the light's name. 1 for distant lights.
double beam_part(const Light& light, const Vec3& point_mm, double width_mm, const GeneratorOptions& options);

// One photograph as linear light, without a sensor. Pure, and linear in light.gain where ambient is 0.
//   value = white_level (pi f max(0, n.l) E visibility + (ambient + interreflection gain max(0, l.z)) rho_d)
// E is the irradiance of the light at the pixel (light.h), l.z belongs to the picture's centre.
Image<Rgb> render_photo(const PaintingTruth& truth, const Light& light, const GeneratorOptions& options = {});

// What a sensor makes of linear light, which is returned as linear light again: shot noise (normal with the
// variance of the Poisson distribution, which differs from it below about 20 electrons, where read noise
// hides it), read noise, then clipping to 0..1 and adc_bits. Unchanged where sensor_noise is off. `photo`
// chooses the noise.
Image<Rgb> apply_sensor(const Image<Rgb>& linear, const GeneratorOptions& options, int photo);

// Renders and writes a stack, each file whole or not at all; lights.lp comes last. Makes the folder.
//   img_000.png … lights.lp                         photographs to fit, directions with the nominal error
//   heldout/heldout_000.png … heldout.lp            photographs to compare with, true directions
//   gt/height.exr normal.exr albedo.exr specular.exr roughness.exr       maps of PaintingTruth, one or three
//   channels, and lobe.exr where there is gold leaf
//   gt/loss.png craquelure.png varnish.png retouch.png valid.png         masks, 255 = inside
//   gt/lights.json   true directions, positions, gains, transfer curve, white level (photography_json.h)
//   gt/meta.json     mm_per_pixel, size, options
//   gt/truth.exr     the painting as the best fit would give it; only for ward_bounded and lambert, where one
//   exists
// Returns what gt/lights.json says. Throws Error where files cannot be written, Cancelled where progress asks
// for it.
Photography write_stack(const std::filesystem::path& folder, const PaintingTruth& truth,
                        const GeneratorOptions& options = {}, const Progress& progress = {});

// What write_stack() writes to gt/, of a painting that `photography` may be empty for.
void write_truth(const std::filesystem::path& folder, const PaintingTruth& truth,
                 const Photography& photography, const GeneratorOptions& options);

}  // namespace tangi
