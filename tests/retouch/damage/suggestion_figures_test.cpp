// suggestion_figures_test.cpp: how often areas are suggested rightly: the table of
// docs/validation/retouching.md. Takes minutes, so it runs only when asked for: retouch_tests
// --gtest_also_run_disabled_tests --gtest_filter='*Figures*'
#include <gtest/gtest.h>

#include <iostream>

#include "retouch/damage/area_suggestion.h"
#include "tests/support/retouch/damage_truth.h"

namespace tangi {
namespace {

// By seeds that nothing was made with: 101 to 110 with all kinds of damage, 111 to 118 with craquelure,
// losses, varnish and a retouch only.
constexpr std::uint64_t kFirstWorn = 101, kFirstSound = 111, kEnd = 119;

PaintingTruth painting_of_figures(std::uint64_t seed) {
    PaintingOptions options;
    options.seed = seed;
    options.width = 400;
    options.height = 360;
    options.mm_per_pixel = 0.3;
    options.impasto = 0.55;
    options.abrasion = options.flaking = options.stain = options.old_fill = options.overpaint =
        seed < kFirstSound;
    return procedural_painting(options);
}

struct Figures {
    double right = 0, found = 0, there = 0;  // [pixels]
    int paintings = 0, wrong_areas = 0, in_sound = 0;

    void add(const AreaSuggestion& suggestion, const Mask& truth, bool sound) {
        right += sum(intersected(suggestion.mask, truth));
        found += sum(suggestion.mask);
        there += sum(truth);
        paintings += !sound && intersection_over_union(suggestion.mask, truth) > 0.3;
        for (const SuggestedArea& area : suggestion.areas) {
            double inside = 0, all = 0;
            for (int y = area.box.y0; y < area.box.y1; ++y)
                for (int x = area.box.x0; x < area.box.x1; ++x)
                    all += static_cast<double>(suggestion.mask(x, y)),
                        inside += static_cast<double>(suggestion.mask(x, y) * truth(x, y));
            if (inside < 0.5 * all) ++(sound ? in_sound : wrong_areas);
        }
    }
};

TEST(AreaSuggestion, DISABLED_Figures) {
    const std::array<Image<unsigned char> PaintingTruth::*, 5> truths = {
        &PaintingTruth::abrasion, &PaintingTruth::stain, &PaintingTruth::old_fill, &PaintingTruth::overpaint,
        &PaintingTruth::flaking};
    std::array<Figures, kAreaClasses.size()> figures;
    for (std::uint64_t seed = kFirstWorn; seed < kEnd; ++seed) {
        const PaintingTruth truth = painting_of_figures(seed);
        const Surface surface = surface_of(truth);
        for (std::size_t i = 0; i < kAreaClasses.size(); ++i)
            figures[i].add(suggest_areas(surface, truth.mm_per_pixel, kAreaClasses[i]),
                           mask_of(truth.*truths[i]), seed >= kFirstSound);
    }
    for (std::size_t i = 0; i < kAreaClasses.size(); ++i) {
        const Figures& f = figures[i];
        std::cout << fmt::format(
            "[  FIGURE  ] {}: IoU {:.2f}, precision {:.2f}, recall {:.2f}, found {} of 10, false areas {}, "
            "in "
            "sound paintings {}\n",
            name_of(kAreaClasses[i]), f.right / (f.found + f.there - f.right),
            f.right / std::max(f.found, 1.0), f.right / f.there, f.paintings, f.wrong_areas, f.in_sound);
    }
}

}  // namespace
}  // namespace tangi
