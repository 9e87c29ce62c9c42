#include "fit/fit_errors.h"

#include <algorithm>
#include <array>

#include "surface/error.h"

namespace tangi {

namespace {

constexpr const char* kPart = "errors";
const std::vector<std::string> kChannels = {"diffuse", "roughness", "slope", "specular"};

template <class Errors>
auto maps_of(Errors& e) {  // in the order of kChannels
    return std::array{&e.diffuse, &e.roughness, &e.slope, &e.specular};
}

}  // namespace

PartToWrite part_of(const FitErrors& errors) {
    PartToWrite part;
    part.info = {kPart, errors.slope.width(), errors.slope.height(), kChannels, {}};
    part.fill = [&errors](int y0, int y1, std::span<float* const> planes) {
        const auto maps = maps_of(errors);
        for (std::size_t c = 0; c < maps.size(); ++c) {
            float* to = planes[c];
            for (int y = y0; y < y1; ++y)
                for (int x = 0; x < maps[c]->width(); ++x) *to++ = (*maps[c])(x, y);
        }
    };
    return part;
}

FitErrors read_errors(const std::filesystem::path& painting, const Progress& progress) {
    const std::vector<PartInfo> parts = painting_parts(painting);
    const auto part =
        std::find_if(parts.begin(), parts.end(), [](const PartInfo& p) { return p.name == kPart; });
    if (part == parts.end())
        fail("{}: has no part '{}'; fit the photographs again with: tangipaint fit", painting.string(),
             kPart);
    if (part->channels != kChannels)
        fail("{}: part '{}' has other channels than diffuse, roughness, slope, specular", painting.string(),
             kPart);
    FitErrors errors(part->width, part->height);
    read_painting_part(
        painting, *part,
        [&](int y0, int y1, std::span<const float* const> planes) {
            const auto maps = maps_of(errors);
            for (std::size_t c = 0; c < maps.size(); ++c) {
                const float* from = planes[c];
                for (int y = y0; y < y1; ++y)
                    for (int x = 0; x < maps[c]->width(); ++x) (*maps[c])(x, y) = *from++;
            }
        },
        progress);
    return errors;
}

}  // namespace tangi
