#include "capture/colour_chart/colour_calibration.h"

#include <algorithm>
#include <array>
#include <limits>

#include "capture/photo/stated_transfer.h"
#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kSoughtIn = 3;  // photographs

// At most so many of the numbers from 0 on, evenly.
std::vector<std::size_t> spread(std::size_t count, int most) {
    const auto wanted = std::min(count, static_cast<std::size_t>(most));
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(i * count / wanted);
    return chosen;
}

// The colours as one transfer curve makes them.
struct Attempt {
    Transfer transfer;
    std::vector<ChartReading> readings;
    WhiteBalances white_balances{};
};

// The white balance of each photograph beside the others, by the chart's patches; undone in the readings.
WhiteBalances balance(std::vector<ChartReading>& readings) {
    ColourSamples samples{readings.size(), {}, {}};
    for (std::size_t i = 0; i < kChartPatches; ++i) {
        samples.part.push_back(static_cast<int>(i % 4));
        for (const ChartReading& reading : readings)
            samples.values.push_back(reading.patches[i].state == PatchState::good
                                         ? reading.patches[i].mean
                                         : Rgb(std::numeric_limits<float>::quiet_NaN()));
    }
    WhiteBalances balances = white_balances(samples);
    for (std::size_t p = 0; p < readings.size(); ++p)
        for (PatchReading& patch : readings[p].patches) {
            patch.mean /= balances.gain(p);
            patch.sigma /= balances.gain(p);
        }
    return balances;
}

// In one of the brightest photographs. Finding needs flat patches and the order of their colours, which any
// of the curves leaves. False where there is none.
bool find_chart_in(const PhotoSet& photos, const ColourCalibrationOptions& options, const Progress& progress,
                   ColourCalibration& result) {
    const Transfer any = options.transfer.value_or(Transfer{});
    const std::vector<std::size_t> bright = photos.brightest_first("chart: brightness", progress);
    for (std::size_t i = 0; i < std::min<std::size_t>(kSoughtIn, bright.size()); ++i) {
        const Image<Rgb> linear = photos.linear(bright[i], any);
        std::optional<FoundChart> chart =
            options.corners_px ? chart_at(linear, *options.corners_px) : find_chart(linear);
        if (!chart) continue;
        result.chart = std::move(*chart);
        result.found_in = photos.name(bright[i]);
        return true;
    }
    return false;
}

// Transfer curves to try.
struct Attempts {
    std::vector<Attempt> all;
    std::string stated;  // where the file says bindingly how it is stored: then the first attempt counts
};
Attempts attempts_for(const PhotoSet& photos, const std::optional<Transfer>& given) {
    Attempts attempts;
    const PhotoHeader header = photos.open(0).header();
    if (photos.developed() || header.is_raw || header.is_float) {
        attempts.all.push_back({Transfer{}, {}});  // linear already
    } else if (given) {
        attempts.all.push_back({*given, {}});
    } else {
        const auto metadata = transfer_of_metadata(photos.metadata(0));
        if (metadata && metadata->binding && metadata->transfer) {
            attempts.stated = metadata->source;
            attempts.all.push_back({*metadata->transfer, {}});
        }
        for (const char* name : {"linear", "srgb", "2.2"})
            attempts.all.push_back({*transfer_named(name), {}});
    }
    return attempts;
}

void read_charts(const PhotoSet& photos, int most_photos, const Progress& progress,
                 std::vector<Attempt>& attempts, ColourCalibration& result) {
    const std::vector<std::size_t> chosen = spread(photos.size(), most_photos);
    for (const std::size_t photo : chosen) {
        result.photos.push_back(photos.name(photo));
        for (Attempt& attempt : attempts)
            attempt.readings.push_back(
                read_chart(photos.linear(photo, attempt.transfer), result.chart, result.photos.back()));
        report(progress, "chart",
               static_cast<double>(result.photos.size()) / static_cast<double>(chosen.size() + 1));
    }
}

// The attempt under which the chart fits best, or what the file says; its correction becomes the result's.
const Attempt& best_of(Attempts& attempts, const PhotoSet& photos, ColourCalibration& result) {
    const Attempt* best = nullptr;
    for (Attempt& attempt : attempts.all) {
        attempt.white_balances = balance(attempt.readings);
        ColourCorrection correction = correct_colours(attempt.readings, result.reference);
        const double now = correction.after.mean, before = result.correction.after.mean;
        if (best && !attempts.stated.empty()) {
            if (now < 0.5 * before - 0.25)
                result.warnings.push_back(
                    fmt::format("{}: its {} says {}, but the colour chart fits {} far better (mean CIEDE2000 "
                                "{:.2f} instead "
                                "of {:.2f}); if that is right, say so with --transfer",
                                photos.path(0).string(), attempts.stated, best->transfer.name(),
                                attempt.transfer.name(), now, before));
            continue;
        }
        if (best && !(now < before)) continue;
        best = &attempt;
        result.correction = std::move(correction);
    }
    return *best;
}

// What the chart, its readings and what follows from them say to the user.
void add_warnings(const Attempt& best, const std::string& folder, ColourCalibration& result) {
    const auto add = [&](const std::vector<std::string>& notes) {
        result.warnings.insert(result.warnings.end(), notes.begin(), notes.end());
    };
    for (const std::string& note : result.chart.warnings)
        result.warnings.push_back(fmt::format("{}: {}", result.found_in, note));
    for (const ChartReading& reading : best.readings) add(reading.warnings);
    add(result.correction.warnings);
    if (std::string warning =
            warning_of(result.white_balances, result.photos, folder,
                       "what is said of the chart is with this undone, and the fit undoes it");
        !warning.empty())
        result.warnings.push_back(std::move(warning));
    if (result.scale) add(result.scale->warnings);
}

}  // namespace

std::optional<ColourCalibration> calibrate_colours(const PhotoSet& photos,
                                                   const ColourCalibrationOptions& options,
                                                   const Progress& progress) {
    ColourCalibration result;
    result.reference = options.reference ? read_chart_reference(*options.reference) : classic_chart();
    if (!find_chart_in(photos, options, progress, result)) return {};
    Attempts attempts = attempts_for(photos, options.transfer);
    read_charts(photos, options.most_photos, progress, attempts.all, result);
    const Attempt& best = best_of(attempts, photos, result);
    result.transfer = photos.encoding().value_or(best.transfer);
    result.transfer_source = !attempts.stated.empty()  ? attempts.stated
                             : attempts.all.size() > 1 ? "chart"
                             : options.transfer        ? "given"
                                                       : "linear file";
    result.tolerances = judge_colours(result.correction);
    if (options.pitch_mm) result.scale = scale_from_chart(result.chart, glm::dvec2(*options.pitch_mm));
    result.white_balances = best.white_balances;
    add_warnings(best, photos.folder().string(), result);
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
            {"white_balances", to_json(c.white_balances, c.photos, true)},
            {"scale", c.scale ? to_json(*c.scale) : nlohmann::json(nullptr)},
            {"warnings", c.warnings}};
}

namespace {

std::string css_colour(const Rgb& linear) {
    const Transfer srgb = *transfer_named("srgb");
    std::array<int, 3> code{};
    for (int k = 0; k < 3; ++k)
        code[static_cast<std::size_t>(k)] =
            static_cast<int>(std::lround(255 * std::clamp(srgb.encode(linear[k]), 0.0f, 1.0f)));
    return fmt::format("rgb({},{},{})", code[0], code[1], code[2]);
}

// A patch as it should be, and inside as it was found.
std::string patch_picture(const ColourCalibration& c, int i) {
    const ColourCorrection& correction = c.correction;
    const auto at = static_cast<std::size_t>(i);
    const int x = 6 + 60 * (i % kChartColumns), y = 6 + 60 * (i / kChartColumns);
    const Rgb found =
        static_cast<float>(correction.exposure) * correction.apply(Rgb(correction.lights.even[at]));
    const double error = correction.after.patches[at];
    return fmt::format(
        "<g><title>{6}{7}</title><rect x=\"{0}\" y=\"{1}\" width=\"54\" height=\"54\" fill=\"{2}\"/>"
        "<rect x=\"{3}\" y=\"{4}\" width=\"27\" height=\"27\" fill=\"{5}\"/></g>",
        x, y, css_colour(c.reference.patches[at].linear), x + 14, y + 14, css_colour(found),
        escaped(c.reference.patches[at].name),
        error >= 0 ? fmt::format(": ΔE2000 {:.2f}", error) : ", rejected");
}

std::string chart_caption(const ColourCalibration& c) {
    std::string html =
        "<figcaption>Each patch as it should be; inside, as photographed and "
        "corrected.";
    if (const auto worst = c.correction.worst_photo())
        html += fmt::format(" Of the photographs by themselves, {} is the worst: mean ΔE2000 {:.2f}.",
                            escaped(c.photos[*worst]), c.correction.of_photos[*worst].after.mean);
    if (const int differing = c.white_balances.differing(); differing > 0)
        html += fmt::format(
            " The white balance of {} of them differs from that of the others, and is undone here.",
            differing);
    return html + "</figcaption>";
}

std::string tolerance_table(const std::vector<ToleranceResult>& tolerances) {
    std::string html = "<table><tr><th>guideline</th><th>level</th><th>to the next</th></tr>";
    for (const ToleranceResult& t : tolerances) {
        std::string missed;
        for (const ToleranceCheck& check : t.missed)
            if (!check.kept())
                missed += fmt::format("{}{} {:.2f}, limit {:g}", missed.empty() ? "" : "; ", check.quantity,
                                      check.value, check.limit);
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>", t.standard,
                            t.level.empty() ? "none" : t.level, missed);
    }
    return html + "</table>";
}

}  // namespace

std::string colour_section(const ColourCalibration& c) {
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
        correction.after.mean, correction.after.maximum, correction.cross_validated.mean);
    for (int i = 0; i < kChartPatches; ++i) html += patch_picture(c, i);
    return html + "</svg>" + chart_caption(c) + "</figure><div class=\"card wide\">" +
           tolerance_table(c.tolerances) + "</div></div>";
}

}  // namespace tangi
