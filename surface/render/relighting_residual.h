// relighting_residual.h: what photographs show beyond the fitted surface, as a residual over the direction of
// the light: a few coefficients a pixel, kept in part `residual` of the painting file.
//
// The residual at a light of direction l, in units of its irradiance, is
//     sum over t of b_t(l) B_t u  +  sum over t of c_t(l) (S_t e1 + T_t e2)
//     b_t(l) = sum over photographs i of weights[t][i] k(|l - l_i|)
// with u the unit vector along the pixel's rho_d and e1, e2 across it: what is left over mostly has the
// colour of the paint. It fades to nothing away from the lights that were photographed, and is 0 where
// nothing was measured. Of a large painting it is that of blocks of pixels, interpolated between them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surface/maps/surface.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/render/relight.h"

namespace tangi {

struct RelightingResidual {
    // k: exp(-d^2 / 2 reach^2), or (1 + a) exp(-a), a = sqrt(3) d / reach (Matern, nu = 3/2)
    enum class Kernel { gaussian, matern };
    // Terms that share their functions of the direction.
    using Weights = std::vector<std::vector<double>>;  // [term][photograph]

    Kernel kernel = Kernel::gaussian;
    double reach = 0.3;              // [1] distance of unit vectors over which residuals are alike
    double light_radius_deg = 0.25;  // [deg] of the cast shadows that the residual was taken from
    std::vector<Vec3> directions;    // [unit vector] of the photographs
    Weights brightness_weights, colour_weights;
    int reduction = 1;                     // [pixels] of the painting, a side of a block
    std::vector<Image<float>> brightness;  // [1] B_t, of each block
    std::vector<Image<float>> colour;      // [1] S_0, T_0, S_1, T_1, ...
    std::string dry_hash;                  // of the dry layer that it belongs to

    bool empty() const { return brightness.empty(); }
};

double kernel_at(RelightingResidual::Kernel kernel, double reach, double distance);
std::string name_of(RelightingResidual::Kernel kernel);

// Values of the functions b_t or c_t at a direction.
std::vector<double> weights_at(const RelightingResidual& residual, const RelightingResidual::Weights& weights,
                               const Vec3& direction);

// u, e1, e2 of a pixel: orthonormal; (1, 1, 1) where rho_d is 0.
glm::mat3 colour_frame(const Rgb& diffuse);

// Adds the residual to a picture of `dry` that relight() made under these lights with cast shadows; `bare`,
// where not empty, is the part of each pixel, 0..1, that no paint covers. No value becomes less than 0.
void add_residual(const RelightingResidual& residual, const Surface& dry, std::span<const Light> lights,
                  const Image<float>& bare, Image<Rgb>& picture);

// The same for a part of a painting that is lit part by part (Surface::part_of): what is the same for all of
// them is reckoned once. Value of each block of the residual, under each light.
using ResidualUnderLights = std::vector<Image<Vec3>>;
ResidualUnderLights residual_under(const RelightingResidual& residual, std::span<const Light> lights);
void add_residual(const RelightingResidual& residual, const ResidualUnderLights& under, const Surface& dry,
                  std::span<const Light> lights, const Image<float>& bare, Image<Rgb>& picture);

// Whether relight() with these options draws what the residual was fitted beside: `bounded` lobes and cast
// shadows of lights of the same radius. It is none of anything else.
bool belongs_to(const RelightingResidual& residual, const Surface& dry, const RelightOptions& options);

// [bytes] That its coefficients take in a painting file, before it is compressed.
std::size_t bytes_of(const RelightingResidual& residual);

// The part `residual`, to write with write_painting(): it refers to the residual. Half floats.
PartToWrite part_of(const RelightingResidual& residual);

// Provenance (JSON) that says that a residual was looked for, and none was stored since it gained nothing;
// and whether a surface's says so.
std::string with_residual_in_vain(const std::string& provenance);
bool residual_in_vain(const std::string& provenance);

// Of a painting file; empty where it has none. Throws Error naming the file and the part: damaged, of another
// size, of another dry layer than `dry`, values that are not finite.
RelightingResidual read_residual(const std::filesystem::path& path, const Surface& dry,
                                 const Progress& progress = {});
// The same where the maps are not at hand.
RelightingResidual read_residual(const std::filesystem::path& path, const PaintingHeader& header,
                                 const Progress& progress = {});

}  // namespace tangi
