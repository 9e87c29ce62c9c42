#include "fit/evaluate/compared_whites.h"

#include <algorithm>
#include <cmath>

#include "capture/stack/survey.h"
#include "surface/base/error.h"

namespace tangi {

WhiteBalance white_balance_of(const Image<Rgb>& photo, const Image<Rgb>& relit, const PixelMask& mask,
                              const Transfer& transfer, bool clips, const Vec3& light) {
    constexpr double wanted = 20000;
    constexpr float dark = 0.05f;  // [1] stored
    const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(photo.size()) / wanted)));
    const auto well = [&](const Rgb& v) {
        return std::min({v.r, v.g, v.b}) > dark && (!clips || std::max({v.r, v.g, v.b}) < kClipped);
    };
    const auto linear = [&](const Rgb& v) {
        return Rgb(transfer.decode(v.r), transfer.decode(v.g), transfer.decode(v.b));
    };
    std::vector<Rgb> expected, seen;
    std::vector<int> part;
    for (int y = step / 2; y < photo.height(); y += step)
        for (int x = step / 2; x < photo.width(); x += step) {
            if (!mask(x, y) || !well(photo(x, y)) || !well(relit(x, y))) continue;
            expected.push_back(linear(relit(x, y)));
            seen.push_back(linear(photo(x, y)));
            part.push_back((2 * x > photo.width()) + 2 * (2 * y > photo.height()));
        }
    return white_balance_beside(expected, seen, part, light);
}

std::string other_white_balances(const CompareReport& report, const std::string& folder) {
    int count = 0;
    const PhotoComparison* most = nullptr;
    const auto size = [](const PhotoComparison& p) {
        const glm::dvec2 off = glm::abs(glm::log(*p.white_balance));
        return std::max(off.x, off.y);
    };
    for (const PhotoComparison& photo : report.photos)
        if (photo.white_balance) {
            ++count;
            if (!most || size(photo) > size(*most)) most = &photo;
        }
    if (count == 0) return {};
    return fmt::format(
        "{}: {} of the photographs that were not fitted have another white balance than the painting, most "
        "of all "
        "{}: red × {:.2f}, blue × {:.2f} against green; they are compared as they are, and their figures are "
        "the worse for it",
        folder, count, most->name, most->white_balance->x, most->white_balance->y);
}

}  // namespace tangi
