#include "surface/image_file/tiff_pages.h"

#include <algorithm>
#include <set>

#include "surface/base/error.h"
#include "surface/image_file/tiff_directories.h"

namespace tangi {

namespace {

struct Page {
    TiffPage page;
    std::vector<std::uint64_t> below;  // SubIFDs
};

void take_entry(const TiffDirectories& in, const TiffEntry& entry, Page& result) {
    constexpr std::uint64_t kNewSubfileType = 254, kSubfileType = 255, kWidth = 256, kHeight = 257,
                            kBits = 258, kPhotometric = 262, kSamplesPerPixel = 277, kTileWidth = 322,
                            kSubIfds = 330, kSampleFormat = 339, kMostBelow = 64;
    TiffPage& page = result.page;
    const auto value = static_cast<std::uint64_t>(in.value(entry));
    if (entry.tag == kWidth) page.width = static_cast<std::uint32_t>(value);
    if (entry.tag == kHeight) page.height = static_cast<std::uint32_t>(value);
    if (entry.tag == kPhotometric) page.photometric = static_cast<int>(value);
    if (entry.tag == kSamplesPerPixel) page.samples = static_cast<int>(value);
    if (entry.tag == kBits) page.bits = static_cast<int>(value);
    if (entry.tag == kSampleFormat) page.sample_format = static_cast<int>(value);
    if (entry.tag == kTileWidth) page.is_tiled = true;
    if (entry.tag == kNewSubfileType) page.reduced = (value & 1) != 0, page.is_mask = (value & 4) != 0;
    if (entry.tag == kSubfileType) page.reduced = value == 2;
    if (entry.tag == kSubIfds) result.below = in.values(entry, kMostBelow);
}

std::optional<Page> page_of(const TiffDirectories& in, const std::optional<TiffDirectory>& directory) {
    if (!directory || directory->entries.empty()) return {};
    Page page;
    for (const TiffEntry& entry : directory->entries) take_entry(in, entry, page);
    return page;
}

void choose(TiffPages& result) {
    const std::vector<TiffPage>& pages = result.pages;
    const bool any = std::any_of(pages.begin(), pages.end(),
                                 [](const TiffPage& page) { return !page.reduced && !page.is_mask; });
    const auto may_be = [&](const TiffPage& page) { return !any || (!page.reduced && !page.is_mask); };
    double most = -1;
    for (std::size_t i = 0; i < pages.size(); ++i)
        if (may_be(pages[i]) && pages[i].pixels() > most) most = pages[i].pixels(), result.chosen = i;
    const TiffPage& best = pages[result.chosen];
    result.alike =
        static_cast<std::size_t>(std::count_if(pages.begin(), pages.end(), [&](const TiffPage& page) {
            return may_be(page) && page.width == best.width && page.height == best.height;
        }));
}

}  // namespace

const TiffPage* TiffPages::larger_hidden() const {
    const TiffPage* largest = nullptr;
    for (const TiffPage& page : hidden)
        if (!page.is_mask && page.pixels() > picture().pixels() &&
            (!largest || page.pixels() > largest->pixels()))
            largest = &page;
    return largest;
}

std::optional<TiffPages> tiff_pages(const FileBytes& file) {
    const TiffDirectories in(file);
    TiffPages result;
    std::set<std::uint64_t> seen;
    for (std::uint64_t at = in.first();
         at != 0 && seen.insert(at).second && seen.size() <= kMostTiffDirectories;) {
        const auto directory = in.at(at);
        const auto page = page_of(in, directory);
        if (!page) break;  // what comes before can still be read
        result.pages.push_back(page->page);
        for (const std::uint64_t below : page->below)
            if (below != 0 && seen.insert(below).second)
                if (const auto hidden = page_of(in, in.at(below))) result.hidden.push_back(hidden->page);
        at = directory->next;
    }
    if (result.pages.empty()) return {};
    choose(result);
    return result;
}

std::optional<TiffPages> tiff_pages(const std::filesystem::path& path) {
    try {
        return tiff_pages(FileBytes(path));
    } catch (const Error&) {
        return {};
    }
}

}  // namespace tangi
