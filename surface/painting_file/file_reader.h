// file_reader.h: readers (painting_reader.h) of what has no levels of detail stored, which are made as they
// are asked for; among them a painting file.
#pragma once

#include <list>
#include <map>
#include <mutex>

#include "surface/painting_file/dry_part.h"
#include "surface/painting_file/painting_reader.h"

namespace tangi {

class FullSizeReader : public PaintingReader {
public:
    Surface read(const Region& region, int level) const override;
    Image<float> read_heights(const Region& region, int level) const override;
    std::vector<HeightRange> height_ranges() const override;

protected:
    using PaintingReader::PaintingReader;
    // A rectangle of the painting, so that its upper left comes to (x, y) of `into`.
    virtual void read_pixels(const Region& region, Surface& into, int x, int y) const = 0;
};

// Keeps bands of rows, as many as a pass over the painting in tiles of 1024 rows needs, whatever the size of
// the cache: what is too large for that is to be a folder of tiles.
class FileReader : public FullSizeReader {
public:
    FileReader(const std::filesystem::path& path, std::size_t cache_bytes);

    std::vector<Image<float>> read_part(const PartInfo& part, const Region& region) const override;
    std::vector<Region> blocks() const override;

private:
    using Band = std::shared_ptr<const Surface>;
    void read_pixels(const Region& region, Surface& into, int x, int y) const override;
    Band band(int number) const;
    void keep(int number, const Band& rows, const std::vector<std::uint64_t>& hashes) const;

    std::size_t most_;  // bands that are kept
    mutable std::mutex file_mutex_;
    mutable DryPart dry_;
    mutable std::mutex mutex_;                       // of what follows
    mutable std::list<std::pair<int, Band>> bands_;  // the last that was asked for first
    mutable std::vector<std::uint64_t> hashes_;      // of rows; of whole bands that were read
    mutable std::vector<bool> seen_;                 // bands
    mutable std::size_t unseen_;
};

}  // namespace tangi
