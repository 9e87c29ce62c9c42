// validation_scores.h: how well the samples of photographs that were left out are explained, and the one test
// by which the fit chooses between models of them.
//
// A sample's score is the part noise^2 / (error^2 + noise^2) of it that is explained (Geman & McClure 1987,
// "Statistical methods for tomographic image reconstruction"): about 1 where the error is what the noise
// makes, 0 for a shadow, a highlight or metal that the model cannot explain, however large the error. Two
// models are compared sample by sample. Samples of one pixel share its errors, and those of one photograph
// share that photograph's, so the standard error of the mean difference is that of clusters both ways
// (Cameron, Gelbach & Miller 2011, "Robust inference with multiway clustering", eq. 2.8).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace tangi {

class ValidationScores {
public:
    // One more photograph: squared errors [1] of its samples, NaN where there is none; `noise` [1] is the
    // square that is to be expected of stored values. All photographs have the same pixels; with `marked`
    // only those count.
    void add(const std::vector<double>& squared_errors, double noise, const std::vector<bool>& marked = {});
    // One that is predicted in several ways: the mean of its scores counts.
    void add_mean(const std::vector<std::vector<double>>& squared_errors, double noise,
                  const std::vector<bool>& marked = {});
    // Photographs of another part of the same trial.
    void add(const ValidationScores& other);

    struct Gain {
        double mean = 0, sigma = 0;  // [1] and its standard error; 0 where no sample is in both
    };
    // By how much more is explained than by `other`, which has the same photographs in the same order.
    Gain over(const ValidationScores& other) const;

private:
    std::vector<std::vector<float>> photos_;  // [photo][pixel] 0 to 1, NaN where there is no sample
};

// The model to take of those with these scores, from the simplest on: the first that none exceeds by more
// than one standard error (Breiman, Friedman, Olshen & Stone 1984, "Classification and regression trees", ch.
// 3).
std::size_t select_model(std::span<const ValidationScores* const> from_simplest);

}  // namespace tangi
