// data_test.cpp: the acceptance figures of the fit on stacks beside the repository (see data_folder).
// Slow: minutes.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "capture/calibration/calibration_page.h"
#include "capture/photo/photo_file.h"
#include "fit/evaluate/compare.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/base/json_reading.h"
#include "surface/image/metrics.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

// Into the test's XML report and onto the terminal.
void record(const std::string& name, double value, const char* unit) {
    testing::Test::RecordProperty(name, fmt::format("{:.3f}", value));
    std::cout << fmt::format("[  FIGURE  ] {} {:.3f} {}\n", name, value, unit);
}

void expect_held_out_psnr(const fs::path& folder, double floor_db) {
    Stack stack = open_stack(folder);
    hold_out(stack, "4:8");
    const FitResult fit = fit_painting(stack);
    const CompareReport report = compare(fit.surface, stack);
    const std::string name = folder.filename().string();
    std::cout << fmt::format(
        "[  FIGURE  ] {} transfer {}, {} of {} pixels not converged, support tilt {:.1f} deg\n", name,
        fit.report.transfer.transfer.name(), fit.report.not_converged, fit.report.fitted,
        fit.report.support_tilt_deg);
    record(name + "_held_out_psnr_db", report.held_out.psnr_db, "dB");
    record(name + "_fitted_psnr_db", report.fitted.psnr_db, "dB");
    record(name + "_held_out_ssim", report.held_out.ssim, "");
    record(name + "_held_out_delta_e_2000", report.held_out.delta_e_2000, "");
    EXPECT_GE(report.held_out.psnr_db, floor_db);
}

TEST(DataRealStacks, DoorReaches35_5dB) {
    TP_DATA(folder, "real/door");
    expect_held_out_psnr(folder, 35.5);
}

TEST(DataRealStacks, FrescoReaches36dB) {
    TP_DATA(folder, "real/fresco");
    expect_held_out_psnr(folder, 36);
}

// The strength of a held-out light is what its direction makes likely, as for whoever relights. With that of
// the photographs before and after it, which nobody who relights has, icon had 34.0 dB.
TEST(DataRealStacks, IconReaches33dB) {
    TP_DATA(folder, "real/icon");
    expect_held_out_psnr(folder, 33);
}

TEST(DataRealStacks, CanvasReaches30_5dB) {
    TP_DATA(folder, "real/canvas");
    expect_held_out_psnr(folder, 30.5);
}

TEST(DataRealStacks, LeafReaches35dB) {
    TP_DATA(folder, "real/leaf");
    expect_held_out_psnr(folder, 35);
}

TEST(DataRealStacks, CoinReaches24_5dB) {
    TP_DATA(folder, "real/coin");
    expect_held_out_psnr(folder, 24.5);
}

double mean_angle_deg(const Image<Vec3>& a, const Image<Vec3>& b, const PixelMask& mask = {}) {
    double sum = 0;
    long count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!mask.empty() && !mask.pixels()[i]) continue;
        const glm::dvec3 u(a.pixels()[i]), v(b.pixels()[i]);
        sum += std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * 180 / std::numbers::pi;
        ++count;
    }
    return sum / static_cast<double>(count);
}

Image<Vec3> normalised(Image<Vec3> normals) {
    for (Vec3& n : normals.pixels()) n = glm::normalize(n);
    return normals;
}

// [dB] of the six held-out photographs, which are linear EXR files, as a camera would have stored them: sRGB.
double held_out_psnr_db(const Surface& surface, const fs::path& photos) {
    const Stack stack = open_stack(photos);
    const Transfer srgb{Transfer::Kind::srgb};
    double sum = 0;
    for (const StackPhoto& photo : stack.photos) {
        const Light light = as_photographed(photo.light, surface.photography);
        Image<Rgb> relit = relight(surface, {&light, 1}, {.cast_shadows = true});
        Image<Rgb> taken = read_picture(photo.path);
        for (Rgb& value : relit.pixels())
            value = srgb.encode(value * static_cast<float>(surface.photography.white_level));
        for (Rgb& value : taken.pixels()) value = srgb.encode(value);
        const double psnr = psnr_db(taken, relit, measured(surface.confidence));
        std::cout << fmt::format("[  FIGURE  ] impasto {}: {:.2f} dB\n", photo.light.name, psnr);
        sum += psnr;
    }
    return sum / static_cast<double>(stack.photos.size());
}

// How far a fit is from the ground truth in a folder: inside valid.png, and everywhere.
struct TruthErrors {
    double normals_deg = 0, normals_all_deg = 0;      // mean
    double height_mm_rms = 0, height_all_mm_rms = 0;  // after the plane of the difference is taken off
};
TruthErrors errors_against(const fs::path& truth, const Surface& s) {
    const Image<Rgb> valid_picture = read_picture(truth / "valid.png");
    const Image<Rgb> height_picture = read_picture(truth / "height.exr");
    PixelMask valid(s.width(), s.height());
    Image<float> difference(s.width(), s.height()), weight(s.width(), s.height());
    for (std::size_t i = 0; i < valid.size(); ++i) {
        valid.pixels()[i] = valid_picture.pixels()[i].r > 0.5f;
        weight.pixels()[i] = valid.pixels()[i];
        difference.pixels()[i] = s.height_mm.pixels()[i] - height_picture.pixels()[i].r;
    }
    subtract(best_plane(difference, weight), difference);
    double square = 0, count = 0, square_all = 0;
    for (std::size_t i = 0; i < valid.size(); ++i) {
        const double e = difference.pixels()[i];
        square_all += e * e;
        if (!valid.pixels()[i]) continue;
        square += e * e;
        ++count;
    }
    const Image<Vec3> normals = normalised(read_picture(truth / "normal.exr"));
    return {mean_angle_deg(s.normal, normals, valid), mean_angle_deg(s.normal, normals),
            std::sqrt(square / count), std::sqrt(square_all / static_cast<double>(valid.size()))};
}

// Median alpha of the pixels of a region, among those whose lobe is known to a factor of 1.5.
double median_roughness(const FitResult& fit, const std::function<bool(std::size_t)>& is_inside) {
    std::vector<float> values;
    for (std::size_t i = 0; i < fit.surface.roughness.size(); ++i) {
        const float alpha = fit.surface.roughness.pixels()[i];
        if (is_inside(i) && fit.errors.roughness.pixels()[i] < 0.4f * alpha) values.push_back(alpha);
    }
    EXPECT_GT(values.size(), 200u);
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

// Varnish is glossier than oil paint, which is glossier than a matt retouching.
void expect_order_of_roughness(const fs::path& truth, const FitResult& fit) {
    const Image<Rgb> varnish = read_picture(truth / "varnish.png"), loss = read_picture(truth / "loss.png"),
                     retouch = read_picture(truth / "retouch.png");
    const auto in = [](const Image<Rgb>& mask, std::size_t i) { return mask.pixels()[i].r > 0.9f; };
    const auto out = [](const Image<Rgb>& mask, std::size_t i) { return mask.pixels()[i].r < 0.1f; };
    const double glossy = median_roughness(
        fit, [&](std::size_t i) { return in(varnish, i) && out(retouch, i) && out(loss, i); });
    const double oil = median_roughness(
        fit, [&](std::size_t i) { return out(varnish, i) && out(retouch, i) && out(loss, i); });
    const double matt = median_roughness(fit, [&](std::size_t i) { return in(retouch, i); });
    record("impasto_roughness_varnish", glossy, "1");
    record("impasto_roughness_oil", oil, "1");
    record("impasto_roughness_retouch", matt, "1");
    EXPECT_LT(glossy, oil);
    EXPECT_LT(oil, matt);
}

TEST(DataImpasto, NormalsHeldOutLightsAndHeightReachTheirFigures) {
    TP_DATA(folder, "impasto");
    const FitResult fit = fit_painting(open_stack(folder / "png16"), {.mm_per_pixel = 0.390625});
    const TruthErrors errors = errors_against(folder / "gt", fit.surface);
    record("impasto_normals_deg", errors.normals_deg, "deg");
    record("impasto_normals_all_pixels_deg", errors.normals_all_deg, "deg");
    record("impasto_height_mm_rms", errors.height_mm_rms, "mm");
    record("impasto_height_all_pixels_mm_rms", errors.height_all_mm_rms, "mm");
    EXPECT_LE(errors.normals_deg, 0.85);
    EXPECT_LE(errors.height_mm_rms, 0.04);
    EXPECT_TRUE(fit.report.height.converged);
    expect_order_of_roughness(folder / "gt", fit);

    const double psnr = held_out_psnr_db(fit.surface, folder / "exr");
    record("impasto_held_out_psnr_db", psnr, "dB");
    EXPECT_GE(psnr, 35);
}

// Mean CIEDE2000 of rho_d in the chart's patches, at the places that the scene says.
double chart_delta_e(const fs::path& props, const Surface& s) {
    const nlohmann::json chart = read_json(bytes_of(props), "JSON").at("chart");
    double sum = 0;
    for (const nlohmann::json& patch : chart) {
        const auto corner = [&](std::size_t k) {
            const nlohmann::json& c = patch.at("px_ref_corners_tl_tr_br_bl").at(k);
            return glm::dvec2(c.at(0).get<double>(), c.at(1).get<double>());
        };
        const glm::dvec2 low = glm::mix(corner(0), corner(2), 0.25),
                         high = glm::mix(corner(0), corner(2), 0.75);
        Rgb mean(0);
        int count = 0;
        for (int y = static_cast<int>(std::ceil(low.y)); y <= high.y; ++y)
            for (int x = static_cast<int>(std::ceil(low.x)); x <= high.x; ++x, ++count)
                mean += s.diffuse(x, y);
        const auto& linear = patch.at("linear");
        sum += delta_e_2000(lab_from_linear(glm::dvec3(mean / static_cast<float>(count))),
                            lab_from_linear({linear.at(0).get<double>(), linear.at(1).get<double>(),
                                             linear.at(2).get<double>()}));
    }
    return sum / static_cast<double>(chart.size());
}

// Nothing of the ground truth goes in: lights from the two spheres, the camera's shake from the photographs.
TEST(DataHandheld, PaintingOfAHandheldLightReachesItsFigures) {
    TP_DATA(folder, "handheld");
    const TestDir out;
    std::vector<std::string> warnings;
    const SphereCalibration spheres = calibrate_from_spheres(
        pictures_in(folder / "png16", warnings),
        {.sphere_radius_mm = 12, .focal_px = 1408, .camera_distance_mm = 600, .sphere_height_mm = 6});
    const CalibrationFiles files = write_calibration(
        out / "lights.lp", {.lights = spheres,
                            .colours = calibrate_colours(pictures_in(folder / "png16", warnings),
                                                         {.reference = folder / "chart_reference.json"})});
    Stack stack = open_stack(folder / "png16", {.lights_file = files.json});
    EXPECT_EQ(stack.transfer, Transfer{});  // by the chart
    const FitResult fit = fit_painting(std::move(stack));
    EXPECT_NEAR(fit.surface.mm_per_pixel, 600.0 / 1408, 0.003 * 600 / 1408);
    const TruthErrors errors = errors_against(folder / "gt", fit.surface);
    record("handheld_normals_deg", errors.normals_deg, "deg");
    record("handheld_height_mm_rms", errors.height_mm_rms, "mm");
    EXPECT_LE(errors.normals_deg, 2.5);
    EXPECT_LE(errors.height_mm_rms, 0.25);

    // The chart's patches where the scene had them, and all of the painting, against the true reflectance.
    const double patches = chart_delta_e(folder / "gt" / "props.json", fit.surface);
    record("handheld_chart_delta_e_2000", patches, "1");
    record("handheld_chart_delta_e_2000_by_the_fit", fit.report.colour.patches_delta_e, "1");
    EXPECT_LE(patches, 1.5);
    EXPECT_NEAR(fit.report.colour.patches_delta_e, patches, 0.3);
    const Image<Rgb> albedo = read_picture(folder / "gt" / "albedo.exr");
    const Image<Rgb> valid = read_picture(folder / "gt" / "valid.png");
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < albedo.size(); ++i) {
        if (!(valid.pixels()[i].r > 0.5f)) continue;
        sum += delta_e_2000(lab_from_linear(glm::dvec3(fit.surface.diffuse.pixels()[i])),
                            lab_from_linear(glm::dvec3(albedo.pixels()[i])));
        ++count;
    }
    record("handheld_painting_delta_e_2000", sum / count, "1");
    EXPECT_LE(sum / count, 5);
}

TEST(DataSynthCanvas, NormalsOfUniform1AreWithin0_3Degrees) {
    TP_DATA(folder, "synth_canvas/uniform_1/Dome");
    const FitResult fit = fit_painting(open_stack(folder));
    Image<Vec3> truth = read_picture(folder / "normals.png");  // v / 65535, so n = 2 v - 1
    for (Vec3& n : truth.pixels()) n = glm::normalize(2.0f * n - 1.0f);
    const double angle = mean_angle_deg(fit.surface.normal, truth);
    std::cout << "[  FIGURE  ] synth_canvas transfer " << fit.report.transfer.transfer.name() << "\n";
    record("synth_canvas_uniform_1_normals_deg", angle, "deg");
    EXPECT_LE(angle, 0.3);
}

}  // namespace
}  // namespace tangi
