#include "paint/bristle_rows.h"

#include <algorithm>

#include "paint/transfer.h"
#include "paint/vector_clones.h"

namespace tangi {

TP_VECTOR_CLONES
void underside_row(int n, const TipMaps& maps, const UndersideRow& r, float* __restrict out) {
    const float* __restrict dome = maps.dome, * __restrict tip = maps.tip;
    const int width = maps.width;
    const float last_u = static_cast<float>(maps.width) - 1.001f,
                last_v = static_cast<float>(maps.height) - 1.001f;
    const auto sample = [&](const float* map, float u, float v) __attribute__((always_inline)) {
        u = std::min(std::max(u, 0.0f), last_u);
        v = std::min(std::max(v, 0.0f), last_v);
        const int iu = static_cast<int>(u), iv = static_cast<int>(v);
        const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
        const int i = iv * width + iu, j = i + width;
        const float above = map[i] + (map[i + 1] - map[i]) * fu, below = map[j] + (map[j + 1] - map[j]) * fu;
        return above + (below - above) * fv;
    };
    for (int x = 0; x < n; ++x) {
        const auto at = static_cast<float>(x);
        const float d = sample(dome, r.u + at * r.du, r.v + at * r.dv);
        const float t = sample(tip, r.tip_u + at * r.tip_du, r.tip_v + at * r.tip_dv);
        const float b = r.gap_mm + r.groove_mm * t + r.rise_mm * std::max(d - r.touched, 0.0f) +
                        std::max(r.lift_mm + at * r.dlift_mm, 0.0f);
        out[x] = d < 1 ? b : kOutside;
    }
}

}  // namespace tangi
