#include "fit/verdict/fit_result.h"

#include "fit/pipeline/fit_passes.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace {

nlohmann::json colour_of(const FitResult& fit) {
    const ColourReport& colour = fit.report.colour;
    const auto known = [](bool is, double value) {
        return is ? nlohmann::json(value) : nlohmann::json(nullptr);
    };
    return {{"corrected", colour.corrected},
            {"by", !colour.corrected   ? nlohmann::json(nullptr)
                   : colour.by_profile ? nlohmann::json("ICC profile")
                                       : nlohmann::json("colour chart")},
            {"chart_delta_e_2000", known(colour.delta_e_2000 >= 0, colour.delta_e_2000)},
            {"clamped_pixels", colour.clamped},
            {"patches", colour.patches},
            {"patches_delta_e_2000", known(colour.patches_delta_e > 0, colour.patches_delta_e)},
            {"white_level", fit.surface.photography.white_level},
            {"white_by_chart", colour.white_by_chart}};
}

nlohmann::json photographs_of(const FitResult& fit, const std::vector<RejectedPhoto>& rejected) {
    int fitted = 0, held_out = 0;
    for (const auto& photo : fit.surface.photography.photos) ++(photo.fitted ? fitted : held_out);
    nlohmann::json without_number = nlohmann::json::array();
    for (const auto& [name, pixels] : fit.report.without_number)
        without_number.push_back({{"name", name}, {"pixels", pixels}});
    return {{"fitted", fitted},
            {"held_out", held_out},
            {"rejected", to_json(rejected)},
            {"without_number", without_number}};
}

nlohmann::json transfer_of(const TransferEstimate& transfer) {
    nlohmann::json candidates = nlohmann::json::array();
    for (const auto& candidate : transfer.candidates)
        candidates.push_back({{"transfer", candidate.transfer.name()},
                              {"residual", candidate.residual},
                              {"probability", candidate.probability},
                              {"slopes_change_deg", candidate.slopes_change_deg}});
    return {{"name", transfer.transfer.name()}, {"source", transfer.source}, {"tried", candidates}};
}

}  // namespace

nlohmann::json fit_result(const FitResult& fit, const std::vector<RejectedPhoto>& rejected,
                          const std::string& out) {
    const FitReport& r = fit.report;
    return {
        {"painting", out},
        {"width", fit.surface.width()},
        {"height", fit.surface.height()},
        {"reduction", r.reduction},
        {"photographs", photographs_of(fit, rejected)},
        {"transfer", transfer_of(r.transfer)},
        {"colour", colour_of(fit)},
        {"registration", to_json(r.registration)},
        {"lights", to_json(r.lights)},
        {"light_axes_check", to_json(r.signs, r.shadow_signs)},
        {"light_outliers", to_json(r.light_outliers, r.photo_names)},
        {"sharpening", to_json(r.sharpening)},
        {"photo_misfits", to_json(r.photo_misfits, r.photo_names)},
        {"white_balances", to_json(r.white_balances, r.photo_names)},
        {"list_orders", to_json(r.list_order)},
        {"reflectance_model", to_json(r.reflectance_model)},
        {"specular_colour_pixels", r.coloured},
        {"anisotropic_pixels", r.anisotropic},
        {"pixels", {{"all", r.pixels}, {"fitted", r.fitted}, {"not_converged", r.not_converged}}},
        {"solver_agreement",
         {{"compared", r.solvers.compared},
          {"cost_within_1_percent", r.solvers.cost_agrees},
          {"else_batch_cheaper", r.solvers.cheaper},
          {"slope_within_0.01", r.solvers.slope_agrees},
          {"doubtful", r.solvers.doubtful},
          {"polished", r.solvers.polished}}},
        {"median_confidence", r.median_confidence},
        {"unsure_pixels", r.unsure},
        {"median_residual_sigma", r.median_rms_residual},
        {"mm_per_pixel", fit.surface.mm_per_pixel},
        {"scale_known", fit.surface.scale_known},
        {"support_tilt_deg", r.support_tilt_deg},
        {"support_bulge_deg", r.support_bulge_deg},
        {"refined", r.refined},
        {"final_height", to_json(r.height_choice)},
        {"light_angular_radius", to_json(r.light_angular_radius)},
        {"height_solver",
         {{"cycles", r.height.cycles}, {"residual", r.height.residual}, {"converged", r.height.converged}}},
        {"dry_hash", hash_of(fit.surface)}};
}

}  // namespace tangi
