// relight.h: the reference renderer: what a surface looks like under given lights, from where it was
// photographed.
#pragma once

#include <optional>
#include <span>

#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"
#include "surface/reflectance/ward.h"

namespace tangi {

struct RelightOptions {
    WardModel model = WardModel::bounded;
    bool cast_shadows = false;  // march the height map towards each light
    // [deg] Angular radius of the lights, for the penumbra of cast shadows; where empty, that of the lights
    // that the surface was photographed with (Rig::light_radius_deg).
    std::optional<double> light_radius_deg{};
    double ambient = 0;  // [1] part of rho_d that shines without any light

    static constexpr std::string_view name = "relight";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"cast_shadows", 0, 1, "", "shadows that the relief casts, from the height map"},
              self.cast_shadows);
        visit(FieldInfo{"light_radius_deg", 0, 45, "deg",
                        "angular radius of the lights: softness of cast shadows (else as photographed)"},
              self.light_radius_deg);
        visit(FieldInfo{"ambient", 0, 1, "1", "part of the diffuse colour seen without any light"},
              self.ambient);
    }
};

// Linear picture in the frame of the maps, as the camera of surface.photography.rig saw it (from straight
// ahead where there is none):
//   value = ambient rho_d + sum over lights of irradiance *
//           (visibility * (rho_d D + pi rho_s colour lobe max(0, n.l)) + rig.ambient rho_d)
// with the colour of the lobe, 1 where surface.specular_colour is empty, anisotropic as surface.lobe_axes say
// (anisotropy.h), and D of oren_nayar.h, max(0, n.l) where
// surface.law.diffuse_roughness is 0: then a matt white facing a light of gain 1 is 1 + rig.ambient. It is
// linear in the lights (tested).
Image<Rgb> relight(const Surface& surface, std::span<const Light> lights, const RelightOptions& options = {},
                   const Progress& progress = {});

// One pixel of it: pi f cos(theta) for one light direction, without visibility.
Rgb reflected(const Surface& surface, int x, int y, const Vec3& light, const Vec3& view, WardModel model);

// Of the lights that a surface is relit with.
double light_radius_deg(const Surface& surface, const RelightOptions& options);

// Part of the light, 0..1, that reaches each pixel past the relief (cast_shadows.h). Light from a disc of the
// given angular radius around each direction.
Image<float> visibility(const Surface& surface, const Light& light, double light_radius_deg);

}  // namespace tangi
