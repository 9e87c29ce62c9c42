// light_sample.h: a stack's sample of pixels, and how it is fitted and predicted under some lighting: what
// light calibration works on.
#pragma once

#include <vector>

#include "capture/stack/survey.h"
#include "fit/calibration/light_bundle_adjustment.h"
#include "fit/pixel/lighting.h"
#include "fit/pixel/ward_fit.h"

namespace tangi {

// [1] The stored value that all but 2 % of the sample's values, of all photographs, are below; 0 of none.
float bright_stored(const Survey& survey);

// The terms of LightBundleAdjustment::beams as those of a light, and back. `width_mm`: the unit of the joint
// problem.
Beam beam_of(const std::array<double, 5>& terms, double width_mm);
std::array<double, 5> scaled_beam(const Beam& beam, double width_mm);

// A stack, the survey of it, and how the survey's samples become linear light.
struct SurveyedStack {
    const Stack& stack;
    const Survey& survey;
    const Transfer& transfer;
    const NoiseModel& noise;
    double mm_per_pixel = 1;  // [mm] of the painting
};

class LightSample {
public:
    // About `wanted` pixels of the survey. `flat`: LightBundleAdjustment::flat. Keeps references to survey
    // and noise.
    LightSample(const SurveyedStack& surveyed, const WardFitOptions& ward, int wanted, bool flat = true);

    // The same pixels, of which lobes are taken to be as wide as this before any photograph.
    LightSample with_ln_alpha(double ln_alpha) const;

    int size() const { return static_cast<int>(chosen_.size()); }
    double width_mm() const { return width_mm_; }  // of the picture's longer side

    // The pixels fitted to these photographs; the lighting has one light for each of them. `specular_colours`
    // and `stretches`: of each pixel; white and not anisotropic where there are none.
    std::vector<WardEstimate> fit(const std::vector<int>& photos, const Lighting& lighting,
                                  const ReflectanceModel& reflectance_model = {},
                                  const std::vector<Rgb>& specular_colours = {},
                                  const std::vector<Stretch>& stretches = {}) const;

    // How the same photographs say that each pixel's lobe is anisotropic (anisotropy_estimate.h).
    std::vector<Stretch> stretches(const std::vector<WardEstimate>& estimates, const std::vector<int>& photos,
                                   const Lighting& lighting, const ReflectanceModel& reflectance_model) const;

    // What the same photographs say of each pixel's colour of the lobe (specular_colour.h).
    std::vector<Rgb> specular_colours(const std::vector<WardEstimate>& estimates,
                                      const std::vector<int>& photos, const Lighting& lighting,
                                      const ReflectanceModel& reflectance_model) const;

    // By how much the stored values of each pixel in one photograph differ from those predicted under this
    // light, in units of a matt white that faces it: the mean of its channels' squares [1]; NaN where there
    // is none to compare.
    std::vector<double> squared_errors(const std::vector<WardEstimate>& estimates, int photo,
                                       const Lighting& lighting,
                                       const ReflectanceModel& reflectance_model = {}) const;

    // [dB] PSNR of a photograph with these squared_errors(); a matt white that faces its light is the peak.
    // At most what a thousandth of bright_stored() leaves: better is no matter. Of the pixels that are
    // marked, or all.
    double psnr_db(const std::vector<double>& squared_errors, double white_level,
                   const std::vector<bool>& marked = {}) const;

    // [1] What squared_errors() of a perfect prediction are: the noise to expect of a stored value.
    double squared_noise(double white_level) const;

    // [1] ln(measured / predicted) of each pixel's green, or grey, in one photograph, under this light; NaN
    // where the photograph is clipped, dark or not there, or the pixel is not measurable.
    std::vector<float> log_ratios(const std::vector<WardEstimate>& estimates, int photo,
                                  const Lighting& lighting,
                                  const ReflectanceModel& reflectance_model = {}) const;

    // [pixels] of the picture, where pixel k is
    glm::vec2 place_px(int k) const { return places_px_[static_cast<std::size_t>(k)]; }

    // About half of the pixels: those that located() does not look at.
    const std::vector<bool>& others() const { return others_; }

    // The light of one photograph as its pixels show it, less others(), the pixels being what they are; moves
    // what the freedom says of gain and direction.
    Lighting located(const std::vector<WardEstimate>& estimates, int photo, const Lighting& lighting,
                     const JointFreedom& freedom) const;

    // The joint problem of these photographs, started from estimates of the pixels. Clipped samples are left
    // out.
    LightBundleAdjustment joint_problem(const std::vector<int>& photos, const Lighting& lighting) const;

    // The same with some photographs only, started from the solution with all of them.
    LightBundleAdjustment joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                                        const LightBundleAdjustment& solved) const;

    // The problem of all photographs with these pixels, started from lights that another sample's solution
    // has, and pixels as they are under them.
    LightBundleAdjustment joint_problem(const std::vector<int>& photos, const Lighting& lighting,
                                        const LightBundleAdjustment& lights,
                                        const std::vector<WardEstimate>& estimates) const;

private:
    const Vec3& point_mm(int k) const { return points_mm_[static_cast<std::size_t>(k)]; }
    const float* stored(int k, int photo) const;
    void gather(int k, const std::vector<int>& photos, const Lighting& lighting, PixelSamples& s) const;
    void add_pixel(int k, const WardEstimate& estimate, const std::vector<int>& photos,
                   const Lighting& lighting, LightBundleAdjustment& joint) const;
    void describe(const Lighting& lighting, LightBundleAdjustment& joint) const;
    void add_samples(int k, const std::vector<int>& photos, const Lighting& lighting, int pixel,
                     LightBundleAdjustment& joint) const;

    const Survey& survey_;
    Transfer transfer_;
    const NoiseModel& noise_;
    WardFitOptions ward_;
    double width_mm_ = 1;
    double bright_ = 1;
    bool flat_;
    std::vector<int> chosen_;  // of the survey's samples
    std::vector<bool> others_;
    std::vector<Vec3> points_mm_;
    std::vector<glm::vec2> places_px_;
};

}  // namespace tangi
