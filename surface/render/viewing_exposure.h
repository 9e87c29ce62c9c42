// viewing_exposure.h: how bright pictures for people are drawn.
#pragma once

namespace tangi {

// [1] What the light of a painting under its lights is multiplied by: the white level, so that pictures are
// as bright as the photographs were; but 1 for photographs in units of their own
// (fit/exchange/float_scale.h), which would be black or white.
inline double viewing_exposure(double white_level) {
    constexpr double least = 1e-2, most = 10;
    return white_level >= least && white_level <= most ? white_level : 1;
}

}  // namespace tangi
