#include "paint/bristle_rows.h"

#include <algorithm>

#include "paint/transfer.h"
#include "surface/vector_clones.h"

namespace tangi {

TP_VECTOR_CLONES
void underside_row(int n, const TipMaps& maps, const UndersideRow& r, float* __restrict out,
                   float* __restrict cover) {
    const float* __restrict dome = maps.dome, * __restrict tip = maps.tip, * __restrict part = maps.cover;
    const int width = maps.width;
    const float last_u = static_cast<float>(maps.width) - 1.001f,
                last_v = static_cast<float>(maps.height) - 1.001f;
    for (int x = 0; x < n; ++x) {
        const auto at = static_cast<float>(x);
        const float u = std::min(std::max(r.u + at * r.du, 0.0f), last_u);
        const float v = std::min(std::max(r.v + at * r.dv, 0.0f), last_v);
        const int iu = static_cast<int>(u), iv = static_cast<int>(v);
        const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
        const int i = iv * width + iu, j = i + width;
        const float d0 = dome[i] + (dome[i + 1] - dome[i]) * fu, d1 = dome[j] + (dome[j + 1] - dome[j]) * fu;
        const float t0 = tip[i] + (tip[i + 1] - tip[i]) * fu, t1 = tip[j] + (tip[j + 1] - tip[j]) * fu;
        const float d = d0 + (d1 - d0) * fv, t = t0 + (t1 - t0) * fv;
        const float c0 = part[i] + (part[i + 1] - part[i]) * fu, c1 = part[j] + (part[j + 1] - part[j]) * fu;
        const float c = c0 + (c1 - c0) * fv;
        const float b = r.gap_mm + r.groove_mm * t + r.rise_mm * std::max(d - r.touched, 0.0f) +
                        r.rim_mm * (1 - c) + std::max(r.lift_mm + at * r.dlift_mm, 0.0f);
        out[x] = c > 0 ? b : kOutside;
        cover[x] = c;
    }
}

}  // namespace tangi
