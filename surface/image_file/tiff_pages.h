// tiff_pages.h: which of the pictures in a TIFF file is the picture, by its directories alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/file/file_bytes.h"

namespace tangi {

// One directory of a TIFF file (TIFF 6.0, section 8).
struct TiffPage {
    std::uint32_t width = 0, height = 0;
    bool reduced = false;   // NewSubfileType: a preview of another page
    bool is_mask = false;   // NewSubfileType: what of another page can be seen
    int photometric = -1;   // PhotometricInterpretation; -1 where it is missing
    int samples = 1;        // a pixel
    int bits = 1;           // a sample
    int sample_format = 1;  // SampleFormat: kTiffUnsigned and others
    bool is_tiled = false;

    double pixels() const { return static_cast<double>(width) * height; }
};

// PhotometricInterpretation
constexpr int kTiffMinIsWhite = 0, kTiffMinIsBlack = 1, kTiffRgb = 2, kTiffPalette = 3, kTiffMask = 4,
              kTiffInks = 5, kTiffYcbcr = 6, kTiffCielab = 8, kTiffIccLab = 9, kTiffItuLab = 10,
              kTiffMosaic = 32803, kTiffLogL = 32844, kTiffLogLuv = 32845, kTiffLinearRaw = 34892;
constexpr int kTiffUnsigned = 1, kTiffSigned = 2, kTiffFloat = 3;  // SampleFormat

// Why the pixels of a page have no reading as a picture, or OpenImageIO 2.4 gets them wrong, in words that
// follow the file's name, with the remedy; empty where they can be read.
std::string unreadable_kind(const TiffPage& page);

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
