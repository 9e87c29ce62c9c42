// list_order_doubts.cpp: what is told of the order of a list of lights.
#include <algorithm>
#include <cmath>

#include "fit/light_checks/axis_remedy.h"
#include "fit/light_checks/list_order.h"

namespace tangi {

namespace {

// Where slopes say that lights are turned, and another order is such a turn.
constexpr double kAlikeOrders = 0.7, kSameTurn_deg = 12;
// Else: metal, which is not matt, fits lights in some wrong order better
// (synth_canvas/uniform_8: ln -0.57 in reverse): the lights that photographs show must be near those of the
// order, too, and not near those as listed (of stacks whose lists are right: 0.2 to 3.5 degrees where they
// tell anything).
constexpr double kSureOfOrder = 6, kMostOrderScatter_deg = 4, kScatterRatio = 0.5;

// [deg] Between two turns, half a turn being none, as slopes tell no more; 180 between unlike kinds.
double between_deg(const LightTurn& a, const LightTurn& b) {
    if (a.mirrored != b.mirrored) return 180;
    const double off = std::fmod(std::abs(a.turn_deg - b.turn_deg), 180);
    return std::min(off, 180 - off);
}

// Whether another order does to all lights what `turn` does.
bool is_as(const LightTurn& turn, const ListOrder::Other& other) {
    return turn != LightTurn{} && other.alike > kAlikeOrders && between_deg(other.turn, turn) < kSameTurn_deg;
}

// What is wrong with the lights, in two ways to see it.
struct Asked {
    LightTurn as_taken;   // by slopes, of the lights as the user's flags turned them: these are right
    LightTurn as_listed;  // by both, where the flags are to make up for the order
};

// Whether another order is what is wrong.
bool explains(const ListOrder::Other& other, const ListOrder& order, const Asked& asked,
              bool fits_as_listed) {
    const double listed_scatter_deg = order.scatter_deg;
    const double left = order.explainable - other.explained,
                 left_listed = order.explainable - order.explained;
    const bool is_sure = other.certainty > kSureOfOrder;
    // Lights that are all turned leave as much unexplained, and scatter as little, as right ones, so these
    // are in another order.
    if (is_sure && left < kScatterRatio * kScatterRatio * left_listed) return true;
    if (!fits_as_listed && is_sure && other.scatter_deg < kMostOrderScatter_deg &&
        other.scatter_deg < kScatterRatio * listed_scatter_deg)
        return true;
    return other.scatter_deg < listed_scatter_deg &&
           (is_as(asked.as_listed, other) || is_as(asked.as_taken, other));
}

struct Told {
    std::string what, remedy;
};

Told told(const ListOrder::Other& other, const std::vector<std::string>& names) {
    const ListSlip& slip = other.slip;
    using Kind = ListSlip::Kind;
    if (slip.kind == Kind::snaked)
        return {
            fmt::format("runs to and fro in rows of {}, and the photographs do not (or the other way round)",
                        slip.row),
            "turn the directions of every second row round against their names"};
    if (slip.kind == Kind::columns || slip.kind == Kind::rows)
        return {fmt::format("goes row by row where the photographs go column by column ({} in a {})",
                            slip.row, slip.kind == Kind::columns ? "row" : "column"),
                "write its directions in the order of the photographs"};
    if (slip.kind == Kind::letters || slip.kind == Kind::counted)
        return {"is sorted by numbers and its names by letters (10 before 2), or the other way round",
                "sort both in one way, with numbers of equal length"};
    const int by = std::abs(slip.shift);
    std::string off = fmt::format("off by {} {}", by, by == 1 ? "photograph" : "photographs");
    if (slip.from == 0 && !slip.reversed && 2 * static_cast<std::size_t>(by) == names.size())
        off += ", so that its halves are exchanged";
    if (slip.reversed)
        return {"runs the other way" + (by > 0 ? ", and is " + off : std::string()),
                "turn its directions round against its names"};
    if (other.from)
        return {fmt::format("is {} from {} on", off, names[*other.from]),
                "a line is missing or too many there; move the directions after it against the names"};
    return {"is " + off, "move its directions against its names by as many lines"};
}

// Two photographs, and whose lights they fit.
std::string examples_of(const ListOrder::Other& other, const std::vector<std::string>& names) {
    std::string text;
    int told = 0;
    // The ends of a list that is shifted are left over.
    for (std::size_t i = other.slip.from + 1; i + 2 < names.size() && told < 2; ++i) {
        if (other.light_of[i] == i) continue;
        const long step = static_cast<long>(other.light_of[i]) - static_cast<long>(i);
        if (other.slip.kind == ListSlip::Kind::shifted && !other.slip.reversed && !other.by_lines &&
            step != other.slip.shift)
            continue;
        text += fmt::format("{}{} fits the light of {}", told++ == 0 ? "" : ", ", names[i],
                            names[other.light_of[i]]);
    }
    return text;
}

}  // namespace

bool ListOrder::fits_no_order() const {
    // Noise is explained by any three lights about as well as by chance.
    const bool is_shading = 2 * explainable > by_chance + 1;
    // Gloss takes from what a right list explains: of glossy paintings there may be a fifth left.
    return is_shading && explained <= most_by_chance;
}

std::string doubt_of_any_order(const ListOrder& order) {
    if (!order.fits_no_order()) return {};
    return fmt::format(
        "the lights do not fit the photographs in the order they are listed: they explain {:.0f} % of how "
        "shading changes, the list in random orders {:.0f} %, and any three lights could {:.0f} %. No other "
        "order that was tried fits either: look whether the list is of these photographs",
        100 * order.explained, 100 * order.by_chance, 100 * order.explainable);
}

std::string doubt_of(const ListOrder& order, const SignCheck& signs, const LightAxes& taken,
                     const std::vector<std::string>& names, bool fits_as_listed) {
    const LightTurn remedy_of_slopes = signs.remedy();
    const Asked asked{remedy_of_slopes, light_turn_of(taken).after(remedy_of_slopes)};
    const auto found = std::find_if(
        order.better.begin(), order.better.end(),
        [&](const ListOrder::Other& other) { return explains(other, order, asked, fits_as_listed); });
    if (found == order.better.end()) return {};
    const auto [what, remedy] = told(*found, names);
    std::string text = fmt::format(
        "the list of lights {}: {} (matt reflection fits {:.0f} % better so, {:.0f} standard errors): {}",
        what, examples_of(*found, names), 100 * (std::exp(-found->log_ratio) - 1), found->certainty, remedy);
    // Flags that turn lights as the order does were given in its place; others are right with it.
    const bool flags_are_right = is_as(asked.as_taken, *found) && !is_as(asked.as_listed, *found);
    if (taken.differ() && !flags_are_right) return text + "; leave out" + flags_given(taken);
    return asked.as_taken == LightTurn{} ? text
                                         : text + "; all lights turned would be wrong for some photographs";
}

std::string or_order(const ListOrder& order, const SignCheck& signs, const std::vector<std::string>& names) {
    if (!signs.wrong()) return {};
    const LightTurn turn = signs.remedy();
    const auto same = std::find_if(
        order.as_turns.begin(), order.as_turns.end(),
        [&](const ListOrder::Other& other) { return between_deg(other.turn, turn) < kSameTurn_deg; });
    if (same == order.as_turns.end()) return {};
    return fmt::format(
        ". Or the list of lights {}: lights that stand in an even ring look the same then, so it is the "
        "order "
        "or the turn. Look from which side {} is lit: from that of its own line, once turned, or from that "
        "of "
        "{}'s",
        told(*same, names).what, names.front(), names[same->light_of.front()]);
}

nlohmann::json to_json(const ListOrder& order) {
    nlohmann::json better = nlohmann::json::array();
    for (const ListOrder::Other& other : order.better)
        better.push_back({{"kind", name_of(other.slip.kind)},
                          {"shift", other.slip.shift},
                          {"row", other.slip.row},
                          {"from", other.from ? nlohmann::json(*other.from) : nlohmann::json(nullptr)},
                          {"reversed", other.slip.reversed},
                          {"by_lines", other.by_lines},
                          {"mirrored_y", other.turn.mirrored},
                          {"turn_deg", other.turn.turn_deg},
                          {"alike", other.alike},
                          {"log_ratio", other.log_ratio},
                          {"certainty", other.certainty},
                          {"scatter_deg", other.scatter_deg},
                          {"explained", other.explained}});
    return {{"scatter_deg", order.scatter_deg},       {"explained", order.explained},
            {"explainable", order.explainable},       {"by_chance", order.by_chance},
            {"most_by_chance", order.most_by_chance}, {"better", std::move(better)}};
}

}  // namespace tangi
