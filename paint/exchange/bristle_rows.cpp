#include "paint/exchange/bristle_rows.h"

#include <algorithm>

#include "paint/exchange/transfer.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

TexelPair in_field(float value, const TexelField& field) {
    const auto most = static_cast<float>((1u << field.bits) - 1);
    return static_cast<TexelPair>(std::clamp(value, 0.0f, 1.0f) * most + 0.5f) << field.shift;
}

}  // namespace

std::vector<TexelPair> texel_pairs(const std::vector<float>& dome, const std::vector<float>& tip,
                                   const std::vector<float>& cover, int width) {
    std::vector<TexelPair> pairs(dome.size());
    for (std::size_t i = 0; i < pairs.size(); ++i)
        pairs[i] =
            in_field(dome[i], kDomeField) | in_field(tip[i], kTipField) | in_field(cover[i], kCoverField);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const bool last = (i + 1) % static_cast<std::size_t>(width) == 0;
        pairs[i] |= (pairs[last ? i : i + 1] & 0xffffffffu) << 32;
    }
    return pairs;
}

TP_VECTOR_CLONES
void underside_row(int n, const TipMap& map, const UndersideRow& r, float* __restrict out,
                   float* __restrict cover) {
    const TexelPair* __restrict texels = map.texels;
    const float groove_mm = r.groove_mm * map.longest;
    const int width = map.width;
    const float last_u = static_cast<float>(map.width) - 1.001f,
                last_v = static_cast<float>(map.height) - 1.001f;
    for (int x = 0; x < n; ++x) {
        const auto at = static_cast<float>(x);
        const float u = std::min(std::max(r.u + at * r.du, 0.0f), last_u);
        const float v = std::min(std::max(r.v + at * r.dv, 0.0f), last_v);
        const int iu = static_cast<int>(u), iv = static_cast<int>(v);
        const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
        const int i = iv * width + iu, j = i + width;
        const TexelPair above = texels[i], below = texels[j];
        const float d = between<kDomeField>(above, below, fu, fv),
                    t = between<kTipField>(above, below, fu, fv);
        const float c = between<kCoverField>(above, below, fu, fv);
        const float b = r.gap_mm + groove_mm * t + r.rise_mm * std::max(d - r.touched, 0.0f) +
                        r.rim_mm * (1 - c) + std::max(r.lift_mm + at * r.dlift_mm, 0.0f);
        out[x] = c > 0 ? b : kOutside;
        cover[x] = c;
    }
}

}  // namespace tangi
