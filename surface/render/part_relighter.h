// part_relighter.h: rectangles of a painting that may be larger than memory, relit as relight() does the
// whole: with the shadows that fall into them from beside.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "surface/painting_file/painting_reader.h"
#include "surface/render/relight.h"

namespace tangi {

class PartRelighter {
public:
    // Learns how high the painting is where (PaintingReader::height_ranges()).
    PartRelighter(std::shared_ptr<const PaintingReader> painting, const RelightOptions& options);

    // What relight() draws there of the whole, but for rounding. Takes the memory of the picture, and of a
    // block of the painting (PaintingReader::blocks()) with what shadows it.
    Image<Rgb> draw(const Region& part, std::span<const Light> lights) const;

    // Hands the picture, in bands of rows from top to bottom that are read fastest, to `take`.
    void draw_bands(std::span<const Light> lights,
                    const std::function<void(Image<Rgb>&& rows, int top)>& take,
                    const Progress& progress = {}) const;
    Image<Rgb> draw_all(std::span<const Light> lights, const Progress& progress = {}) const;

    // What is to be added to each block's picture: the residual, for one.
    using Finish =
        std::function<void(const Surface& part, std::span<const Light> lights, Image<Rgb>& picture)>;
    void finish_with(Finish finish) { finish_ = std::move(finish); }

    // The painting's pixels from which relief may cast a shadow of this light into a part of it, the part
    // included: as far as the highest relief there can hide any of the light from the lowest of the part.
    Region within_reach(const Region& part, const Light& light) const;

    const PaintingReader& painting() const { return *painting_; }

private:
    Image<Rgb> draw_block(const Region& part, std::span<const Light> lights) const;
    HeightRange heights_in(const Region& region) const;

    std::shared_ptr<const PaintingReader> painting_;
    RelightOptions options_;
    Surface numbers_;  // of the painting: its frame, rig and scale, and no pixels
    std::vector<Region> blocks_;
    std::vector<HeightRange> heights_;  // of blocks
    Finish finish_;
};

}  // namespace tangi
