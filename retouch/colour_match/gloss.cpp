#include "retouch/colour_match/gloss.h"

#include <algorithm>
#include <cmath>

namespace tangi {

double gloss_difference(const Gloss& a, const Gloss& b) {
    const auto contrast = [](const Gloss& g) {
        return std::cbrt(g.specular + g.luminance / 2) - std::cbrt(g.luminance / 2);
    };
    return std::hypot(contrast(a) - contrast(b), 1.78 * (a.roughness - b.roughness));
}

double glossier(const Gloss& a, const Gloss& b) {
    const auto peak = [](const Gloss& g) {
        return std::log(std::max(g.specular, 1e-6)) - 2 * std::log(std::max(g.roughness, 1e-4));
    };
    return peak(a) - peak(b);
}

bool can_reflect(const Gloss& paint, const Gloss& wanted) {
    constexpr double hardly_seen = 1.25;
    return wanted.specular <= hardly_seen * std::max(paint.specular, kMostSpecular);
}

std::string_view name_of(GlossRemedy remedy) {
    switch (remedy) {
        case GlossRemedy::none:
            break;
        case GlossRemedy::matting_agent:
            return "matting agent";
        case GlossRemedy::varnish:
            return "varnish";
    }
    return "none";
}

GlossRemedy remedy_for(const Gloss& paint, const Gloss& wanted, double tolerance) {
    if (gloss_difference(paint, wanted) <= tolerance) return GlossRemedy::none;
    return glossier(paint, wanted) > 0 ? GlossRemedy::matting_agent : GlossRemedy::varnish;
}

}  // namespace tangi
