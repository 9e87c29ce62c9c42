#include "paint/bristle_rows.h"

#include <algorithm>

#include "paint/transfer.h"
#include "surface/vector_clones.h"

namespace tangi {

std::vector<TexelPair> texel_pairs(const std::vector<float>& values, int width, float unit) {
    std::vector<TexelPair> pairs(values.size());
    const auto whole = [&](std::size_t i) {
        return static_cast<TexelPair>(std::clamp(values[i] / unit, 0.0f, 1.0f) * 65535 + 0.5f);
    };
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool last = (i + 1) % static_cast<std::size_t>(width) == 0;
        pairs[i] = whole(i) | whole(last ? i : i + 1) << 16;
    }
    return pairs;
}

TP_VECTOR_CLONES
void underside_row(int n, const TipMaps& maps, const UndersideRow& r, float* __restrict out,
                   float* __restrict cover) {
    const TexelPair* __restrict dome = maps.dome, * __restrict tip = maps.tip, * __restrict part = maps.cover;
    const float groove_mm = r.groove_mm * maps.longest;
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
        const float d = between(dome[i], dome[j], fu, fv), t = between(tip[i], tip[j], fu, fv);
        const float c = between(part[i], part[j], fu, fv);
        const float b = r.gap_mm + groove_mm * t + r.rise_mm * std::max(d - r.touched, 0.0f) +
                        r.rim_mm * (1 - c) + std::max(r.lift_mm + at * r.dlift_mm, 0.0f);
        out[x] = c > 0 ? b : kOutside;
        cover[x] = c;
    }
}

}  // namespace tangi
