// ward_fit.h: the Ward parameters of one pixel from its samples, by robust, bounded least squares with Ceres.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "capture/radiometry/photometric_stereo.h"
#include "capture/stack/pixel_samples.h"
#include "fit/pixel/ward_residual.h"
#include "surface/base/options.h"

namespace tangi {

struct WardFitOptions {
    int max_iterations = 30;    // Levenberg-Marquardt steps
    double model_error = 0.05;  // [1] relative deviation of real surfaces from the model
    double robust_scale = 3;    // [sigma] residual from which a sample counts less and less (Cauchy)
    bool by_highlight = true;   // pixels that are explained poorly are fitted from their highlight, too,
    bool in_shade = false;      // these and shaded ones also as crevices that few lights reach
    ReflectanceModel reflectance_model = {};
    WardBounds bounds = {};
    WardPrior prior = {};

    static constexpr std::string_view name = "ward_fit";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"max_iterations", 1, 1000, "1", "Levenberg-Marquardt steps a pixel"},
              self.max_iterations);
        visit(
            FieldInfo{"model_error", 0, 1, "1", "relative deviation expected between surfaces and the model"},
            self.model_error);
        visit(FieldInfo{"robust_scale", 0.1, 1000, "sigma", "residual from which a sample counts less"},
              self.robust_scale);
    }
};

// The fit of one pixel. Standard errors are those of the parameters at the solution, from the inverse of J^T
// J (Gauss-Newton), scaled up where the residuals are larger than expected.
struct WardEstimate {
    glm::dvec2 slope{0};            // [1] dz/dx, dz/dy
    glm::dvec3 diffuse{0};          // [1] rho_d
    double specular = 0;            // [1] rho_s
    double roughness = 0.3;         // [1] alpha
    glm::dvec3 specular_colour{1};  // [1] that was given (specular_colour.h), as in surface.h
    glm::dvec2 stretch{0};          // [1] that was given, likewise (surface/reflectance/anisotropy.h)
    double diffuse_error = 0;       // [1] standard error of rho_d, root of the mean variance of the channels
    double slope_error = 0;         // [1] standard error of the slope, root of the mean of both variances
    double specular_error = 0;      // [1]
    double roughness_error = 0;     // [1]
    double rms_residual = 0;        // [sigma] of the robust residuals
    double cost = 0;                // [sigma^2] sum of their squares, priors included
    bool valid = false;             // false: not measurable (see LambertEstimate)
    bool converged = false;
};

// Photometric stereo as the fit starts from it.
constexpr PhotometricStereoOptions kWardStereo = {.shadow = 0.2};
// [sigma] Residual of a fit from which on it is tried from the highlight: metal that hardly has a matt part,
// whose wide lobe photometric stereo takes for one.
constexpr double kPoorFit = 1.2;
// [1] Part of the first cost below which that counts: minima as deep as each other are left as stereo found
// them, by batches and by Ceres alike.
constexpr double kClearlyCheaper = 0.99;

// Where a pixel may be if its brightest photographs show its highlight: facing the mean of their half
// vectors, its matt part what the darker ones leave.
struct WardStart {
    glm::dvec2 slope{0};
    glm::dvec3 diffuse{0};
};
WardStart start_of(const LambertEstimate& matt);
// Nothing where no photograph stands out, or the slope would be beyond `bounds`.
std::optional<WardStart> highlight_start(const PixelSamples& samples, const WardBounds& bounds);

// Keeps its memory from pixel to pixel: one a thread.
class WardFitter {
public:
    explicit WardFitter(const WardFitOptions& options);
    ~WardFitter();

    WardEstimate fit(const PixelSamples& samples);  // with the prior of the options
    // `start`: null where it is for photometric stereo and the highlight to find.
    WardEstimate fit(const PixelSamples& samples, const WardPrior& prior, const WardStart* start = nullptr);

private:
    struct Workspace;
    WardFitOptions options_;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace tangi
