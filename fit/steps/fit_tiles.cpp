#include "fit/steps/fit_tiles.h"

#include <algorithm>
#include <map>
#include <optional>

namespace tangi {

namespace {

// Tiles of each row that are to be fitted, and the columns of pixels from the first to the last of all.
struct Work {
    std::map<int, std::vector<int>> rows;
    Region columns{};
};

Work work_of(const FitTiles& grid, const std::vector<int>& numbers) {
    Work work;
    for (const int number : numbers) {
        const Region tile = grid.region(number);
        if (work.rows.empty()) work.columns = tile;
        work.columns.x0 = std::min(work.columns.x0, tile.x0);
        work.columns.x1 = std::max(work.columns.x1, tile.x1);
        work.rows[number / grid.columns()].push_back(number);
    }
    return work;
}

// What is between the tiles of a row that are asked for.
std::vector<Region> others(const FitTiles& grid, int row, const std::vector<int>& numbers) {
    std::vector<Region> regions;
    for (int i = row * grid.columns(); i < (row + 1) * grid.columns(); ++i)
        if (std::ranges::find(numbers, i) == numbers.end()) regions.push_back(grid.region(i));
    return regions;
}

}  // namespace

FitTilesReport fit_tiles(const FitPlan& plan, const FitOptions& options, const FittedTiles& tiles,
                         const std::vector<int>& numbers, const Progress& progress) {
    const FitTiles& grid = tiles.grid();
    const std::vector<int> missing = tiles.missing(numbers, progress);
    FitTilesReport report{.asked = static_cast<int>(numbers.size()),
                          .there = static_cast<int>(numbers.size() - missing.size())};
    if (missing.empty()) return report;
    const Work work = work_of(grid, missing);
    PartFitter fitter(plan, options, work.columns, grid.side);
    double row_done = 0;
    for (const auto& [row, asked] : work.rows) {
        const Region first = grid.region(asked.front());
        const Progress shown([&](std::string_view, double done) {
            return !progress || progress("tiles", (row_done + done) / static_cast<double>(work.rows.size()));
        });
        const RefinedPixels pixels = fitter.fit(first.y0, first.y1, others(grid, row, asked), shown);
        for (const int number : asked) {
            const Region tile = grid.region(number);
            const int column = (tile.x0 - work.columns.x0) / grid.side;
            tiles.write(number, pixels, pixels.counts[static_cast<std::size_t>(column)]);
            ++report.fitted;
            report.pixels += static_cast<long>(tile.width()) * tile.height();
        }
        ++row_done;
    }
    return report;
}

}  // namespace tangi
