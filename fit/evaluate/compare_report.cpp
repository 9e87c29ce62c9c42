#include "fit/evaluate/compare.h"
#include "surface/base/json_text.h"

namespace tangi {

using nlohmann::json;

json to_json(const CompareReport& report) {
    json photos = json::array();
    for (const PhotoComparison& p : report.photos) {
        const Vec3& l = p.light.direction;
        photos.push_back({{"name", valid_utf8(p.name)},
                          {"fitted", p.fitted},
                          {"light", {l.x, l.y, l.z}},
                          {"elevation_deg", p.elevation_deg},
                          {"azimuth_deg", p.azimuth_deg},
                          {"psnr_db", p.psnr_db},
                          {"ssim", p.ssim},
                          {"delta_e_2000", p.delta_e_2000},
                          {"delta_e_2000_p95", p.delta_e_2000_p95},
                          {"bias", p.bias}});
        if (p.white_balance) photos.back()["white_balance"] = {p.white_balance->x, p.white_balance->y};
        if (p.residual_psnr_db) photos.back()["residual_psnr_db"] = *p.residual_psnr_db;
    }
    const auto mean = [](const ComparisonMean& m) {
        const auto number = [&](double value) { return m.count > 0 ? json(value) : json(nullptr); };
        json means = {{"count", m.count},
                      {"psnr_db", number(m.psnr_db)},
                      {"ssim", number(m.ssim)},
                      {"delta_e_2000", number(m.delta_e_2000)}};
        if (m.residual_psnr_db) means["residual_psnr_db"] = *m.residual_psnr_db;
        return means;
    };
    json warnings = json::array();
    for (const std::string& warning : report.warnings) warnings.push_back(valid_utf8(warning));
    for (const std::string* doubt : {&report.foreign, &report.exchanged})
        if (!doubt->empty()) warnings.push_back(valid_utf8(*doubt));
    // For who reads the means by program or by eye: what they are worth.
    const bool predicts = report.held_out.count > 0;
    const char* judged =
        predicts
            ? "held-out photographs: how well the painting predicts light that the fit never saw"
            : "fitted photographs only, as none was held out: how well the fit repeats what it has seen, "
              "not how well it predicts new light (fit with --hold-out, or compare with other photographs)";
    return {
        {"photos", std::move(photos)},
        {"judged_by", predicts ? "held_out" : "fitted"},
        {"judged_by_in_words", judged},
        {"mean",
         {{"held_out", mean(report.held_out)}, {"fitted", mean(report.fitted)}, {"all", mean(report.all)}}},
        {"worst", valid_utf8(report.worst)},
        {"transfer", report.transfer.name()},
        {"width", report.width},
        {"height", report.height},
        {"options", to_json<CompareOptions>(report.options)},
        {"warnings", std::move(warnings)}};
}

}  // namespace tangi
