// axis_check_doubts.cpp: what is told of lights whose axes are mirrored, turned or exchanged.
#include <fmt/format.h>

#include <cmath>

#include "fit/light_checks/axis_check_shadows.h"
#include "fit/light_checks/axis_remedy.h"

namespace tangi {

namespace {

// What slopes say is wrong with the lights; where they are turned, by `turn`.
std::string slopes_of(const SignCheck& signs, const LightTurn& turn) {
    const bool mirrored = signs.mirrored();
    std::string were =
        mirrored         ? "were one axis of all lights mirrored"
        : !turn.mirrored ? fmt::format("were all lights turned by {:.0f} degrees", signed_deg(turn.turn_deg))
                         : fmt::format("were y of all lights mirrored and they turned by {:.0f} degrees",
                                       signed_deg(turn.turn_deg));
    if (turn.mirrored && turn.turn_deg == 90) were = "were x and y of all lights exchanged";
    if (turn.mirrored && turn.turn_deg == 270)
        were = "were x and y of all lights exchanged and both mirrored";
    return fmt::format(
        "the slopes are those of no surface: their curl is {:.2g} a pixel, and {:.2g} {} ({:.0f} standard "
        "errors)",
        signs.curl, mirrored ? signs.curl_mirrored : signs.turned.curl, were,
        mirrored ? signs.certainty : signs.turned.certainty);
}

// Of lights that are turned.
std::string turn_doubt(const SignCheck& signs, const ShadowCheck& shadows, const LightAxes& taken) {
    LightTurn turn = shadows.certain() ? shadows.best : signs.remedy();
    // Half a turn more has the same slopes: the smaller one is likelier, and told first.
    if (!shadows.certain() && !turn.mirrored && std::abs(signed_deg(turn.turn_deg)) > 90)
        turn = turn.opposite();
    std::string text = slopes_of(signs, turn);
    if (!signs.turned.kind_is_sure())
        text += ". The relief runs one way, and leaves open whether an axis is mirrored besides";
    if (shadows.certain())
        return fmt::format("{}; cast shadows tell which way round ({:.0f} standard errors): {}", text,
                           shadows.certainty, axes_remedy(taken, shadows.best));
    return fmt::format("{}: {}; where that makes hills of valleys, {}", text, axes_remedy(taken, turn),
                       axes_remedy(taken, turn.opposite()));
}

}  // namespace

std::string doubt_of(const SignCheck& signs, const ShadowCheck& shadows, const LightAxes& taken) {
    const std::string told = fmt::format("({:.0f} standard errors)", shadows.certainty);
    if (signs.is_turned()) return turn_doubt(signs, shadows, taken);
    if (signs.mirrored()) {
        if (shadows.certain())
            return fmt::format("{}; cast shadows say that it is {} {}: {}", slopes_of(signs, {}),
                               shadows.best.turn_deg == 0 ? "y" : "x", told,
                               axes_remedy(taken, shadows.best));
        return fmt::format(
            "{}. Many lights files have y downwards: {}; where that makes hills of valleys, {}",
            slopes_of(signs, {}), axes_remedy(taken, {true, 0}), axes_remedy(taken, {true, 180}));
    }
    if (shadows.certain() && shadows.best.turn_deg == 180)
        return fmt::format(
            "cast shadows lie where hills and valleys are exchanged and all lights on the other side {}: {}",
            told, axes_remedy(taken, shadows.best));
    return {};
}

nlohmann::json to_json(const SignCheck& signs, const ShadowCheck& shadows) {
    nlohmann::json result = to_json(signs);
    nlohmann::json best = nlohmann::json::array();
    const bool half = shadows.best.turn_deg == 180;  // both axes are half a turn
    if (half) best.push_back("x");
    if (shadows.best.mirrored != half) best.push_back("y");
    result["shadows"] = {{"mirrored_axes", std::move(best)},
                         {"turn_deg", half ? 0 : shadows.best.turn_deg},
                         {"certainty", shadows.certainty},
                         {"contrast", shadows.contrast}};
    return result;
}

}  // namespace tangi
