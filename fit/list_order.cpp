#include "fit/list_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>

#include "capture/matt_sample.h"
#include "fit/log_ratio.h"
#include "fit/odd_lights.h"
#include "surface/light.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

using Order = std::vector<std::size_t>;

constexpr std::size_t kFewestListed = 8;
constexpr int kFarthestShift = 3;      // [photographs] that a list is likely to be off by
constexpr std::size_t kMostFrom = 24;  // photographs that are tried first as those from which a list is off
constexpr int kOrderRounds = 2;        // of the lamps' strengths, which may differ
constexpr int kScreened = 500, kLookedAt = 4000;  // samples to look for orders with, and to judge them by
constexpr std::size_t kMostJudged = 3;            // orders
constexpr double kMostDeviation = 8;  // times the median one, beyond which a deviation counts no more
constexpr int kOrderParts = 8;        // of the picture, along each side
constexpr double kFewestOfParts = 16;
// Where slopes say that lights are turned, and another order is such a turn.
constexpr double kAlikeOrders = 0.7, kSameTurn_deg = 12;
constexpr double kSureOfTurned = 3;  // [standard errors]
// Else: metal, which is not matt, fits lights in some wrong order better
// (synth_canvas/uniform_8: ln -0.57 in reverse): the lights that photographs show must be near those of the
// order, too, and not near those as listed (of stacks whose lists are right: 0.2 to 3.5 degrees where they
// tell anything).
constexpr double kSureOfOrder = 6, kMostOrderScatter_deg = 4, kScatterRatio = 0.5;

// Positions in a list of n, to those whose light they have.
struct Slip {
    int shift = 0;
    std::size_t from = 0;
    bool reversed = false;

    std::size_t of(std::size_t i, std::size_t n) const {
        if (i < from) return i;
        const auto count = static_cast<int>(n);
        const int at = (reversed ? count - 1 - static_cast<int>(i) : static_cast<int>(i)) + shift;
        return static_cast<std::size_t>(((at % count) + count) % count);
    }
};

// `sequence`: the photographs in the order that counts.
Order order_of(const Slip& slip, const Order& sequence) {
    Order order(sequence.size());
    for (std::size_t i = 0; i < sequence.size(); ++i)
        order[sequence[i]] = sequence[slip.of(i, sequence.size())];
    return order;
}

std::vector<Light> in_order(const std::vector<Light>& lights, const Order& order) {
    std::vector<Light> result = lights;
    for (std::size_t i = 0; i < lights.size(); ++i) result[i].direction = lights[order[i]].direction;
    return result;
}

// All slips worth a look, those from photographs inside of the list in steps.
std::vector<Slip> slips_of(std::size_t photos) {
    std::vector<Slip> slips;
    for (int shift = 1; shift <= kFarthestShift; ++shift)
        for (const int sign : {1, -1}) slips.push_back({sign * shift, 0, false});
    for (const int shift : {0, 1, -1}) slips.push_back({shift, 0, true});
    const std::size_t step = std::max<std::size_t>(1, photos / kMostFrom);
    for (std::size_t from = 2; from + 2 < photos; from += step)
        for (const int shift : {1, -1}) slips.push_back({shift, from, false});
    return slips;
}

// Those between two that were looked at.
std::vector<Slip> slips_near(const Slip& slip, std::size_t photos) {
    const std::size_t step = std::max<std::size_t>(1, photos / kMostFrom);
    std::vector<Slip> slips;
    if (slip.from == 0) return slips;
    for (std::size_t from = slip.from > step ? slip.from - step + 1 : 1; from < slip.from + step; ++from)
        if (from != slip.from && from + 1 < photos) slips.push_back({slip.shift, from, slip.reversed});
    return slips;
}

// What an order does to all lights on the whole: the turn, with y mirrored or not, that takes their x and y
// nearest to those of the order (Procrustes).
void find_turn(const std::vector<Light>& lights, ListOrder::Other& other) {
    std::complex<double> turned = 0, mirrored = 0;
    double squares = 0;
    const auto plane = [&](std::size_t i) {
        return std::complex<double>(static_cast<double>(lights[i].direction.x),
                                    static_cast<double>(lights[i].direction.y));
    };
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::complex<double> to = plane(other.light_of[i]);
        turned += std::conj(plane(i)) * to;
        mirrored += plane(i) * to;
        squares += std::norm(plane(i));
    }
    const bool is_mirrored = std::abs(mirrored) > std::abs(turned);
    const std::complex<double> best = is_mirrored ? mirrored : turned;
    const double degrees = std::arg(best) * kDegrees;
    other.turn = {is_mirrored, degrees < 0 ? degrees + 360 : degrees};
    other.alike = squares > 0 ? std::abs(best) / squares : 0;
}

// The samples of one survey, and how orders of one list explain them.
class OrderTrial {
public:
    OrderTrial(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights, int width,
               int height, int samples)
        : survey_(survey),
          transfer_(transfer),
          lights_(lights),
          width_(width),
          height_(height),
          samples_(samples) {
        const MattSample listed = sample_of(lights);
        most_ = kMostDeviation * std::max(listed.residual(), 1e-6);
        index_ = listed.index;
        listed_ = listed.mean_deviations(most_);
    }

    double listed() const { return mean(listed_); }
    double of(const Order& order) const { return mean(deviations(order)); }

    // [deg] Of the lights that photographs show about those in this order.
    double scatter_deg(const Order& order) const {
        std::vector<Light> lights = in_order(lights_, order);
        const MattSample sample = sample_of(lights);
        for (std::size_t i = 0; i < lights.size(); ++i)
            lights[i].gain = Rgb(static_cast<float>(std::exp(sample.log_strengths[i])));
        return odd_lights(survey_, transfer_, lights, width_, height_).scatter_deg;
    }

    void judge(ListOrder::Other& other) const {
        const std::vector<double> here = deviations(other.light_of);
        std::vector<std::array<double, 3>> parts(kOrderParts * kOrderParts, {0, 0, 0});
        for (std::size_t k = 0; k < here.size(); ++k) {
            if (std::isnan(here[k]) || std::isnan(listed_[k])) continue;
            const glm::ivec2 at = survey_.positions[static_cast<std::size_t>(index_[k])];
            auto& part = parts[static_cast<std::size_t>(at.y * kOrderParts / height_ * kOrderParts +
                                                        at.x * kOrderParts / width_)];
            part[0] += here[k], part[1] += listed_[k], part[2] += 1;
        }
        LogRatio ratio;
        for (const auto& [ordered, as_listed, count] : parts)
            if (count > 0) ratio.add(ordered, as_listed);
        if (ratio.count() < kFewestOfParts) return;
        other.log_ratio = ratio.mean();
        other.certainty = ratio.certainty();
    }

private:
    MattSample sample_of(const std::vector<Light>& lights) const {
        return matt_sample(lights, survey_, transfer_, width_, height_, samples_, kOrderRounds);
    }
    std::vector<double> deviations(const Order& order) const {
        return sample_of(in_order(lights_, order)).mean_deviations(most_);
    }
    static double mean(const std::vector<double>& values) {
        double sum = 0, count = 0;
        for (const double value : values)
            if (!std::isnan(value)) sum += value, ++count;
        return count > 0 ? sum / count : 0;
    }

    const Survey& survey_;
    const Transfer& transfer_;
    const std::vector<Light>& lights_;
    int width_, height_, samples_;
    double most_ = 0;
    std::vector<int> index_;
    std::vector<double> listed_;
};

struct Screened {
    Slip slip;
    bool by_lines;
    double deviation;
};

void screen(const OrderTrial& trial, const std::vector<Slip>& slips, const Order& sequence, bool by_lines,
            std::vector<Screened>& found) {
    std::vector<double> deviation(slips.size());
    parallel_for(0, static_cast<int>(slips.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            deviation[i] = trial.of(order_of(slips[i], sequence));
    });
    for (std::size_t i = 0; i < slips.size(); ++i)
        if (deviation[i] < trial.listed()) found.push_back({slips[i], by_lines, deviation[i]});
}

bool is_nearer(const Screened& a, const Screened& b) { return a.deviation < b.deviation; }

// [deg] Between two turns, half a turn being none, as slopes tell no more; 180 between unlike kinds.
double between_deg(const LightTurn& a, const LightTurn& b) {
    if (a.mirrored != b.mirrored) return 180;
    const double off = std::fmod(std::abs(a.turn_deg - b.turn_deg), 180);
    return std::min(off, 180 - off);
}

// Whether another order is what is wrong, `turn` being what slopes, and the user, ask of the lights as
// listed.
bool explains(const ListOrder::Other& other, double listed_scatter_deg, const LightTurn& turn) {
    // Lights that are all turned scatter as little as right ones, so these are in another order.
    if (other.certainty > kSureOfOrder && other.scatter_deg < kMostOrderScatter_deg &&
        other.scatter_deg < kScatterRatio * listed_scatter_deg)
        return true;
    return turn != LightTurn{} && other.certainty > kSureOfTurned && other.alike > kAlikeOrders &&
           other.scatter_deg < listed_scatter_deg && between_deg(other.turn, turn) < kSameTurn_deg;
}

// Two photographs, and whose lights they fit.
std::string examples_of(const ListOrder::Other& other, const std::vector<std::string>& names) {
    std::string text;
    int told = 0;
    // The ends of a list that is shifted are left over.
    for (std::size_t i = other.from.value_or(0) + 1; i + 2 < names.size() && told < 2; ++i) {
        const long step = static_cast<long>(other.light_of[i]) - static_cast<long>(i);
        if (!other.reversed && !other.by_lines && step != other.shift) continue;
        text += fmt::format("{}{} fits the light of {}", told++ == 0 ? "" : ", ", names[i],
                            names[other.light_of[i]]);
    }
    return text;
}

}  // namespace

ListOrder check_list_order(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                           const std::vector<int>& lines, int width, int height) {
    ListOrder result;
    if (lights.size() < kFewestListed) return result;
    Order by_name(lights.size());
    std::iota(by_name.begin(), by_name.end(), std::size_t{0});
    Order by_line = by_name;
    std::stable_sort(by_line.begin(), by_line.end(),
                     [&](std::size_t a, std::size_t b) { return lines[a] < lines[b]; });
    const OrderTrial few(survey, transfer, lights, width, height, kScreened);
    std::vector<Screened> found;
    const std::vector<Slip> slips = slips_of(lights.size());
    screen(few, slips, by_name, false, found);
    if (by_line != by_name) screen(few, slips, by_line, true, found);
    if (found.empty()) return result;
    const Screened best = *std::min_element(found.begin(), found.end(), is_nearer);
    screen(few, slips_near(best.slip, lights.size()), best.by_lines ? by_line : by_name, best.by_lines,
           found);
    std::stable_sort(found.begin(), found.end(), is_nearer);
    found.resize(std::min(found.size(), kMostJudged));
    const OrderTrial many(survey, transfer, lights, width, height, kLookedAt);
    for (const Screened& s : found) {
        const Order& sequence = s.by_lines ? by_line : by_name;
        ListOrder::Other other{.light_of = order_of(s.slip, sequence),
                               .shift = s.slip.shift,
                               .reversed = s.slip.reversed,
                               .by_lines = s.by_lines,
                               .turn = {}};
        if (s.slip.from > 0) other.from = sequence[s.slip.from];
        find_turn(lights, other);
        many.judge(other);
        if (!(other.log_ratio < 0 && other.certainty > kSureOfTurned)) continue;
        other.scatter_deg = many.scatter_deg(other.light_of);
        result.better.push_back(std::move(other));
    }
    if (!result.better.empty()) result.scatter_deg = many.scatter_deg(by_name);
    std::stable_sort(
        result.better.begin(), result.better.end(),
        [](const ListOrder::Other& a, const ListOrder::Other& b) { return a.log_ratio < b.log_ratio; });
    return result;
}

std::string doubt_of(const ListOrder& order, const SignCheck& signs, const LightFlips& taken,
                     const std::vector<std::string>& names) {
    // Both axes are half a turn.
    const LightTurn asked =
        LightTurn{false, taken.turn_deg}.after({taken.x != taken.y, taken.x ? 180.0 : 0.0});
    const LightTurn turn = asked.after(signs.remedy());
    const auto found =
        std::find_if(order.better.begin(), order.better.end(),
                     [&](const ListOrder::Other& other) { return explains(other, order.scatter_deg, turn); });
    if (found == order.better.end()) return {};
    const std::string photographs = std::abs(found->shift) == 1 ? "photograph" : "photographs";
    const std::string what =
        (found->reversed ? "runs the other way"
                         : fmt::format("is off by {} {}", std::abs(found->shift), photographs)) +
        (found->from ? fmt::format(" from {} on", names[*found->from]) : "");
    const std::string remedy =
        found->reversed ? "turn its directions round against its names"
        : found->from ? "a line is missing or too many there; move the directions after it against the names"
                      : "move its directions against its names by as many lines";
    std::string text = fmt::format(
        "the list of lights {}: {} (matt reflection fits {:.0f} % better so, {:.0f} standard errors): {}",
        what, examples_of(*found, names), 100 * (std::exp(-found->log_ratio) - 1), found->certainty, remedy);
    std::string flags;
    for (const auto& [given, flag] :
         {std::pair(taken.x, "--lights-flip-x"), std::pair(taken.y, "--lights-flip-y"),
          std::pair(taken.turn_deg != 0, "--lights-turn")})
        if (given) flags += fmt::format(" {}", flag);
    if (!flags.empty()) return text + "; leave out" + flags;
    return turn == LightTurn{} ? text : text + "; all lights turned would be wrong for some photographs";
}

nlohmann::json to_json(const ListOrder& order) {
    nlohmann::json better = nlohmann::json::array();
    for (const ListOrder::Other& other : order.better)
        better.push_back({{"shift", other.shift},
                          {"from", other.from ? nlohmann::json(*other.from) : nlohmann::json(nullptr)},
                          {"reversed", other.reversed},
                          {"by_lines", other.by_lines},
                          {"mirrored_y", other.turn.mirrored},
                          {"turn_deg", other.turn.turn_deg},
                          {"alike", other.alike},
                          {"log_ratio", other.log_ratio},
                          {"certainty", other.certainty},
                          {"scatter_deg", other.scatter_deg}});
    return {{"scatter_deg", order.scatter_deg}, {"better", std::move(better)}};
}

}  // namespace tangi
