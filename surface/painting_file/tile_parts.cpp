#include "surface/painting_file/tile_parts.h"

#include <half.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/painting_file/surface_channels.h"

namespace tangi {

namespace {

const std::string kHashOfPart = "hash";

std::string hash_of(const PartPlanes& planes) {
    if (planes.empty()) return joined_hash({});
    std::vector<DryChannel> channels;
    for (const Image<float>& plane : planes)
        channels.push_back({"", const_cast<float*>(plane.data()), 1});  // read only
    std::vector<std::uint64_t> rows(static_cast<std::size_t>(planes[0].height()));
    hash_rows(channels, planes[0].width(), 0, planes[0].height(), rows);
    return joined_hash(rows);
}

}  // namespace

PartPlanes filled(const PartToWrite& part) {
    PartPlanes planes(part.info.channels.size(), Image<float>(part.info.width, part.info.height));
    std::vector<float*> rows;
    for (Image<float>& plane : planes) rows.push_back(plane.data());
    part.fill(0, part.info.height, rows);
    return planes;
}

std::optional<PartToWrite> sealed(PartInfo info, PartPlanes planes) {
    bool is_zero = true;
    for (Image<float>& plane : planes)
        for (float& value : plane.pixels()) {
            if (info.half) value = half(value);  // as it is read back
            is_zero = is_zero && value == 0;     // -0, too
        }
    if (is_zero) return {};
    info.attributes[kHashOfPart] = hash_of(planes);
    const auto kept = std::make_shared<const PartPlanes>(std::move(planes));
    return PartToWrite{std::move(info), [kept](int y0, int y1, std::span<float* const> rows) {
                           for (std::size_t c = 0; c < rows.size(); ++c) {
                               const Image<float>& plane = (*kept)[c];
                               std::copy_n(plane.row(y0).data(),
                                           static_cast<std::ptrdiff_t>(y1 - y0) * plane.width(), rows[c]);
                           }
                       }};
}

PartPlanes checked_planes(const std::filesystem::path& file, const PartInfo& part) {
    PartPlanes planes(part.channels.size(), Image<float>(part.width, part.height));
    read_painting_part(file, part, [&](int y0, int y1, std::span<const float* const> rows) {
        for (std::size_t c = 0; c < rows.size(); ++c)
            std::copy_n(rows[c], static_cast<std::ptrdiff_t>(y1 - y0) * part.width, planes[c].row(y0).data());
    });
    const auto stored = part.attributes.find(kHashOfPart);
    if (stored == part.attributes.end()) return planes;
    if (const std::string found = hash_of(planes); stored->second != found)
        fail("{}: its part '{}' is not the one that was saved (hash {} expected, {} found)", file.string(),
             part.name, shortened(stored->second), found);
    return planes;
}

std::vector<PartInfo> parts_of_tiles(const std::filesystem::path& folder, const TileGrid& grid) {
    std::map<std::string, PartInfo> all;
    for (int i = 0; i < grid.count(); ++i) {
        const PaintingTile tile = grid.tile(i);
        const Region region = grid.region(tile);
        for (PartInfo& part : painting_parts(file_of(folder, tile))) {
            if (part.width != region.width() || part.height != region.height()) continue;  // of the whole
            part.width = grid.width();
            part.height = grid.height();
            part.attributes.erase(kHashOfPart);
            const auto [known, is_new] = all.emplace(part.name, part);
            if (is_new) continue;
            std::set<std::string> channels(known->second.channels.begin(), known->second.channels.end());
            channels.insert(part.channels.begin(), part.channels.end());
            known->second.channels.assign(channels.begin(), channels.end());
        }
    }
    std::vector<PartInfo> parts;
    for (auto& [name, part] : all) parts.push_back(std::move(part));
    return parts;
}

std::vector<PartInfo> in_order_of(const std::vector<PartInfo>& order, std::vector<PartInfo> parts) {
    std::ranges::stable_sort(parts, {}, [&](const PartInfo& part) {
        return std::ranges::find(order, part.name, &PartInfo::name) - order.begin();
    });
    return parts;
}

}  // namespace tangi
