// painting_bytes.h: painting files (paint/files/canvas_file.h) that a browser has.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paint/canvas/canvas.h"
#include "web/engine/exr_bytes.h"

namespace tangi {

// As read_canvas() reads it. Only as our program writes it: floats, without compression or with ZIP, whole
// lines. Throws Error for anything else, where it is damaged, and where the maps are not those that were
// saved (their hash).
// Also require_memory_for()'s.
Canvas painting_from_bytes(const ByteSource& file, double memory_bytes = 0);

// A painting file in the making: what was painted, beside all else that was in the file that it was painted
// on, as it was there. What is shown of it in a hurry (`overview`) and the brush that was in the hand at the
// desk are left out: they are not of this painting any more.
class PaintingToSave {
public:
    // A copy of the canvas, which shares its paint until that changes. `original`: the file that the canvas
    // is of; of no bytes where there was none.
    PaintingToSave(const Canvas& canvas, const ByteSource& original);
    PaintingToSave(const PaintingToSave&) = delete;
    PaintingToSave& operator=(const PaintingToSave&) = delete;

    std::string head() const { return exr_head(parts_); }
    std::size_t blocks() const { return places_.size(); }
    struct Block {
        int part = 0, y = 0;
        bool packed = false;  // it is as it must be; else ZIP may pack it, if that makes it shorter
        std::string bytes;
    };
    // `sorted`: what ZIP packs, else what is written where packing saves nothing.
    Block block(std::size_t number, bool sorted) const;

private:
    Canvas canvas_;
    std::optional<ExrFile> file_;
    std::vector<ExrSource> parts_;
    std::vector<std::pair<std::size_t, std::size_t>> places_;  // part, block of it
};

}  // namespace tangi
