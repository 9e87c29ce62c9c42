#include "surface/painting_file/file_reader.h"

#include <algorithm>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"
#include "surface/image/memory_budget.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/surface_channels.h"

namespace tangi {

namespace {

constexpr int kRowsOfBand = 64;  // whole blocks of those that ZIP packs together
// Bands of a row of tiles, and of what lies above and below it within the reach of a shadow.
constexpr std::size_t kLeastBands = kPaintingTile / kRowsOfBand + 2;

std::size_t bytes_of(const PaintingHeader& h) {
    return static_cast<std::size_t>(h.width) * kRowsOfBand *
           (2 * sizeof(Vec3) + 4 * sizeof(float) + (h.has_specular_colour ? sizeof(Rgb) : 0) +
            (h.has_lobe_axes ? sizeof(LobeAxes) : 0));
}

}  // namespace

FileReader::FileReader(const std::filesystem::path& path, std::size_t cache_bytes)
    : FullSizeReader(path, {}), dry_(path) {
    header_ = dry_.header();
    // A quarter of what is left: what is made of the bands takes more.
    const auto room = static_cast<std::size_t>(std::min(memory_left() / 4, 1e15));
    most_ = std::max(std::min(cache_bytes, room) / bytes_of(header_), kLeastBands);
    hashes_.resize(static_cast<std::size_t>(height()));
    seen_.resize(static_cast<std::size_t>((height() + kRowsOfBand - 1) / kRowsOfBand));
    unseen_ = seen_.size();
}

std::vector<Region> FileReader::blocks() const {
    std::vector<Region> blocks;
    for (int y = 0; y < height(); y += 4 * kRowsOfBand)
        blocks.push_back({0, y, width(), std::min(y + 4 * kRowsOfBand, height())});
    return blocks;
}

void FileReader::read_pixels(const Region& region, Surface& into, int x, int y) const {
    for (int row = region.y0; row < region.y1;) {
        const int number = row / kRowsOfBand, first = number * kRowsOfBand;
        const int end = std::min(first + kRowsOfBand, region.y1);
        paste(*band(number), {region.x0, row - first, region.x1, end - first}, into, x, y + row - region.y0);
        row = end;
    }
}

// Nothing is looked at under a lock: a thread that waits within a parallel loop may take up another one's
// work, and want the same lock.
FileReader::Band FileReader::band(int number) const {
    {
        const std::lock_guard lock(mutex_);
        const auto held = std::ranges::find(bands_, number, &std::pair<int, Band>::first);
        if (held != bands_.end()) {
            bands_.splice(bands_.begin(), bands_, held);
            return held->second;
        }
        while (bands_.size() >= most_) bands_.pop_back();  // room for what is read
    }
    const int y = number * kRowsOfBand, end = std::min(y + kRowsOfBand, height());
    const auto rows = std::make_shared<Surface>(blank_surface(header(), width(), end - y));
    {
        const std::lock_guard lock(file_mutex_);
        dry_.read(y, end, *rows, 0, 0);
    }
    rows->part_of = {0, y, static_cast<double>(width()), static_cast<double>(height())};
    std::vector<std::uint64_t> hashes(static_cast<std::size_t>(end - y));
    std::vector<std::string> wrong(hashes.size());
    const auto channels = channels_of(*rows);
    parallel_for(0, rows->height(), 16, [&](int begin, int last) {
        hash_rows(channels, width(), begin, last, hashes);
        make_usable(*rows, begin, last, wrong);
    });
    for (const std::string& what : wrong)
        if (!what.empty()) fail("{}: {}, {}", path().string(), what, kWrongMapRemedy);
    keep(number, rows, hashes);
    return rows;
}

// With the last of them it is known whether all rows are those that were saved.
void FileReader::keep(int number, const Band& rows, const std::vector<std::uint64_t>& hashes) const {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(bands_, number, &std::pair<int, Band>::first) == bands_.end())
        bands_.emplace_front(number, rows);
    const auto index = static_cast<std::size_t>(number);
    if (seen_[index]) return;
    seen_[index] = true;
    std::ranges::copy(hashes, hashes_.begin() + number * kRowsOfBand);
    if (--unseen_ > 0 || header().dry_hash.empty()) return;
    if (const std::string found = joined_hash(hashes_); header().dry_hash != found)
        fail("{}: the dry layer is not the one that was saved (hash {} expected, {} found)", path().string(),
             shortened(header().dry_hash), found);
}

std::vector<Image<float>> FileReader::read_part(const PartInfo& part, const Region& region) const {
    std::vector<Image<float>> planes(part.channels.size(), Image<float>(region.width(), region.height()));
    read_painting_rows(
        path(), part, region.y0, region.y1, [&](int y0, int y1, std::span<const float* const> rows) {
            for (std::size_t c = 0; c < rows.size(); ++c)
                for (int y = y0; y < y1; ++y)
                    std::copy_n(rows[c] + static_cast<std::ptrdiff_t>(y - y0) * part.width + region.x0,
                                region.width(), planes[c].row(y - region.y0).begin());
        });
    return planes;
}

}  // namespace tangi
