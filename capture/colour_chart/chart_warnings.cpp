// chart_warnings.cpp: what is worst in the photographs of a chart, and what the user is to know of its
// readings.
#include "capture/colour_chart/chart_colour.h"
#include "surface/base/error.h"

namespace tangi {

std::optional<std::size_t> ColourCorrection::worst_photo() const {
    std::optional<std::size_t> worst;
    for (std::size_t p = 0; p < of_photos.size(); ++p)
        if (of_photos[p].after.mean >= 0 &&
            (!worst || of_photos[p].after.mean > of_photos[*worst].after.mean))
            worst = p;
    return worst;
}

void warn_of_outliers(ColourCorrection& c, std::span<const ChartReading> photos) {
    for (std::size_t p = 0; p < photos.size(); ++p) {
        const std::string name =
            photos[p].photo.empty() ? fmt::format("photograph {}", p + 1) : photos[p].photo;
        if (!c.lights.lights[p].known) {
            c.warnings.push_back(
                c.lights.lights[p].dark
                    ? fmt::format("{}: the chart is black in it; did its light fail? Left out", name)
                    : fmt::format("{}: only {} patches of the chart can be used; rejected", name,
                                  photos[p].good()));
            continue;
        }
        std::string numbers;
        for (std::size_t i = 0; i < kChartPatches; ++i)
            if (c.lights.outliers[p][i]) numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", i + 1);
        if (!numbers.empty())
            c.warnings.push_back(
                fmt::format("{}: the chart's patch {} does not fit the others: a shadow or a "
                            "highlight; rejected",
                            name, numbers));
    }
}

}  // namespace tangi
