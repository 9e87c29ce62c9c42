// fitted_tiles.h: tiles of pixels as fitted by a plan, a file each (block_file.h), until a painting is made
// of them.
//
// They are raw numbers, without a height and errors of it: what fit --finish goes on with has to be what the
// pixels' fit left, to the bit. Any number of processes may write to one folder, and a file is there as a
// whole or not at all.
#pragma once

#include <filesystem>
#include <vector>

#include "fit/pipeline/fit_plan.h"
#include "fit/steps/plan_file.h"

namespace tangi {

// How a picture is cut: row by row from 0; those at the right and lower borders are smaller.
struct FitTiles {
    int width, height, side;  // [pixels]

    int columns() const { return (width + side - 1) / side; }
    int rows() const { return (height + side - 1) / side; }
    int count() const { return columns() * rows(); }
    Region region(int number) const;
};
FitTiles tiles_of(const PlanFile& plan);

// "all", "7", "0-15", "3,8-11": numbers of tiles, ascending. Throws Error that says what there is.
std::vector<int> tiles_named(const std::string& range, int count);
// Throws Error where that would, however many tiles there are.
void require_tile_numbers(const std::string& range);

class FittedTiles {
public:
    // `folder` need not be there.
    FittedTiles(std::filesystem::path folder, const PlanFile& plan);

    const FitTiles& grid() const { return grid_; }
    std::filesystem::path file_of(int number) const;  // COLUMN_ROW.fitted
    // Whether it is there, whole, and of this plan; all of it is read.
    bool has(int number) const;
    std::vector<int> missing(const std::vector<int>& numbers, const Progress& progress = {}) const;

    // `pixels`: of a part of the picture that has all of the tile; `counts` are not looked at.
    void write(int number, const RefinedPixels& pixels, const PassCounts& counts) const;
    // All tiles as one picture. Throws Error naming the tiles that are missing or damaged.
    RefinedPixels all(int photographs, const Progress& progress = {}) const;

private:
    void put(int number, RefinedPixels& whole) const;

    std::filesystem::path folder_;
    FitTiles grid_;
    std::string plan_;  // PlanFile::sha256()
};

// The folder beside a plan that its tiles are in: plan.json has plan.tiles/.
std::filesystem::path folder_of_tiles(const std::filesystem::path& plan);

}  // namespace tangi
