// raw_file.h: camera raw, developed to linear light in the camera's own primaries, through LibRaw.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace tangi {

// CR2, CR3, NEF, ARW, DNG, RAF, ORF, RW2 and others (photo_format.h), judged by the extension (in any case).
bool is_raw_name(const std::filesystem::path& path);

// Ways of LibRaw to fill in the two colours that a pixel of the sensor did not measure. The first is the
// default.
const std::vector<std::string>& demosaic_methods();

struct RawHeader {
    int width = 0, height = 0;
    int orientation = 1;  // EXIF
    std::string camera;   // "Canon EOS 5DS"
    // By which the channels of a neutral object are multiplied to become equal, green = 1: as the camera
    // chose them, or for daylight where it did not say.
    std::array<float, 3> white_balance{1, 1, 1};
    // Balanced camera colour -> linear Rec. 709, rows (LibRaw's, from the maker's or Adobe's matrix).
    std::array<float, 9> to_rec709{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

// Throws Error naming the file and the remedy: LibRaw does not know the camera, or the file is damaged.
RawHeader read_raw_header(const std::filesystem::path& path);

// The whole picture, interleaved RGB, width * height * 3 values, row 0 at the top of the sensor (no turning):
// (sensor value - black level) / (saturation - black level) * 65535, clipped to 0 and 65535. No gamma, no
// brightness, no white balance, no conversion of primaries, no reconstruction of highlights. A value that is
// clipped on the sensor is 65535 but for demosaicing, which mixes it with its neighbours. Takes about 30
// bytes a pixel of memory, DCB 45, AAHD 60. Throws as read_raw_header(), and for an unknown method.
std::vector<std::uint16_t> develop_raw(const std::filesystem::path& path, const std::string& demosaic);

}  // namespace tangi
