// tiff_kinds.cpp: kinds of pixels in TIFF files that are no picture, or that OpenImageIO reads wrongly.
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "surface/image_file/tiff_pages.h"

namespace tangi {

namespace {

constexpr const char* kSaveAsRgb = "save it as RGB or grey, of 8 or 16 bits, or as 32-bit floats";

bool is_among(int value, std::initializer_list<int> of) {
    return std::find(of.begin(), of.end(), value) != of.end();
}

// Numbers of a kind for which OpenImageIO 2.4 has none, or makes others of (24 bits).
std::string unreadable_numbers(const TiffPage& page) {
    if (!is_among(page.sample_format, {kTiffUnsigned, kTiffSigned, kTiffFloat, 4}))
        return fmt::format("holds complex numbers (SampleFormat {}), which are no picture; {}",
                           page.sample_format, kSaveAsRgb);
    const bool is_float = page.sample_format == kTiffFloat;
    if (is_float ? is_among(page.bits, {16, 32, 64}) : (page.bits <= 16 || page.bits == 32)) return {};
    return fmt::format("holds {} of {} bits, which are not read; {}", is_float ? "floats" : "integers",
                       page.bits, kSaveAsRgb);
}

// In words, where the number of the kind alone condemns it.
const char* unreadable_colours(const TiffPage& page) {
    const bool is_raw_sample = page.photometric == kTiffMosaic;
    if (is_raw_sample)
        return "is the mosaic of a camera's sensor (CFA), which is no picture yet; develop it in a raw "
               "converter, or name it .dng if it is a DNG file";
    if (page.photometric == kTiffLogL || page.photometric == kTiffLogLuv)
        return "stores logarithms of luminance (LogLuv), which are not read; save it as an EXR file, or as a "
               "TIFF of 32-bit floats";
    if (page.photometric == kTiffItuLab)
        return "stores colours of a fax machine (ITU L*a*b*), which are not read; save it as RGB";
    if (page.photometric == kTiffYcbcr && page.bits != 8)
        return "stores YCbCr of more than 8 bits, which is not read; save it as RGB";
    if (page.photometric == kTiffInks && page.is_tiled)
        return "stores printing inks (CMYK) in tiles, which are not read; save it as RGB";
    return nullptr;
}

}  // namespace

std::string unreadable_kind(const TiffPage& page) {
    if (std::string why = unreadable_numbers(page); !why.empty()) return why;
    if (const char* why = unreadable_colours(page)) return why;
    if (page.photometric == kTiffMinIsWhite && page.sample_format == kTiffFloat)
        return fmt::format(
            "holds floats of which 0 is white (MinIsWhite), and nothing says which is black; {}", kSaveAsRgb);
    if (page.photometric == -1 ||
        is_among(page.photometric, {kTiffMinIsWhite, kTiffMinIsBlack, kTiffRgb, kTiffPalette, kTiffMask,
                                    kTiffInks, kTiffYcbcr, kTiffCielab, kTiffIccLab, kTiffLinearRaw}))
        return {};
    return fmt::format("stores its colours in a way that is not known (PhotometricInterpretation {}); {}",
                       page.photometric, kSaveAsRgb);
}

}  // namespace tangi
