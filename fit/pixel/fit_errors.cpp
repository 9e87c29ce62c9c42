#include "fit/pixel/fit_errors.h"

#include <algorithm>

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr const char* kPart = "errors";
const std::vector<std::string> kChannels = {"diffuse", "height", "roughness", "slope", "specular"};
const std::vector<std::string> kWithoutHeight = {"diffuse", "roughness", "slope", "specular"};

template <class Errors>
auto maps_of(Errors& e, const std::vector<std::string>& channels) {  // in their order
    if (channels == kChannels) return std::vector{&e.diffuse, &e.height, &e.roughness, &e.slope, &e.specular};
    return std::vector{&e.diffuse, &e.roughness, &e.slope, &e.specular};
}

}  // namespace

PartToWrite part_of(const FitErrors& errors) {
    PartToWrite part;
    part.info = {kPart, errors.slope.width(), errors.slope.height(), kChannels, {}};
    part.fill = [&errors](int y0, int y1, std::span<float* const> planes) {
        const auto maps = maps_of(errors, kChannels);
        for (std::size_t c = 0; c < maps.size(); ++c) {
            float* to = planes[c];
            for (int y = y0; y < y1; ++y)
                for (int x = 0; x < maps[c]->width(); ++x) *to++ = (*maps[c])(x, y);
        }
    };
    return part;
}

std::optional<PartInfo> errors_part(const std::vector<PartInfo>& parts) {
    const auto part = std::ranges::find(parts, kPart, &PartInfo::name);
    return part == parts.end() ? std::nullopt : std::optional(*part);
}

bool has_errors(const std::filesystem::path& painting) {
    return errors_part(painting_parts(painting)).has_value();
}

FitErrors read_errors(const std::filesystem::path& painting, const Progress& progress) {
    const std::optional<PartInfo> part = errors_part(painting_parts(painting));
    if (!part)
        fail("{}: has no part '{}'; fit the photographs again with: tangipaint fit", painting.string(),
             kPart);
    if (part->channels != kChannels && part->channels != kWithoutHeight)
        fail("{}: part '{}' has other channels than diffuse, height, roughness, slope, specular",
             painting.string(), kPart);
    FitErrors errors(part->width, part->height);
    read_painting_part(
        painting, *part,
        [&](int y0, int y1, std::span<const float* const> planes) {
            const auto maps = maps_of(errors, part->channels);
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
