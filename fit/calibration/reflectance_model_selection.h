// reflectance_model_selection.h: how rough the diffuse reflection of a painting is, how much second lobe its
// lobes have (surface/reflectance/ward.h), and whether they have colours and are anisotropic, decided by how
// well validation photographs are predicted.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "fit/calibration/light_sample.h"

namespace tangi {

struct ReflectanceModelSelection {
    ReflectanceModel reflectance_model;
    // [dB] Mean PSNR of photographs left out in turn, on the sample, for each law that was tried.
    struct Trial {
        ReflectanceModel reflectance_model;
        double cv_psnr_db;
    };
    std::vector<Trial> trials{};  // empty where it was given, or where there were too few photographs to try
    // Whether lobes have colours, under that law: mean PSNR of validation photographs at the pixels of the
    // sample whose lobes are coloured by the others, as white ones and as coloured ones.
    struct Colours {
        bool chosen = false;
        double part = 0;  // [1] of the sample: such pixels
        double white_db = 0, coloured_db = 0;
    } colours{};
    // The same of lobes that are anisotropic (surface/reflectance/anisotropy.h).
    struct Stretches {
        bool chosen = false;
        double part = 0;
        double isotropic_db = 0, anisotropic_db = 0;
    } stretches{};
};

// `lighting` has one light for each photograph of the sample's stack. A second lobe and then diffuse
// roughness are only believed where they predict photographs better by more than 0.1 dB and one standard
// error of the gain (roughness: 0.5 dB and two), the noise to expect of stored values counted as part of
// every error, second lobe also only where more of the samples are explained; else they are
// 0, as they are with fewer than 12 photographs. A roughness that is known already is kept. Deterministic for
// any number of threads.
ReflectanceModelSelection select_reflectance_model(const LightSample& sample, const Lighting& lighting,
                                                   const Progress& progress = {},
                                                   const std::optional<double>& diffuse_roughness = {});

// The colours of lobes (specular_colour.h) under that law: where at least 1 % of the sample has any, and
// photographs are predicted better there by more than 0.1 dB and two standard errors, noise counted
// likewise; with lobes anisotropic as the same photographs say, or isotropic.
ReflectanceModelSelection::Colours choose_specular_colours(const LightSample& sample,
                                                           const Lighting& lighting,
                                                           const ReflectanceModel& reflectance_model,
                                                           bool anisotropic);

// Whether lobes are anisotropic (anisotropy_estimate.h), by the same test, with white lobes, under the
// choice's law; sets its stretches. A lobe that is narrow one way and wide the other passes for a hazy one:
// where lobes are anisotropic, second lobe (if it is open) is only left where it still predicts photographs
// better.
void choose_stretches(const LightSample& sample, const Lighting& lighting, bool second_lobe_is_open,
                      ReflectanceModelSelection& choice);

// {"diffuse_roughness", "second_lobe_weight", "cv_psnr_db": [{"diffuse_roughness", "second_lobe_weight",
// "psnr_db"}, …],
//  "specular_colour": {"chosen", "part", "white_db", "coloured_db"},
//  "anisotropic_specular": {"chosen", "part", "isotropic_db", "anisotropic_db"}}
nlohmann::json to_json(const ReflectanceModelSelection& choice);

}  // namespace tangi
