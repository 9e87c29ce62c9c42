#include "fit/light_checks/axis_check_slopes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/log_ratio.h"
#include "surface/maps/light.h"

namespace tangi {

namespace {

constexpr int kParts = 8;                // along each side
constexpr int kLeastQuads = 64;          // that a part must have to count
constexpr std::size_t kLeastParts = 16;  // of which a standard error can be told
constexpr double kLeastCertainty = 6;    // [standard errors]
constexpr double kLeastLogRatio = 0.5;   // ln of the ratio of variances: 1.65
constexpr float kLeastZ = 0.1f;          // steeper normals are edges or errors
constexpr double kSteepest = 0.5;        // [1/pixel] changes of slope beyond are steps, not relief
constexpr double kClose = 1.1;           // [1] ratio of curls that are as good
constexpr double kRightAngle_deg = 4;    // within which a turn is one by a multiple of 90 degrees

double remainder_of(double degrees, double period) {
    const double rest = std::fmod(degrees, period);
    return rest < 0 ? rest + period : rest;
}

double snapped(double degrees) {
    const double right = 90 * std::round(degrees / 90);
    return std::abs(degrees - right) < kRightAngle_deg ? right : degrees;
}

// Exact where the angle is a multiple of 90 degrees.
double cosine_of(double degrees) {
    const double turn = remainder_of(degrees, 360);
    return turn == 0 ? 1 : turn == 180 ? -1 : turn == 90 || turn == 270 ? 0 : std::cos(turn / kDegrees);
}
double sine_of(double degrees) { return cosine_of(degrees - 90); }

// Sums over one part of the picture of products of the four derivatives of the slopes. Lights that are turned
// by φ make of one pair (curl, divergence), or with y mirrored (mirrored, stretch), the curl
// cos φ first − sin φ second.
struct Sums {
    long count = 0;
    struct Pair {
        double first = 0, second = 0, both = 0;  // of the squares, and of the product

        void add(double f, double s) { first += f * f, second += s * s, both += f * s; }
        Pair& operator+=(const Pair& o) {
            first += o.first, second += o.second, both += o.both;
            return *this;
        }
        double at(double turn_deg) const {
            const double c = cosine_of(turn_deg), s = sine_of(turn_deg);
            return std::max(c * c * first - 2 * c * s * both + s * s * second, 0.0);
        }
        // [deg] In [0, 180), where at() is least: of an angle twice as large it is a cosine.
        double best_deg() const {
            const double twice = std::atan2(-2 * both, first - second) * kDegrees + 180;
            return remainder_of(snapped(twice / 2), 180);
        }
    } turned, mirrored;

    void add(double p_x, double p_y, double q_x, double q_y) {
        ++count;
        turned.add(p_y - q_x, p_x + q_y);
        mirrored.add(p_y + q_x, p_x - q_y);
    }
    Sums& operator+=(const Sums& o) {
        count += o.count;
        turned += o.turned;
        mirrored += o.mirrored;
        return *this;
    }
    double at(const LightTurn& turn) const { return (turn.mirrored ? mirrored : turned).at(turn.turn_deg); }
};

bool is_known(const Image<Vec3>& normal, const Image<float>& confidence, int x, int y) {
    return confidence(x, y) > 0 && normal(x, y).z > kLeastZ;
}

// By differences in squares of 2 x 2 pixels.
void add_square(const Image<Vec3>& normal, int x, int y, Sums& sums) {
    double p[2][2], q[2][2];
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const Vec3& n = normal(x + i, y + j);
            p[j][i] = -static_cast<double>(n.x / n.z);
            q[j][i] = -static_cast<double>(n.y / n.z);
        }
    // y is up, rows run down.
    const double p_x = (p[0][1] + p[1][1] - p[0][0] - p[1][0]) / 2;
    const double p_y = (p[0][0] + p[0][1] - p[1][0] - p[1][1]) / 2;
    const double q_x = (q[0][1] + q[1][1] - q[0][0] - q[1][0]) / 2;
    const double q_y = (q[0][0] + q[0][1] - q[1][0] - q[1][1]) / 2;
    if (std::max({std::abs(p_x), std::abs(p_y), std::abs(q_x), std::abs(q_y)}) < kSteepest)
        sums.add(p_x, p_y, q_x, q_y);
}

Sums sums_of(const Image<Vec3>& normal, const Image<float>& confidence, const Region& part) {
    Sums sums;
    for (int y = part.y0; y + 1 < part.y1; ++y)
        for (int x = part.x0; x + 1 < part.x1; ++x)
            if (is_known(normal, confidence, x, y) && is_known(normal, confidence, x + 1, y) &&
                is_known(normal, confidence, x, y + 1) && is_known(normal, confidence, x + 1, y + 1))
                add_square(normal, x, y, sums);
    return sums;
}

bool is_sure(double log_ratio, double certainty) {
    return certainty > kLeastCertainty && log_ratio < -kLeastLogRatio;
}

SignCheck::Turned best_turn(const Sums& all, const std::vector<Sums>& parts) {
    const LightTurn turn{false, all.turned.best_deg()}, mirror{true, all.mirrored.best_deg()};
    const bool mirrored = all.at(mirror) < all.at(turn);
    const LightTurn& best = mirrored ? mirror : turn;
    LogRatio to_listed, to_other;
    for (const Sums& part : parts) {
        to_listed.add(part.at(best), part.at({}));
        to_other.add(part.at(best), part.at(mirrored ? turn : mirror));
    }
    return {best,
            std::sqrt(all.at(best) / static_cast<double>(all.count)),
            to_listed.mean(),
            to_listed.certainty(),
            to_other.mean(),
            to_other.certainty()};
}

}  // namespace

glm::dvec2 LightTurn::applied(const glm::dvec2& v) const {
    const double c = cosine_of(turn_deg), s = sine_of(turn_deg), y = mirrored ? -v.y : v.y;
    return {c * v.x - s * y, s * v.x + c * y};
}

LightTurn LightTurn::opposite() const { return {mirrored, remainder_of(turn_deg + 180, 360)}; }

LightTurn LightTurn::after(const LightTurn& first) const {
    // Mirrored, a turn goes the other way.
    return {mirrored != first.mirrored,
            remainder_of(turn_deg + (mirrored ? -first.turn_deg : first.turn_deg), 360)};
}

bool SignCheck::Turned::kind_is_sure() const { return is_sure(log_ratio_other, certainty_other); }

bool SignCheck::mirrored() const {
    return is_sure(log_ratio, certainty) && curl_mirrored < curl_turned &&
           (turned.turn.turn_deg == 0 || !is_sure(turned.log_ratio, turned.certainty) ||
            curl_mirrored < kClose * turned.curl);
}

bool SignCheck::is_turned() const { return !mirrored() && is_sure(turned.log_ratio, turned.certainty); }

LightTurn SignCheck::remedy() const {
    return mirrored() ? LightTurn{true, 0} : is_turned() ? turned.turn : LightTurn{};
}

SignCheck check_signs(const Image<Vec3>& normal, const Image<float>& confidence) {
    TP_REQUIRE(normal.region() == confidence.region(), "maps have one size");
    SignCheck result;
    Sums all;
    std::vector<Sums> parts;
    const int width = normal.width(), height = normal.height();
    for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i) {
            const Sums sums = sums_of(normal, confidence,
                                      {width * i / kParts, height * j / kParts, width * (i + 1) / kParts,
                                       height * (j + 1) / kParts});
            all += sums;
            if (sums.count >= kLeastQuads && sums.turned.first > 0 && sums.mirrored.first > 0)
                parts.push_back(sums);
        }
    if (parts.size() < kLeastParts) return result;
    const double n = static_cast<double>(all.count);
    result.curl = std::sqrt(all.turned.first / n);
    result.curl_mirrored = std::sqrt(all.mirrored.first / n);
    result.curl_turned = std::sqrt(all.turned.at(all.turned.best_deg()) / n);
    LogRatio mirrored;
    for (const Sums& part : parts) mirrored.add(part.mirrored.first, part.turned.first);
    result.log_ratio = mirrored.mean();
    result.certainty = mirrored.certainty();
    result.turned = best_turn(all, parts);
    return result;
}

nlohmann::json to_json(const SignCheck& signs) {
    return {{"curl", signs.curl},
            {"curl_mirrored", signs.curl_mirrored},
            {"curl_turned", signs.curl_turned},
            {"log_ratio", signs.log_ratio},
            {"certainty", signs.certainty},
            {"mirrored", signs.mirrored()},
            {"turned",
             {{"mirrored_y", signs.turned.turn.mirrored},
              {"turn_deg", signs.turned.turn.turn_deg},
              {"curl", signs.turned.curl},
              {"log_ratio", signs.turned.log_ratio},
              {"certainty", signs.turned.certainty},
              {"wrong", signs.is_turned()}}}};
}

}  // namespace tangi
