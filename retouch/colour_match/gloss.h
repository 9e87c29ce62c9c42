// gloss.h: how far two surfaces are apart in gloss, and what would bring a retouch to the gloss beside it.
#pragma once

#include <string_view>

namespace tangi {

// Ward's parameters of a surface, and how bright its diffuse reflection is.
struct Gloss {
    double specular = 0.04;   // rho_s
    double roughness = 0.15;  // alpha
    double luminance = 0.5;   // Y of rho_d
};

// Distance in the space of perceived gloss of Pellacini, Ferwerda & Greenberg 2000 (eq. 7, 10): contrast of
// the reflections c = cbrt(rho_s + Y/2) - cbrt(Y/2) and distinctness d = 1 - alpha; sqrt(dc^2 + (1.78 dd)^2).
double gloss_difference(const Gloss& a, const Gloss& b);

// Signed: > 0 where `a` looks glossier than `b`. Height of the lobe's peak, rho_s / (4 pi alpha^2), as a
// logarithm of the ratio.
double glossier(const Gloss& a, const Gloss& b);

// Whether paint, with what is added to it or laid over it, can reflect so much: rho_s of a varnish is 0.05 at
// most (Fresnel's reflection at n = 1.57), and agents only spread it. A fitted lobe may hold more, such as
// that of gilding, or what illuminants of unknown distance leave.
inline constexpr double kMostSpecular = 0.05;
bool can_reflect(const Gloss& paint, const Gloss& wanted);

// What brings paint to a gloss. How much of an agent that takes, nobody can tell without a trial on a card.
enum class GlossRemedy { none, matting_agent, varnish };
std::string_view name_of(GlossRemedy remedy);
inline constexpr double kGlossTolerance = 0.05;  // that is hardly seen
GlossRemedy remedy_for(const Gloss& paint, const Gloss& wanted, double tolerance = kGlossTolerance);

}  // namespace tangi
