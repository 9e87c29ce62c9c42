#include "capture/colour_calibration.h"

#include <algorithm>
#include <array>

#include "capture/html_text.h"
#include "surface/error.h"
#include "surface/picture_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kSoughtIn = 3;  // photographs

Image<Rgb> decoded(const Image<Rgb>& stored, const Transfer& transfer) {
    Image<Rgb> linear = stored;
    for (Rgb& pixel : linear.pixels())
        for (int c = 0; c < 3; ++c) pixel[c] = transfer.decode(pixel[c]);
    return linear;
}

double brightness(const Image<Rgb>& stored) {
    double sum = 0;
    for (const Rgb& pixel : stored.pixels()) sum += pixel.g;
    return sum / static_cast<double>(std::max<std::size_t>(stored.size(), 1));
}

std::vector<fs::path> spread(const std::vector<fs::path>& paths, int most) {
    if (static_cast<int>(paths.size()) <= most) return paths;
    std::vector<fs::path> chosen;
    for (int i = 0; i < most; ++i)
        chosen.push_back(paths[static_cast<std::size_t>(i) * paths.size() / static_cast<std::size_t>(most)]);
    return chosen;
}

// The paths from the brightest photograph to the darkest.
std::vector<fs::path> by_brightness(const std::vector<fs::path>& paths, const Progress& progress) {
    std::vector<std::pair<double, fs::path>> order;
    for (const fs::path& path : paths) {
        order.emplace_back(-brightness(read_picture(path)), path);
        report(progress, "chart: brightness",
               static_cast<double>(order.size()) / static_cast<double>(paths.size()));
    }
    std::sort(order.begin(), order.end());
    std::vector<fs::path> sorted;
    for (const auto& [dark, path] : order) sorted.push_back(path);
    return sorted;
}

// The colours as one transfer curve makes them.
struct Attempt {
    Transfer transfer;
    std::vector<ChartReading> readings;
};

}  // namespace

std::optional<ColourCalibration> calibrate_colours(const std::vector<fs::path>& paths,
                                                   const ColourCalibrationOptions& options,
                                                   const Progress& progress) {
    ColourCalibration result;
    result.reference = options.reference ? read_chart_reference(*options.reference) : classic_chart();
    const std::vector<fs::path> chosen = spread(paths, options.most_photos);
    const std::vector<fs::path> bright = by_brightness(chosen, progress);

    // Finding needs flat patches and the order of their colours, which any of the curves leaves.
    const Transfer any = options.transfer.value_or(Transfer{});
    bool found = false;
    for (int i = 0; i < std::min(kSoughtIn, static_cast<int>(bright.size())) && !found; ++i) {
        const fs::path& path = bright[static_cast<std::size_t>(i)];
        const Image<Rgb> linear = decoded(read_picture(path), any);
        std::optional<FoundChart> chart =
            options.corners_px ? chart_at(linear, *options.corners_px) : find_chart(linear);
        if (!chart) continue;
        found = true;
        result.chart = std::move(*chart);
        result.found_in = path.filename().string();
    }
    if (!found) return {};

    std::vector<Attempt> attempts;
    if (options.transfer)
        attempts.push_back({*options.transfer, {}});
    else
        for (const char* name : {"linear", "srgb", "2.2"}) attempts.push_back({*transfer_named(name), {}});
    for (const fs::path& path : chosen) {
        const Image<Rgb> stored = read_picture(path);
        result.photos.push_back(path.filename().string());
        for (Attempt& attempt : attempts)
            attempt.readings.push_back(
                read_chart(decoded(stored, attempt.transfer), result.chart, result.photos.back()));
        report(progress, "chart",
               static_cast<double>(result.photos.size()) / static_cast<double>(chosen.size() + 1));
    }
    const Attempt* best = nullptr;
    for (const Attempt& attempt : attempts) {
        ColourCorrection correction = correct_colours(attempt.readings, result.reference);
        if (best && !(correction.after.mean < result.correction.after.mean)) continue;
        best = &attempt;
        result.correction = std::move(correction);
    }
    result.transfer = best->transfer;
    result.transfer_source = options.transfer ? "given" : "chart";
    result.tolerances = judge_colours(result.correction);
    if (options.pitch_mm) result.scale = scale_from_chart(result.chart, glm::dvec2(*options.pitch_mm));
    const auto add = [&](const std::vector<std::string>& notes) {
        result.warnings.insert(result.warnings.end(), notes.begin(), notes.end());
    };
    add(result.chart.warnings);
    for (const ChartReading& reading : best->readings) add(reading.warnings);
    add(result.correction.warnings);
    if (result.scale) add(result.scale->warnings);
    report(progress, "chart", 1);
    return result;
}

nlohmann::json to_json(const ColourCalibration& c) {
    return {{"chart", to_json(c.chart)},
            {"found_in", c.found_in},
            {"photographs", c.photos},
            {"transfer", {{"name", c.transfer.name()}, {"source", c.transfer_source}}},
            {"correction", to_json(c.correction, c.reference)},
            {"tolerances", to_json(c.tolerances)},
            {"scale", c.scale ? to_json(*c.scale) : nlohmann::json(nullptr)},
            {"warnings", c.warnings}};
}

std::string colour_section(const ColourCalibration& c) {
    const Transfer srgb = *transfer_named("srgb");
    const auto css = [&](const Rgb& linear) {
        std::array<int, 3> code{};
        for (int k = 0; k < 3; ++k)
            code[static_cast<std::size_t>(k)] =
                static_cast<int>(std::lround(255 * std::clamp(srgb.encode(linear[k]), 0.0f, 1.0f)));
        return fmt::format("rgb({},{},{})", code[0], code[1], code[2]);
    };
    const ColourCorrection& correction = c.correction;
    std::string html = fmt::format(
        "<h2>Colour</h2><p class=\"soft\">Chart found in {} · read in {} photographs, taken as {} · mean "
        "ΔE2000 {:.2f} "
        "with white balance alone, <b>{:.2f}</b> corrected (worst patch {:.2f}); {:.2f} where each patch is "
        "predicted "
        "from the others</p><div class=\"row\"><figure class=\"card\"><svg width=\"372\" height=\"252\" "
        "role=\"img\" "
        "aria-label=\"patches: reference and corrected\">",
        escaped(c.found_in), c.photos.size(), c.transfer.name(), correction.before.mean,
        correction.after.mean, correction.after.maximum, correction.left_out.mean);
    for (int i = 0; i < kChartPatches; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const int x = 6 + 60 * (i % kChartColumns), y = 6 + 60 * (i / kChartColumns);
        const Rgb found =
            static_cast<float>(correction.exposure) * correction.apply(Rgb(correction.lights.even[at]));
        const double error = correction.after.patches[at];
        html += fmt::format(
            "<g><title>{6}{7}</title><rect x=\"{0}\" y=\"{1}\" width=\"54\" height=\"54\" fill=\"{2}\"/>"
            "<rect x=\"{3}\" y=\"{4}\" width=\"27\" height=\"27\" fill=\"{5}\"/></g>",
            x, y, css(c.reference.patches[at].linear), x + 14, y + 14, css(found),
            escaped(c.reference.patches[at].name),
            error >= 0 ? fmt::format(": ΔE2000 {:.2f}", error) : ", left out");
    }
    html +=
        "</svg><figcaption>Each patch as it should be; inside, as photographed and "
        "corrected.</figcaption></figure>"
        "<div class=\"card wide\"><table><tr><th>guideline</th><th>level</th><th>to the next</th></tr>";
    for (const ToleranceResult& t : c.tolerances) {
        std::string missed;
        for (const ToleranceCheck& check : t.missed)
            if (!check.kept())
                missed += fmt::format("{}{} {:.2f}, limit {:g}", missed.empty() ? "" : "; ", check.quantity,
                                      check.value, check.limit);
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>", t.standard,
                            t.level.empty() ? "none" : t.level, missed);
    }
    return html + "</table></div></div>";
}

}  // namespace tangi
