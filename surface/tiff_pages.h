// tiff_pages.h: which of the pictures in a TIFF file is the picture, by its directories alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "surface/file_bytes.h"

namespace tangi {

// One directory of a TIFF file (TIFF 6.0, section 8).
struct TiffPage {
    std::uint32_t width = 0, height = 0;
    bool reduced = false;  // NewSubfileType: a preview of another page
    bool is_mask = false;  // NewSubfileType: what of another page can be seen
    int photometric = -1;  // PhotometricInterpretation; -1 where it is missing
    int samples = 1;       // a pixel

    double pixels() const { return static_cast<double>(width) * height; }
};

constexpr int kTiffGrey = 1, kTiffCielab = 8, kTiffIccLab = 9;  // PhotometricInterpretation

struct TiffPages {
    std::vector<TiffPage> pages;   // one behind the other: the pictures that readers count
    std::vector<TiffPage> hidden;  // in directories of pages (SubIFDs), which readers pass over
    std::size_t chosen = 0;  // the picture: the largest page that is no preview or mask; the first of several
    std::size_t alike = 1;   // pages that might be it as well, itself among them

    const TiffPage& picture() const { return pages[chosen]; }
    // The largest of the hidden ones, where the picture is smaller.
    const TiffPage* larger_hidden() const;
};

// Nothing where this is no TIFF file, or its directories cannot be followed: what is wrong is for its reader
// to say. Reads directories only, and no more than 4096 of them.
std::optional<TiffPages> tiff_pages(const FileBytes& file);
std::optional<TiffPages> tiff_pages(const std::filesystem::path& path);

}  // namespace tangi
