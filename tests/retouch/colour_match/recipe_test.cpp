// recipe_test.cpp: recipes: the subsets, the measures, the matches.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "paint/optics/palette.h"
#include "retouch/colour_match/paint_media.h"
#include "retouch/colour_match/recipe.h"
#include "retouch/colour_match/reflectance_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// The same numbers on every machine.
struct Draw {
    std::uint64_t state;
    double operator()() {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<double>(state >> 11) * 0x1p-53;
    }
};

std::vector<Pigment> small_box() {
    std::vector<Pigment> box;
    for (const char* name : {"Titanium White", "Bone Black", "Diarylide Yellow", "Pyrrole Red",
                             "Ultramarine Blue", "Phthalo Green (Blue Shade)", "Cobalt Blue"})
        box.push_back(artist_acrylics().at(name));
    return box;
}

// A smooth reflectance by chance, as of some other maker's paint.
Spectrum upper_film(Draw& draw) {
    const double middle = 420 + 250 * draw(), width = 20 + 80 * draw(), low = 0.03 + 0.2 * draw(),
                 high = low + 0.6 * draw();
    const bool rises = draw() < 0.7;
    Spectrum r;
    for (std::size_t band = 0; band < kBands; ++band) {
        const double t = 1 / (1 + std::exp(-(static_cast<double>(kBand_nm[band]) - middle) / width));
        r[band] = static_cast<float>(low + (high - low) * (rises ? t : 1 - t));
    }
    return r;
}

TEST(SimplexSubsets, AreTheBestOfAll) {
    Draw draw{7};
    constexpr int n = 6;
    std::vector<double> a(n * 5), gram(n * n);
    for (double& v : a) v = 2 * draw() - 1;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int r = 0; r < 5; ++r) gram[i * n + j] += a[i * 5 + r] * a[j * 5 + r];
    const auto fits = best_subsets(gram, n, 3, 10);
    ASSERT_FALSE(fits.empty());
    // No mixture of three columns on a grid is better.
    double least = 1e300;
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j)
            for (int k = j + 1; k < n; ++k)
                for (int u = 0; u <= 60; ++u)
                    for (int v = 0; u + v <= 60; ++v) {
                        double cost = 0;
                        for (int r = 0; r < 5; ++r) {
                            const double sum =
                                (u * a[i * 5 + r] + v * a[j * 5 + r] + (60 - u - v) * a[k * 5 + r]) / 60;
                            cost += sum * sum;
                        }
                        least = std::min(least, cost);
                    }
    EXPECT_LE(fits[0].cost, least + 1e-12);
    EXPECT_GT(fits[0].cost, least - 0.02);
    for (std::size_t i = 1; i < fits.size(); ++i) EXPECT_GE(fits[i].cost, fits[i - 1].cost);
    for (const SubsetFit& fit : fits) {
        double sum = 0;
        for (const double c : fit.weights) {
            sum += c;
            EXPECT_GE(c, 0);
        }
        EXPECT_NEAR(sum, 1, 1e-12);
    }
}

TEST(SimplexSubsets, KeepForbiddenPairsApart) {
    const std::vector<double> gram = {1, -0.9, 0, -0.9, 1, 0, 0, 0, 1};
    std::vector<char> allowed(9, 1);
    EXPECT_EQ(best_subsets(gram, 3, 3, 1)[0].columns[1], 1);
    allowed[1] = allowed[3] = 0;
    for (const SubsetFit& fit : best_subsets(gram, 3, 3, 10, allowed))
        EXPECT_FALSE(fit.count > 1 && fit.columns[0] == 0 && fit.columns[1] == 1);
}

TEST(MixingSteps, SayWhatTheyLeadTo) {
    // 8 white + 1 blue, and 20 of it + 1 black.
    const Mixture m = mixture_of({{3, 0, 1}, {5, 8, 1}, {1, 20, 1}});
    ASSERT_EQ(m.count, 3);
    EXPECT_NEAR(m.volumes[0], 8.0 / 9 * 20 / 21, 1e-12);
    EXPECT_NEAR(m.volumes[1], 1.0 / 9 * 20 / 21, 1e-12);
    EXPECT_NEAR(m.volumes[2], 1.0 / 21, 1e-12);
}

TEST(Match, FindsAMixtureThatCanBeMeasured) {
    const std::vector<Pigment> box = small_box();
    for (const auto& steps : {std::vector<MixingStep>{{0, 0, 1}, {4, 3, 1}},
                              std::vector<MixingStep>{{2, 0, 1}, {3, 5, 1}, {0, 1, 2}},
                              std::vector<MixingStep>{{0, 0, 1}, {5, 12, 1}, {2, 1, 1}, {1, 20, 1}}}) {
        const Mixture made = mixture_of(steps);
        std::vector<Pigment> pigments;
        std::vector<float> volumes;
        for (std::size_t i = 0; i < static_cast<std::size_t>(made.count); ++i) {
            pigments.push_back(box[static_cast<std::size_t>(made.paints[i])]);
            volumes.push_back(static_cast<float>(made.volumes[i]));
        }
        const Spectrum target = opaque_look(mix(pigments, volumes));
        const MatchResult found = match_spectrum(box, target);
        EXPECT_LT(found.recipes[0].error, 0.02);
        EXPECT_LT(found.recipes[0].ideal_error, 0.02);
        EXPECT_EQ(mixture_of(found.recipes[0].steps).volumes, found.recipes[0].mixture.volumes);
        for (const double index : found.recipes[0].metamerism) EXPECT_LT(index, 0.05);
    }
}

TEST(Match, ForSeveralIlluminantsNeverLosesToOne) {
    const std::vector<Pigment> box = small_box();
    Draw draw{42};
    int better = 0;
    for (int i = 0; i < 6; ++i) {
        const Spectrum target = upper_film(draw);
        for (const MatchGoal goal : {MatchGoal::worst, MatchGoal::mean}) {
            MatchOptions several;
            several.goal = goal;
            const FilmMatch common(box, target, several.illuminants, {});
            const MatchedRecipe best = match_spectrum(box, target, several).recipes[0];
            EXPECT_NEAR(common.error(best.mixture, goal), best.error, 1e-9);
            for (const Illuminant illuminant : several.illuminants) {
                MatchOptions one = several;
                one.illuminants = {illuminant};
                const double alone = common.error(match_spectrum(box, target, one).recipes[0].mixture, goal);
                EXPECT_LE(best.error, alone + 1e-12) << i << " " << name_of(illuminant);
                better += best.error < 0.9 * alone;
            }
        }
    }
    EXPECT_GT(better, 18) << "of 36: it must also be worth it";
}

TEST(Match, OfAFilmKnowsWhatLiesBelow) {
    const std::vector<Pigment> box = small_box();
    const Mixture made = mixture_of({{2, 0, 1}, {3, 2, 1}});
    const std::vector<Pigment> two = {box[2], box[3]};
    const std::vector<float> volumes = {static_cast<float>(made.volumes[0]),
                                        static_cast<float>(made.volumes[1])};
    FilmOnGround film{0.02, {}};
    film.below.fill(0.7f);
    const Spectrum target = film_look(mix(two, volumes), 0.02f, film.below);
    MatchOptions options;
    options.film = film;
    EXPECT_LT(match_spectrum(box, target, options).recipes[0].error, 0.1);
    // Over black, the same recipe would be another colour.
    options.film->below.fill(0.02f);
    const FilmMatch over_black(box, target, options.illuminants, options.film);
    EXPECT_GT(over_black.error(made, MatchGoal::worst), 5);
}

TEST(Match, GivesFewerPaintsWhereTheyDoAsWell) {
    const std::vector<Pigment> box = small_box();
    const Spectrum target = opaque_look({box[4].k, box[4].s});
    const MatchResult found = match_spectrum(box, target);
    ASSERT_FALSE(found.by_count.empty());
    EXPECT_EQ(found.by_count[0].mixture.count, 1);
    EXPECT_LT(found.by_count[0].error, 1e-3);
    EXPECT_EQ(found.by_count.size(), 1u) << "no more paints than help";
    MatchOptions two;
    two.max_paints = 2;
    Draw draw{5};
    for (const MatchedRecipe& r : match_spectrum(box, upper_film(draw), two).recipes)
        EXPECT_LE(r.mixture.count, 2);
}

TEST(Match, FindsItsPaintsInALargeBox) {
    // 19 paints and 38 that resemble them: more than all sets of four could be made of.
    std::vector<Pigment> box = artist_acrylics().paints;
    for (const float more : {1.3f, 1.7f})
        for (int i = 0; i < 19; ++i) {
            Pigment other = box[static_cast<std::size_t>(i)];
            other.name += fmt::format(" x {}", more);
            for (std::size_t band = 0; band < kBands; ++band)
                other.k[band] *= more * (1 + 0.2f * static_cast<float>(band % 3));
            box.push_back(other);
        }
    const std::vector<Pigment> two = {box[20], box[50]};
    const Spectrum target = opaque_look(mix(two, std::vector<float>{3, 1}));
    MatchOptions options;
    options.illuminants = {Illuminant::d65, Illuminant::a};
    EXPECT_LT(match_spectrum(box, target, options).recipes[0].error, 0.2);
}

TEST(PaintMedia, AreTakenOutOfABoxAndWeakPaintsAreNot) {
    Palette box = artist_acrylics();
    const std::size_t paints = box.paints.size();
    for (const Pigment& paint : artist_acrylics().paints) {
        Pigment glaze = finished(paint, {{}, {}, 0.9});
        glaze.name += ", glaze";
        box.paints.push_back(glaze);
    }
    Pigment varnish, gel, clear;
    varnish.name = "varnish", gel.name = "gel", clear.name = "clear";
    for (std::size_t band = 0; band < kBands; ++band)
        varnish.k[band] = static_cast<float>(std::pow(0.1, static_cast<double>(kBand_nm[band] - 410) / 220));
    gel.k.fill(0.001f);
    gel.s.fill(1);
    for (const Pigment& medium : {varnish, gel, clear}) box.paints.insert(box.paints.begin(), medium);
    const std::vector<std::string> names = {"clear", "gel", "varnish"};
    EXPECT_EQ(take_out_media(box), names);
    EXPECT_EQ(box.paints.size(), 2 * paints);
}

TEST(Match, SaysWhatIsWrong) {
    const std::vector<Pigment> box = small_box();
    MatchOptions options;
    options.max_paints = 9;
    EXPECT_NE(error_of([&] { match_spectrum(box, {}, options); }).find("max_paints"), std::string::npos);
    EXPECT_NE(error_of([&] { match_spectrum({}, {}); }).find("palette"), std::string::npos);
    options = {};
    options.illuminants.clear();
    EXPECT_NE(error_of([&] { match_spectrum(box, {}, options); }).find("D65,A,F11"), std::string::npos);
}

TEST(SpectrumOfAColour, HasTheColour) {
    for (const Illuminant illuminant :
         {Illuminant::a, Illuminant::d50, Illuminant::f11, Illuminant::warm_led}) {
        const glm::dvec3 xyz = white_xyz(illuminant) * glm::dvec3(0.35, 0.3, 0.15);
        const Spectrum r = smooth_spectrum(xyz, illuminant);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(xyz_of(r, illuminant)[c], xyz[c], 1e-4) << name_of(illuminant);
        for (const float v : r) EXPECT_TRUE(v >= 0 && v <= 1);
    }
    EXPECT_NE(error_of([] {
                  smooth_spectrum({0.1, 0.9, 0.1}, Illuminant::d65);
              }).find("no surface"),
              std::string::npos);
}

TEST(SpectrumOfAColour, IsOneThatThePaintsCanHave) {
    const std::vector<Pigment> box = small_box();
    const Mixture made = mixture_of({{0, 0, 1}, {4, 2, 1}, {2, 3, 1}});
    const std::vector<Pigment> three = {box[0], box[4], box[2]};
    const std::vector<float> volumes = {static_cast<float>(made.volumes[0]),
                                        static_cast<float>(made.volumes[1]),
                                        static_cast<float>(made.volumes[2])};
    const Spectrum truth = opaque_look(mix(three, volumes));
    const auto likely = likely_spectrum(box, xyz_of(truth, Illuminant::d65), Illuminant::d65);
    ASSERT_TRUE(likely);
    EXPECT_GT(likely->mixtures, 1);
    EXPECT_LT(delta_e_2000(lab_under(likely->reflectance), lab_under(truth)), 1);
    // It is as far off under another illuminant as it says that such mixtures are, about.
    const double off =
        delta_e_2000(lab_under(likely->reflectance, Illuminant::a), lab_under(truth, Illuminant::a));
    EXPECT_LT(off, 3 * likely->spread[static_cast<std::size_t>(Illuminant::a)] + 1);
}

TEST(Metamerism, IsNoneWhereTheSpectraAreTheSame) {
    Draw draw{3};
    const Spectrum a = upper_film(draw), b = upper_film(draw);
    EXPECT_LT(metamerism_index(a, a, Illuminant::a), 1e-6);
    EXPECT_LT(metamerism_index(a, b, Illuminant::d65), 1e-6) << "corrected to match there";
    EXPECT_GT(metamerism_index(a, b, Illuminant::a), 0.1);
}

TEST(ReflectanceFile, IsReadAtTheBands) {
    const Spectrum r = parse_reflectance(
        "nm;R\n400;0.1\n450;0.2\n# gap\n500\t0.3\n550 0.4\n600,0.5\n650,0.6\n700,0.7\n", "x");
    for (std::size_t band = 0; band < kBands; ++band)
        EXPECT_NEAR(r[band], 0.1 + (static_cast<double>(kBand_nm[band]) - 400) / 500, 1e-6);
    const auto wrong = [](const char* text) { return error_of([&] { parse_reflectance(text, "m.csv"); }); };
    EXPECT_NE(wrong("400,10\n410,20\n").find("m.csv: line 1: reflects 10 at 400 nm"), std::string::npos);
    EXPECT_NE(wrong("400,0.1\n390,0.2\n").find("line 2"), std::string::npos);
    EXPECT_NE(wrong("400,0.1\n500,0.2\n").find("50 nm at most"), std::string::npos);
    EXPECT_NE(wrong("450,0.1\n500,0.2\n").find("410 to 680"), std::string::npos);
    EXPECT_NE(wrong("a b\nc d\n").find("line 2"), std::string::npos);
    EXPECT_NE(wrong("").find("no wavelengths"), std::string::npos);
}

// 43 conservation colours from the 19 acrylics.
TEST(DataConservationColours, MatchBetterUnderAllIlluminantsThanUnderOne) {
    TP_DATA(tables, "tables");
    std::ifstream stream(tables / "gamblin_conservation_reflectance.csv");
    std::string line;
    std::getline(stream, line);
    double worst_of_all = 0, worst_of_d65 = 0, seconds = 0;
    int count = 0;
    while (std::getline(stream, line)) {
        std::istringstream cells(line.substr(line.rfind('"') + 2));
        std::vector<float> samples;
        for (std::string cell; std::getline(cells, cell, ',');) samples.push_back(std::stof(cell));
        Spectrum target;
        for (std::size_t band = 0; band < kBands; ++band)
            target[band] = samples[static_cast<std::size_t>((kBand_nm[band] - 380) / 10)];
        MatchOptions all, d65;
        d65.illuminants = {Illuminant::d65};
        const FilmMatch common(artist_acrylics().paints, target, all.illuminants, {});
        const auto start = std::chrono::steady_clock::now();
        worst_of_all += match_spectrum(artist_acrylics().paints, target, all).recipes[0].error;
        seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        worst_of_d65 += common.error(match_spectrum(artist_acrylics().paints, target, d65).recipes[0].mixture,
                                     MatchGoal::worst);
        ++count;
    }
    ASSERT_EQ(count, 43);
    fmt::print(
        "43 colours, at most 4 of 19 paints, measured out: mean worst dE2000 (D65, A, F11) {:.2f}, matched "
        "at "
        "D65 alone {:.2f}: {:.0f} %; {:.3f} s a recipe\n",
        worst_of_all / count, worst_of_d65 / count, 100 * worst_of_all / worst_of_d65, seconds / count);
    EXPECT_LE(worst_of_all, 0.6 * worst_of_d65);
}

}  // namespace
}  // namespace tangi
