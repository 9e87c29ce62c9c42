#include "fit/exchange/ptm_hsh.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "surface/image/metrics.h"
#include "surface/image_file/image_io.h"
#include "tests/support/fit/fit_test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

constexpr RtiBasis kAll[] = {RtiBasis::ptm, RtiBasis::hsh4, RtiBasis::hsh9, RtiBasis::hsh16};

// Photographs, 16 bit, of three pixels whose values are a known combination of the basis.
struct KnownCoefficients {
    TestDir folder;
    std::vector<Light> lights = dome_lights(40, 10);
    RtiImage truth;

    explicit KnownCoefficients(RtiBasis basis, bool lrgb = false) {
        truth = {basis, lrgb, 3, 1, {}, {}};
        truth.coefficients.resize(3 * truth.stride());
        Random random(7);
        for (float& c : truth.coefficients) c = random.real(-0.04, 0.04);
        const std::size_t terms = static_cast<std::size_t>(terms_of(basis));
        const std::size_t constant = basis == RtiBasis::ptm ? 5 : 0;
        for (std::size_t i = constant; i < truth.coefficients.size(); i += terms)
            truth.coefficients[i] += 0.9f;
        if (lrgb) {
            truth.colour = Image<Rgb>(3, 1, Rgb(1));
            truth.colour(1, 0) = Rgb(0.5f, 1, 0.25f);
            truth.colour(2, 0) = Rgb(1, 0.1f, 0.9f);
        }
        for (const Light& light : lights)
            write_picture(folder / light.name, evaluate(truth, light.direction), Transfer{});
        write_lights(folder / "lights.lp", lights);
    }
};

TEST(Rti, HarmonicsAreOrthonormalOverTheHemisphere) {
    constexpr int steps = 400;
    std::array<std::array<double, kMostRtiTerms>, kMostRtiTerms> product{};
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double z = (i + 0.5) / steps, phi = 2 * std::numbers::pi * (j + 0.5) / steps;
            const double across = std::sqrt(1 - z * z);
            const auto h = rti_terms(RtiBasis::hsh16,
                                     Vec3(glm::dvec3(across * std::cos(phi), across * std::sin(phi), z)));
            for (std::size_t a = 0; a < h.size(); ++a)
                for (std::size_t b = 0; b < h.size(); ++b)
                    product[a][b] += h[a] * h[b] * 2 * std::numbers::pi / (steps * steps);
        }
    for (std::size_t a = 0; a < kMostRtiTerms; ++a)
        for (std::size_t b = 0; b < kMostRtiTerms; ++b)
            EXPECT_NEAR(product[a][b], a == b ? 1 : 0, 2e-3) << a << ", " << b;
}

TEST(Rti, KnownCoefficientsAreRecovered) {
    for (const RtiBasis basis : kAll)
        for (const bool lrgb : {false, true}) {
            const KnownCoefficients known(basis, lrgb);
            const RtiImage fitted = fit_rti(open_stack(known.folder.path()), basis, lrgb);
            ASSERT_EQ(fitted.coefficients.size(), known.truth.coefficients.size());
            for (std::size_t i = 0; i < fitted.coefficients.size(); ++i)
                EXPECT_NEAR(fitted.coefficients[i], known.truth.coefficients[i], 2e-3)
                    << name_of(basis) << (lrgb ? " lrgb " : " ") << i;
            const Vec3 unseen = glm::normalize(Vec3(0.3f, -0.5f, 0.7f));
            EXPECT_TRUE(images_near(evaluate(fitted, unseen), evaluate(known.truth, unseen), 1e-3));
        }
}

TEST(Rti, HeldOutPhotographsHaveNoPart) {
    KnownCoefficients known(RtiBasis::hsh9);
    write_picture(known.folder / known.lights[5].name, Image<Rgb>(3, 1, Rgb(0.01f)), Transfer{});
    Stack stack = open_stack(known.folder.path());
    hold_out(stack, "5");
    const RtiImage fitted = fit_rti(stack, RtiBasis::hsh9);
    const Vec3 there = known.lights[5].direction;
    EXPECT_TRUE(images_near(evaluate(fitted, there), evaluate(known.truth, there), 1e-3));
}

TEST(Rti, TooFewLightsAndLightsOfOneElevationAreErrors) {
    KnownCoefficients known(RtiBasis::ptm);
    Stack stack = open_stack(known.folder.path());
    const std::vector<StackPhoto> all = stack.photos;
    stack.photos.resize(8);
    EXPECT_THAT(error_of([&] { fit_rti(stack, RtiBasis::hsh9); }), HasSubstr("8 photographs are too few"));
    stack.photos = all;
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        const double turn = 0.4 * static_cast<double>(i);
        stack.photos[i].light.direction = glm::normalize(Vec3(glm::dvec3(std::cos(turn), std::sin(turn), 1)));
    }
    EXPECT_THAT(error_of([&] { fit_rti(stack, RtiBasis::ptm); }),
                HasSubstr("determine only 5 of the 6 terms"));
}

TEST(Rti, APaintingIsSampledAsItIsRelit) {
    Surface s(4, 3);
    for (std::size_t i = 0; i < s.diffuse.size(); ++i) {
        s.diffuse.pixels()[i] = Rgb(0.2f + 0.05f * static_cast<float>(i), 0.5f, 0.7f);
        s.confidence.pixels()[i] = 1;
    }
    const Transfer srgb{Transfer::Kind::srgb};
    const Light light = distant_light({0.3f, 0.4f, 0.8f});
    Image<Rgb> expected = relight(s, {&light, 1});
    for (Rgb& value : expected.pixels()) value = srgb.encode(value);
    for (const bool lrgb : {false, true}) {
        const RtiImage image = rti_of(s, RtiBasis::hsh16, lrgb, srgb);
        EXPECT_GT(psnr_db(evaluate(image, light.direction), expected), lrgb ? 33 : 40) << lrgb;
    }
}

// DESIGN section 6: least squares a channel, photographs 4, 12, 20, … held out.
TEST(DataRti, BaselinesOfRealStacksAreReproduced) {
    struct Row {
        const char* name;
        double ptm_db, hsh_db;
    };
    for (const Row& row : {Row{"door", 35.7, 36.2}, Row{"fresco", 28.2, 36.9}, Row{"icon", 22.0, 27.4},
                           Row{"canvas", 26.5, 26.4}}) {
        TP_DATA(folder, std::string("real/") + row.name);
        Stack stack = open_stack(folder);
        hold_out(stack, "4:8");
        for (const RtiBasis basis : {RtiBasis::ptm, RtiBasis::hsh9}) {
            const RtiImage image = fit_rti(stack, basis);
            double sum = 0;
            for (const StackPhoto& photo : stack.held_out)
                sum += psnr_db(read_picture(photo.path), evaluate(image, photo.light.direction));
            const double mean_db = sum / static_cast<double>(stack.held_out.size());
            std::cout << fmt::format("[  FIGURE  ] {} {}: {:.2f} dB\n", row.name, name_of(basis), mean_db);
            EXPECT_NEAR(mean_db, basis == RtiBasis::ptm ? row.ptm_db : row.hsh_db, 0.1)
                << row.name << " " << name_of(basis);
        }
    }
}

}  // namespace
}  // namespace tangi
