// registration_scenes.h: photographs of a generated painting by a camera that moved as is known.
#pragma once

#include <cmath>
#include <functional>

#include "capture/registration/registration.h"
#include "datasets/generator.h"
#include "tests/support/test_support.h"

namespace tangi {

inline constexpr int kWidth = 240, kHeight = 200, kBorder = 12;

// A painting, larger than its photographs, rendered twice as fine.
inline PaintingTruth painted(std::uint64_t seed) {
    return procedural_painting({.seed = seed,
                                .width = 2 * (kWidth + 2 * kBorder),
                                .height = 2 * (kHeight + 2 * kBorder),
                                .mm_per_pixel = 0.2,
                                .supersampling = 1});
}

inline const PaintingTruth& painting() {
    static const PaintingTruth truth = painted(5);
    return truth;
}

inline float bilinear(const Image<Rgb>& image, double x, double y, int c) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
    return (1 - fy) * ((1 - fx) * image.clamped(ix, iy)[c] + fx * image.clamped(ix + 1, iy)[c]) +
           fy * ((1 - fx) * image.clamped(ix, iy + 1)[c] + fx * image.clamped(ix + 1, iy + 1)[c]);
}

// What a camera sees that moved by h: 4 x 4 samples a pixel.
inline Image<Rgb> photographed(const Image<Rgb>& fine, const Homography& h) {
    Image<Rgb> photo(kWidth, kHeight);
    const Homography back = glm::inverse(h);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            Rgb sum(0);
            for (double dy : {-0.375, -0.125, 0.125, 0.375})
                for (double dx : {-0.375, -0.125, 0.125, 0.375}) {
                    const glm::dvec2 p = mapped(back, {x + dx, y + dy});
                    for (int c = 0; c < 3; ++c)
                        sum[c] += bilinear(fine, 2 * (p.x + kBorder) + 0.5, 2 * (p.y + kBorder) + 0.5, c);
                }
            photo(x, y) = sum / 16.0f;
        }
    return photo;
}

inline MotionVector jitter(int photo, double shift_px, double turn_px) {
    if (photo == 0) return {};
    // Without a pattern that lights might have as well.
    const auto number = [&](int k) {
        const double v = std::sin(12.9898 * photo + 78.233 * k) * 43758.5453;
        return 2 * (v - std::floor(v)) - 1;
    };
    return {shift_px * number(1), shift_px * number(2), 0, turn_px * number(3)};
}

struct RegistrationScene {
    TestDir folder;
    std::vector<Homography> truth;
    MotionFrame frame{kWidth, kHeight};

    RegistrationScene(int lights, double shift_px, double turn_px, const PaintingTruth& of = painting(),
                      double lowest_deg = 25, Arrangement arrangement = Arrangement::dome)
        : RegistrationScene(
              lights, [=](int i) { return jitter(i, shift_px, turn_px); }, of, lowest_deg, arrangement) {}

    // `motion` is that of each photograph [pixels].
    RegistrationScene(int lights, const std::function<MotionVector(int)>& motion,
                      const PaintingTruth& of = painting(), double lowest_deg = 25,
                      Arrangement arrangement = Arrangement::dome) {
        const GeneratorOptions options{
            .lights = lights, .held_out = 0, .arrangement = arrangement, .min_elevation_deg = lowest_deg};
        const Photography photography = photography_of(of, options);
        std::vector<Light> listed;
        for (int i = 0; i < lights; ++i) {
            const Light& light = photography.photos[static_cast<std::size_t>(i)].light;
            truth.push_back(homography_of(motion(i), frame));
            const Image<Rgb> photo = photographed(render_photo(of, light, options), truth.back());
            listed.push_back(light);
            listed.back().name = stem_of(i) + "png";
            write_picture(folder / listed.back().name, apply_sensor(photo, options, i), {}, {.bits = 16});
        }
        write_lights(folder / "lights.lp", listed);
    }

    // The photograph whose frame a registration has.
    std::size_t reference_of(const Registration& registration) const {
        for (std::size_t i = 0; i < truth.size(); ++i)
            if (registration.reference.starts_with(stem_of(static_cast<int>(i)))) return i;
        ADD_FAILURE() << "no photograph is called " << registration.reference;
        return 0;
    }

    // [pixels] over the picture, of a homography from the frame of photograph `reference`.
    double error_px(const Homography& found, std::size_t photo, std::size_t reference) const {
        const Homography true_one = truth[photo] * glm::inverse(truth[reference]);
        double sum = 0, count = 0;
        for (double y = 0; y <= 1; y += 0.1)
            for (double x = 0; x <= 1; x += 0.1, count += 1) {
                const glm::dvec2 p(x * kWidth, y * kHeight);
                const glm::dvec2 d = mapped(found, p) - mapped(true_one, p);
                sum += glm::dot(d, d);
            }
        return std::sqrt(sum / count);
    }

    static std::string stem_of(int photo) { return fmt::format("photo_{:03d}.", photo); }

    // [pixels] At the centre, after the mean of all photographs.
    double rms_jitter_px(const Registration& registration) const {
        std::vector<glm::dvec2> errors;
        glm::dvec2 mean(0);
        for (std::size_t i = 0; i < registration.photos.size(); ++i) {
            errors.push_back(mapped(registration.photos[i].homography, frame.centre) -
                             mapped(truth[i], frame.centre));
            mean += errors.back() / static_cast<double>(registration.photos.size());
        }
        double sum = 0;
        for (const glm::dvec2& e : errors) sum += glm::dot(e - mean, e - mean);
        return std::sqrt(sum / static_cast<double>(errors.size()));
    }

    double rms_error_px(const Registration& registration) const {
        double sum = 0;
        for (std::size_t i = 0; i < registration.photos.size(); ++i) {
            const double e = error_px(registration.photos[i].homography, i, reference_of(registration));
            sum += e * e;
        }
        return std::sqrt(sum / static_cast<double>(registration.photos.size()));
    }
};

inline Image<Rgb> another_scene() {
    const PaintingTruth truth =
        procedural_painting({.seed = 99, .width = kWidth, .height = kHeight, .mm_per_pixel = 0.4});
    const GeneratorOptions options{.lights = 4, .held_out = 0};
    return render_photo(truth, photography_of(truth, options).photos[1].light, options);
}

}  // namespace tangi
