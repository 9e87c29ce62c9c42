#include "fit/light_signs.h"

#include <algorithm>
#include <cmath>

#include "surface/error.h"

namespace tangi {

namespace {

constexpr int kParts = 8;                // along each side
constexpr int kLeastQuads = 64;          // that a part must have to count
constexpr std::size_t kLeastParts = 16;  // of which a standard error can be told
constexpr double kLeastCertainty = 6;    // [standard errors]
constexpr double kLeastLogRatio = 0.5;   // ln of the ratio of variances: 1.65
constexpr float kLeastZ = 0.1f;          // steeper normals are edges or errors
constexpr double kSteepest = 0.5;        // [1/pixel] changes of slope beyond are steps, not relief

// Sums over one part of the picture of products of the four derivatives of the slopes.
struct Sums {
    long count = 0;
    double curl = 0, mirrored = 0;               // of the squares
    double divergence = 0, with_divergence = 0;  // of the squares, and of curl times divergence

    void add(double p_x, double p_y, double q_x, double q_y) {
        const double c = p_y - q_x, m = p_y + q_x, d = p_x + q_y;
        ++count;
        curl += c * c;
        mirrored += m * m;
        divergence += d * d;
        with_divergence += c * d;
    }
    Sums& operator+=(const Sums& o) {
        count += o.count;
        curl += o.curl, mirrored += o.mirrored, divergence += o.divergence;
        with_divergence += o.with_divergence;
        return *this;
    }
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

}  // namespace

bool SignCheck::mirrored() const {
    return certainty > kLeastCertainty && log_ratio < -kLeastLogRatio && curl_mirrored < curl_turned;
}

SignCheck check_signs(const Image<Vec3>& normal, const Image<float>& confidence) {
    TP_REQUIRE(normal.region() == confidence.region(), "maps have one size");
    SignCheck result;
    Sums all;
    std::vector<double> ratios;
    const int width = normal.width(), height = normal.height();
    for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i) {
            const Sums sums = sums_of(normal, confidence,
                                      {width * i / kParts, height * j / kParts, width * (i + 1) / kParts,
                                       height * (j + 1) / kParts});
            all += sums;
            if (sums.count >= kLeastQuads && sums.curl > 0 && sums.mirrored > 0)
                ratios.push_back(std::log(sums.mirrored / sums.curl));
        }
    if (ratios.size() < kLeastParts) return result;
    const double n = static_cast<double>(all.count), parts = static_cast<double>(ratios.size());
    result.curl = std::sqrt(all.curl / n);
    result.curl_mirrored = std::sqrt(all.mirrored / n);
    // Turned by φ the curl is cos φ curl + sin φ divergence; the least of its squares is the smaller
    // eigenvalue.
    const double half = (all.curl - all.divergence) / 2;
    const double least = (all.curl + all.divergence) / 2 - std::hypot(half, all.with_divergence);
    result.curl_turned = std::sqrt(std::max(least, 0.0) / n);
    double sum = 0, squares = 0;
    for (const double ratio : ratios) sum += ratio, squares += ratio * ratio;
    result.log_ratio = sum / parts;
    const double variance = std::max(squares / parts - result.log_ratio * result.log_ratio, 0.0);
    result.certainty = -result.log_ratio / std::max(std::sqrt(variance / (parts - 1)), 1e-9);
    return result;
}

nlohmann::json to_json(const SignCheck& signs) {
    return {{"curl", signs.curl},
            {"curl_mirrored", signs.curl_mirrored},
            {"curl_turned", signs.curl_turned},
            {"log_ratio", signs.log_ratio},
            {"certainty", signs.certainty},
            {"mirrored", signs.mirrored()}};
}

}  // namespace tangi
