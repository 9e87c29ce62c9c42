// dry_part.h: part `dry` of a painting file: what its header says, and its rows as they are asked for.
#pragma once

#include <filesystem>
#include <memory>

#include "surface/maps/surface.h"
#include "surface/painting_file/painting_reader.h"

namespace tangi {

// [pixels] Rows that are read or written at once: whole blocks of those that ZIP packs together, which
// are 16.
constexpr int kRowsAtOnce = 256;

// Holds the file open. Not for several threads at a time.
class DryPart {
public:
    // Reads headers only. Throws Error as read_painting() does.
    explicit DryPart(const std::filesystem::path& painting);
    ~DryPart();
    DryPart(DryPart&&) noexcept;
    DryPart& operator=(DryPart&&) noexcept;

    const PaintingHeader& header() const;

    // The rows [y0, y1) of all maps, so that its pixel (0, y0) comes to (left, top) of `into`. As they are:
    // what cannot be relit in them (surface_channels.h) is for the caller to see.
    void read(int y0, int y1, Surface& into, int left, int top);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// OpenEXR packs and unpacks in threads that it keeps, and has none before it is told.
void let_openexr_use_threads();

constexpr const char* kDryPart = "dry";
constexpr const char* kWrongMapRemedy =
    "where confidence is not 0; correct the map, or set confidence to 0 there";

// Rows of a painting that is being written: row y of it is row y - top of the surface.
struct DryRows {
    const Surface* surface;
    int top;
};

// fill_painting() (painting_parts.h) of a painting that is never in memory as a whole: `rows` gives those
// that are asked for, from top to bottom. The hash of all is the header's; what gives the rows has to see to
// it.
void fill_painting(const AtomicFile& file, const PaintingHeader& header,
                   const std::function<DryRows(int y0, int y1)>& rows, std::span<const PartToWrite> parts,
                   const Progress& progress);

}  // namespace tangi
