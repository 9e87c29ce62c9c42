// lighting.h: what falls on a point of the painting in each photograph, and how certain a pixel's value is:
// what the per-pixel fits need beside the photographs.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "capture/stack/pixel_samples.h"
#include "surface/image/colour.h"
#include "surface/maps/light.h"

namespace tangi {

struct Stack;
class ReducedPhotos;
class StackReader;

struct Lighting {
    std::vector<Light> lights;  // one a photograph
    Rig rig;
    double white_level = 1;  // [1] linear pixel value of a matt white that faces a light of gain 1
    // [deg] Standard error of each light's direction where its calibration tells it, else 0; empty where none
    // does.
    std::vector<double> direction_sigma_deg{};
};

// Sizes the samples of the pixel at a point of the painting for all lights, and fills in all but their values
// and sigmas.
void illuminate(const Lighting& lighting, const Vec3& point_mm, int channels, PixelSamples& samples);

// Standard deviation to expect of a linear value: that of a stored value, carried through the transfer curve.
class NoiseModel {
public:
    // `noise` [1]: standard deviation of a stored value, full scale = 1. Files of floats do not clip: light
    // beyond 1 is light like any other. `clipped`: linear value from which on a sample is clipped, where that
    // is not the transfer curve's kClipped: of stacks that were developed, whose `transfer` is that of the
    // files. What a flat field multiplies values by, it multiplies their noise by too: this is left out, as
    // it is the same for all photographs of a pixel and so changes no weight between them.
    NoiseModel(const Transfer& transfer, double noise, bool clips, std::optional<float> clipped = {});

    // Negative where the sample is clipped (it only says "at least this"); 0 where it is not a number.
    double sigma(float linear) const;
    float clipped() const { return clipped_; }  // linear value from which on a sample is clipped
    double stored() const { return stored_; }   // [1] of a stored value, full scale = 1
    // |sigma| of values from 0 to 1, evenly spaced; between them sigma is linear.
    std::span<const float> table() const { return sigma_; }

private:
    static constexpr int kEntries = 4096;
    double stored_;
    std::array<float, kEntries> sigma_{};
    float clipped_ = std::numeric_limits<float>::infinity();
};

// A stack whose photographs can be read as linear light, and the lights that they were taken under: what
// pixels are fitted from.
struct CalibratedStack {
    const Stack& stack;
    const Transfer& transfer;  // of its files
    const NoiseModel& noise;
    const Lighting& lighting;                // in the order of stack.photos
    const ReducedPhotos* reduced = nullptr;  // read instead of the stack's photographs where it is given
    // Read instead of a new one where it is given: of a stack that this one has all columns of, and whose row
    // `first_row` is this one's row 0. So what goes on below goes on where it is, and nothing is decoded
    // twice.
    StackReader* reader = nullptr;
    int first_row = 0;
};

}  // namespace tangi
