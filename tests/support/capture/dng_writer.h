// dng_writer.h: uncompressed DNG files of known content, for tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "surface/image/image.h"
#include "tests/support/test_support.h"

namespace tangi {

struct DngOptions {
    int black = 512, white = 16000;         // [codes]
    float neutral[3] = {0.5f, 1.0f, 0.7f};  // AsShotNeutral: what grey gives in the camera's channels
    int orientation = 1;                    // EXIF
    double exposure_s = 0.02, f_number = 8, iso = 100;
};

// A mosaic RGGB of 16-bit codes, black + value * (white - black), from linear values of the camera's
// channels, which clip at white. The camera's primaries are those of Rec. 709. (TIFF 6.0; DNG 1.4, "Digital
// Negative specification".)
inline void write_dng(const std::filesystem::path& path, const Image<Rgb>& camera, const DngOptions& o = {}) {
    using Bytes = std::string;
    const auto le = [](std::uint64_t value, int bytes) {
        Bytes result;
        for (int i = 0; i < bytes; ++i) result += static_cast<char>(value >> (8 * i) & 255);
        return result;
    };
    const auto ratio = [&](double value) {
        return le(static_cast<std::uint32_t>(std::lround(value * 10000)), 4) + le(10000, 4);
    };
    Bytes pixels;
    for (int y = 0; y < camera.height(); ++y)
        for (int x = 0; x < camera.width(); ++x) {
            const double value = static_cast<double>(camera(x, y)[(x & 1) + (y & 1)]);
            const double code = o.black + value * (o.white - o.black);
            pixels += le(static_cast<std::uint64_t>(std::lround(std::clamp(code, 0.0, double(o.white)))), 2);
        }
    struct Entry {
        int type;
        std::size_t count;
        Bytes value;
    };
    std::map<int, Entry> entries;
    const auto longs = [&](int tag, std::uint32_t v) { entries[tag] = {4, 1, le(v, 4)}; };
    const auto shorts = [&](int tag, const std::vector<int>& v) {
        Bytes bytes;
        for (const int s : v) bytes += le(static_cast<std::uint64_t>(s), 2);
        entries[tag] = {3, v.size(), bytes};
    };
    const auto text = [&](int tag, const Bytes& v) { entries[tag] = {2, v.size() + 1, v + '\0'}; };
    longs(254, 0);
    longs(256, static_cast<std::uint32_t>(camera.width()));
    longs(257, static_cast<std::uint32_t>(camera.height()));
    shorts(258, {16});
    shorts(259, {1});
    shorts(262, {32803});  // colour filter array
    text(271, "Test");
    text(272, "TestCam");
    longs(273, 0);  // where the pixels are: below
    shorts(274, {o.orientation});
    shorts(277, {1});
    longs(278, static_cast<std::uint32_t>(camera.height()));
    longs(279, static_cast<std::uint32_t>(pixels.size()));
    shorts(284, {1});
    entries[33421] = {3, 2, le(2, 2) + le(2, 2)};
    entries[33422] = {1, 4, Bytes("\0\1\1\2", 4)};
    longs(34665, 0);  // where the EXIF directory is: below
    const std::map<int, Entry> exif = {{33434, {5, 1, ratio(o.exposure_s)}},
                                       {33437, {5, 1, ratio(o.f_number)}},
                                       {34855, {3, 1, le(static_cast<std::uint64_t>(o.iso), 2)}}};
    entries[50706] = {1, 4, Bytes("\1\4\0\0", 4)};
    text(50708, "TestCam");
    shorts(50713, {1, 1});
    longs(50714, static_cast<std::uint32_t>(o.black));
    longs(50717, static_cast<std::uint32_t>(o.white));
    Bytes matrix;  // XYZ -> camera: the inverse of IEC 61966-2-1
    for (const double m : {3.2404542, -1.5371385, -0.4985314, -0.9692660, 1.8760108, 0.0415560, 0.0556434,
                           -0.2040259, 1.0572252})
        matrix += ratio(m);
    entries[50721] = {10, 9, matrix};
    entries[50728] = {
        5, 3, ratio(double(o.neutral[0])) + ratio(double(o.neutral[1])) + ratio(double(o.neutral[2]))};
    shorts(50778, {21});  // D65

    // A directory at `at`, with what does not fit into its entries behind it.
    const auto directory = [&](const std::map<int, Entry>& list, std::size_t at) {
        const std::size_t extra_at = at + 2 + 12 * list.size() + 4;
        Bytes file = le(list.size(), 2), extra;
        for (const auto& [tag, entry] : list) {
            file += le(static_cast<std::uint64_t>(tag), 2) + le(static_cast<std::uint64_t>(entry.type), 2) +
                    le(entry.count, 4);
            if (entry.value.size() <= 4) {
                file += entry.value + Bytes(4 - entry.value.size(), '\0');
            } else {
                file += le(extra_at + extra.size(), 4);
                extra += entry.value + Bytes(entry.value.size() % 2, '\0');
            }
        }
        return file + le(0, 4) + extra;
    };
    const std::size_t exif_at = 8 + directory(entries, 8).size();
    const Bytes exif_bytes = directory(exif, exif_at);
    entries[34665].value = le(exif_at, 4);
    entries[273].value = le(exif_at + exif_bytes.size(), 4);
    const Bytes file = "II*" + Bytes(1, '\0') + le(8, 4) + directory(entries, 8) + exif_bytes;
    write_bytes(path, file + pixels);
}

}  // namespace tangi
