// compare.h: how well a painting, relit, matches photographs: those it was fitted from and those that were
// held out.
//
// Photographs and relit pictures are compared as stored (encoded by the photographs' own transfer curve,
// 0..1), since that is what the camera delivered; colour differences alone are computed from linear light, as
// CIE defines them: colorimetric where a colour chart told how the camera sees (Photography::to_camera).
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "capture/stack/stack.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/image/metrics.h"
#include "surface/maps/surface.h"
#include "surface/render/relighting_residual.h"

namespace tangi {

struct CompareOptions {
    bool cast_shadows = true;                  // relit pictures have the shadows that the relief casts
    std::optional<double> light_radius_deg{};  // [deg] as RelightOptions
    int picture_size = 1200;                   // [pixels] longest side of the pictures in the page
    double error_range =
        0.15;  // [1] brightness difference at the ends of the error maps' scale, full scale = 1
    double delta_e_range = 15;  // [1] CIEDE2000 at the end of the colour difference maps' scale

    static constexpr std::string_view name = "compare";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"cast_shadows", 0, 1, "", "relight with the shadows that the relief casts"},
              self.cast_shadows);
        visit(FieldInfo{"light_radius_deg", 0, 45, "deg",
                        "angular radius of the lights: softness of cast shadows (else as photographed)"},
              self.light_radius_deg);
        visit(
            FieldInfo{"picture_size", 16, 16384, "1", "longest side of the pictures in the page, in pixels"},
            self.picture_size);
        visit(FieldInfo{"error_range", 1e-3, 1, "1",
                        "brightness difference at the ends of the error maps' scale"},
              self.error_range);
        visit(FieldInfo{"delta_e_range", 0.1, 100, "1",
                        "CIEDE2000 at the end of the colour difference maps' scale"},
              self.delta_e_range);
    }
};

struct PhotoComparison {
    std::string name;
    Light light;                               // what the photograph was relit with
    double elevation_deg = 90;                 // [deg] of the light above the picture plane
    double azimuth_deg = 0;                    // [deg] 0..360, from x (right) towards y (up)
    bool fitted = false;                       // false: held out, the fit never saw it
    double psnr_db = 0;                        // [dB] at most kPsnrCap_db
    std::optional<double> residual_psnr_db{};  // [dB] relit with the painting's residual, where it has one
    double ssim = 0;                           // [1] -1..1
    double delta_e_2000 = 0;                   // [1] mean over the pixels
    double delta_e_2000_p95 = 0;               // [1] 95 % of the pixels differ by no more
    std::optional<double> correlation{};       // [1] luma_correlation()
    // Red and blue of its white balance against the painting's, where it differs and was not fitted: the
    // relit picture has it, too.
    std::optional<glm::dvec2> white_balance{};
    double bias = 0;  // [1] mean of relit - photograph, as stored: > 0 where the relit picture is too bright
};

// Means over photographs; meaningless where count is 0 (null in the JSON).
struct ComparisonMean {
    int count = 0;
    double psnr_db = 0, ssim = 0, delta_e_2000 = 0;
    std::optional<double> residual_psnr_db{};
};

struct CompareReport {
    std::vector<PhotoComparison> photos;  // those of the stack, then its held-out ones
    ComparisonMean held_out, fitted, all;
    std::string worst;  // name of the photograph with the lowest PSNR
    Transfer transfer;  // encoding in which the pictures were compared
    int width = 0, height = 0;
    CompareOptions options;
    std::vector<std::string> warnings;
    std::string foreign;    // what says that the photographs are another painting's; empty where they aren't
    std::string exchanged;  // what says that they have each other's lights (compared_lights.h)
};

// One photograph beside its relit picture, for as long as the call lasts.
struct ComparedPictures {
    int index;  // of the photograph in the report
    const PhotoComparison& result;
    const Image<Rgb>& photo;      // as stored
    const Image<Rgb>& relit;      // encoded alike, 0..1
    const Image<float>& delta_e;  // [1] CIEDE2000
    const PixelMask& mask;        // pixels that were compared
    const Transfer& transfer;     // how both pictures are encoded
    glm::mat3 from_camera{1};     // their linear channels -> linear Rec. 709
};
using ComparisonSink = std::function<void(const ComparedPictures&)>;

// Relights the surface at the light of each photograph of the stack, held out or not, and compares. Whether
// the fit saw a photograph, and the strength of its light, is looked up in surface.photography by name; a
// photograph that is not listed there counts as held out and as lit with gain 1, and a warning says so; it is
// registered to what the painting looks like under its light (compared_motions.h). The
// white balance of a photograph that was not fitted is measured (white_balances.h) and told. Where a residual
// is given, PSNR is also that of the pictures that add_residual() makes of the relit ones; all else is of the
// surface alone. Pixels of confidence 0, and those that the stack's mask leaves out, do not count.
// Photographs that have hardly more than brightness in common with the relit pictures are another painting's
// (`foreign`). One photograph is in memory at a time. Throws Error: the surface does not come from
// photographs, nothing in it was measured, sizes that differ; Cancelled.
CompareReport compare(const Surface& surface, const Stack& photos, const CompareOptions& options = {},
                      const Progress& progress = {}, const ComparisonSink& sink = {},
                      const RelightingResidual& residual = {});

// {"photos": [{"name", "fitted", "light": [x, y, z], "elevation_deg", …}], "mean": {"held_out": {"count",
// "psnr_db", "ssim", "delta_e_2000"}, "fitted", "all"}, "judged_by": "held_out" or, where none was, "fitted",
// "judged_by_in_words", "worst", …}; names are made valid UTF-8.
nlohmann::json to_json(const CompareReport& report);

// A picture that relight() made, as the camera would have stored it: transfer(white_level * to_camera *
// linear), at most 1.
Image<Rgb> as_photographed(const Image<Rgb>& linear, const Photography& photography);

// One of the stored pictures, or a row of it, for people to look at: sRGB, with true colours where the chart
// told them. `shown` may be `stored`.
void for_display(std::span<const Rgb> stored, const ComparedPictures& pictures, std::span<Rgb> shown);
Image<Rgb> for_display(const Image<Rgb>& stored, const ComparedPictures& pictures);

}  // namespace tangi
