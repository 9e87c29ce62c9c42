// alignment.h: the motions of many pictures of one thing under different lights, estimated jointly: each
// picture is laid onto what the others predict under its own light.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "capture/registration/motion.h"
#include "capture/registration/three_terms.h"
#include "surface/image/image.h"
#include "surface/image/local_contrast.h"

namespace tangi {

// One part of all pictures, reduced alike: pixel (x, y) is at origin + reduction * (x, y) of the pictures.
struct AlignmentWindow {
    glm::dvec2 origin{0};
    double reduction = 1;
    std::vector<Image<float>> pictures;  // one a picture; what local_contrast() makes of them
};

struct AlignedPicture {
    Homography homography{1};  // pixel of the joint frame -> pixel of the picture
    MotionEstimate last;       // of the last step, covariance included
    MotionModel told =
        MotionModel::none;      // the largest that this picture by itself tells from the next smaller
    MotionMatrix covariance{};  // [pixels^2] of the homography's motion
    double correlation = 0;     // [1] with its prediction, where there are edges
    double certainty = 0;       // [standard errors] by which that differs from 0
    double expected = 0;        // [1] rms contrast of its prediction
    double contrast = 0;        // [1] rms of its own, where there are edges
    double model_error_px = 0;  // [pixels] what a prediction this poor may shift it by
};

class Alignment {
public:
    // Pictures from which on relief is told from motion.
    static constexpr int kEnoughForRelief = 7;

    // `lights` are the directions of each picture's light. Pictures that are not `in_model` are laid onto the
    // others' predictions without a say in them.
    Alignment(const MotionFrame& frame, const std::vector<glm::dvec3>& lights, std::vector<bool> in_model);

    std::vector<AlignedPicture> pictures;
    // The last step of the part that is linear in the light: of shifts, and where many pictures tell more
    // (free_all()), of that.
    TiedMotion tied;

    // Takes new windows, and chooses the pixels to look at: those with edges in the mean of all pictures.
    void look_at(const std::vector<AlignmentWindow>& windows, int pixels);

    // Alternates predictions and motions; `largest` bounds the motion of every picture, which the data may
    // narrow: to what many pictures tell, or this one by itself.
    void iterate(MotionModel largest, int times);

    // The light that a picture shows where it lies, whatever is listed for it: the one under which the
    // others' prediction correlates best with it.
    struct ShownLight {
        glm::dvec3 light{0, 0, 1};  // [unit vector]
        double correlation = 0;     // [1] under it
    };
    // Of these pictures, each predicted from those that are not among them. Nothing where relief is not told
    // from motion, or nothing like it is in the picture.
    std::vector<std::optional<ShownLight>> per_photo_lights(const std::vector<std::size_t>& of);

    // [1] Contrast that three terms of the light leave unexplained at the pixels that are looked at, where
    // the pictures lie as they do: rms of the pictures in the model, of which there are 4 or more, over what
    // they have beyond three, median of the pixels. As telling with few pictures, which is all that it is
    // for.
    double unexplained();

    // Predicts a picture under this light [unit vector] from now on.
    void set_light(std::size_t picture, const glm::dvec3& light);

private:
    struct Pixel {
        int window = 0, cell = 0;
        glm::dvec2 position{0};  // of the joint frame
        float scale = 1;         // of its residuals
        Three terms{};           // of its prediction
    };
    struct Sample {
        float value = 0, dx = 0, dy = 0;  // first the picture's, then the prediction's gradient
        float residual = 0;               // of the picture against a prediction from the others
        float weight = 0;
    };

    // A pixel that may be looked at.
    struct Candidate {
        float strength;  // of its edges
        Pixel pixel;
    };
    using Cell = std::vector<Candidate>;
    // A pixel's prediction: value and gradient by the light's terms, with the factors of their equations.
    struct PixelFit {
        Three value{}, dx{}, dy{};
        Small factor{};
    };
    // What one picture shows of its motion, cell by cell.
    struct MotionEvidence;

    static Three terms_under(const glm::dvec3& light);
    Image<float> edge_strength(const AlignmentWindow& window) const;
    void add_candidates(std::size_t window, std::vector<Cell>& cells) const;
    void take_strongest(std::vector<Cell>& cells, int pixels);
    void sample();
    void predict();
    void predict_pixel(std::size_t k);
    bool fit_pixel(std::size_t k, bool robust, PixelFit& fit, std::vector<float>& deviations);
    void find_residuals(std::size_t k, const PixelFit& fit);
    float scale_of(std::vector<float> deviations) const;
    void add_tied_rows(std::size_t k, const Small& factor, const Three& c);
    MotionEvidence evidence_of(std::size_t picture) const;
    void judge_agreement(const MotionEvidence& evidence, std::size_t picture);
    void move(std::size_t picture, MotionModel largest);
    void replace_tied_part();
    void apply_steps();
    void free_all();

    MotionFrame frame_;
    std::vector<Three> terms_of_;  // of each picture's light: 1, l.x / l.z, l.y / l.z
    std::vector<bool> in_model_;
    int terms_ = 1;  // of these that predict a pixel
    const std::vector<AlignmentWindow>* windows_ = nullptr;
    std::vector<Pixel> pixels_;
    std::vector<Sample> samples_;  // [pixel][picture]
    std::vector<TiedCell> tied_;   // of each pixel
    std::vector<float> scales_;    // of each picture's residuals, relative to the pixels'
    float typical_scale_ = 0.1f;   // median of the pixels'
    int cells_ = 0;
    MotionModel least_ = MotionModel::translation;  // that every picture is free to have
};

}  // namespace tangi
