#include "capture/photo_file.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "capture/colour_channels.h"
#include "capture/lab_colour.h"
#include "capture/left_out.h"
#include "capture/raw_file.h"
#include "surface/error.h"
#include "surface/picture_file.h"
#include "surface/picture_rows.h"
#include "surface/tiff_pages.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// What is wrong with a picture is wrong with a photograph, which others can do without.
template <class Read>
auto as_photo(const fs::path& path, const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        throw PhotoError(path, error.what());
    }
}

}  // namespace

struct PhotoFile::Decoder {
    std::optional<PictureRows> rows;  // of what is not camera raw
    int first_channel = 0;
    std::optional<LabKind> lab{};  // stored as L*a*b*
    std::string demosaic;
    std::vector<std::uint16_t> raw;  // a developed camera raw, while its rows are read
};

bool is_photo_name(const fs::path& path) {
    static constexpr std::array<std::string_view, 8> known = {".jpg",  ".jpeg", ".png", ".tif",
                                                              ".tiff", ".exr",  ".tga", ".bmp"};
    return std::find(known.begin(), known.end(), lower_extension(path)) != known.end() || is_raw_name(path);
}

bool is_light(float value) {
    constexpr float largest_half = 65504, brightest = 1e10f, darkest = -1000;
    return value > darkest && value < brightest && value != largest_half;
}

namespace {

void require_file(const fs::path& path) {
    if (!fs::exists(path)) fail_photo(path, "no such photograph");
    if (fs::is_directory(path)) fail_photo(path, "is a folder, not a photograph");
    if (!fs::is_regular_file(path)) fail_photo(path, "is a pipe or a device, not a photograph");
    if (::access(path.c_str(), R_OK) != 0) fail_photo(path, "cannot be read: {}", std::strerror(errno));
}

PhotoHeader raw_photo_header(const fs::path& path) {
    const RawHeader raw = read_raw_header(path);
    return {.width = raw.width,
            .height = raw.height,
            .channels = 3,
            .bits = 16,
            .is_raw = true,
            .orientation = raw.orientation};
}

std::optional<LabKind> lab_of(int photometric) {
    if (photometric == kTiffCielab) return LabKind::cielab;
    if (photometric == kTiffIccLab) return LabKind::icc_lab;
    return {};
}

std::vector<std::string> doubts_about(const PictureContent& content) {
    std::vector<std::string> doubts;
    if (content.profile_damage)
        doubts.push_back(fmt::format(
            "its colour profile (ICC) is damaged ({}), and it is read as if it had none: by what else it "
            "says "
            "of its encoding (EXIF, sRGB and gAMA chunks), or by what the photographs show; where colours "
            "matter, save it anew with a sound profile",
            *content.profile_damage));
    if (content.alike > 1)
        doubts.push_back(fmt::format(
            "holds {} pictures of the same size, of which the first (page {}) is used; where another one is "
            "meant, save it as a file of its own",
            content.alike, content.page + 1));
    if (!content.is_complete())
        doubts.push_back(
            "does not have all pixels of its display window; there is no sample where they are missing");
    if (const float aspect = content.pixel_aspect; aspect > 0 && std::abs(aspect - 1) > kSquarePixels)
        doubts.push_back(
            fmt::format("says that its pixels are {:.3g} times as wide as they are high, which is not "
                        "undone: they are taken "
                        "for squares, and lengths and heights are wrong if it is true; resample the "
                        "photographs to square "
                        "pixels, or correct that entry",
                        aspect));
    return doubts;
}

}  // namespace

PhotoFile::PhotoFile(fs::path path, std::string demosaic)
    : path_(std::move(path)), decoder_(std::make_unique<Decoder>()) {
    require_file(path_);
    decoder_->demosaic = std::move(demosaic);
    if (is_raw_name(path_)) {
        header_ = raw_photo_header(path_);
        return;
    }
    constexpr bool lab_as_stored = true;
    decoder_->rows =
        as_photo(path_, [&] { return std::optional<PictureRows>(std::in_place, path_, lab_as_stored); });
    const PictureContent& content = decoder_->rows->content();
    const ColourChannels colours = colour_channels(content.channels, content.alpha, content.is_exr);
    if (colours.count == 0) fail_photo(path_, "{}", colours.doubt);
    decoder_->first_channel = colours.first;
    decoder_->lab = lab_of(content.photometric);
    const bool is_float = content.is_float || decoder_->lab;
    header_ = {.width = content.width,
               .height = content.height,
               .channels = colours.count,
               .bits = is_float ? 32 : content.bits,
               .is_float = is_float,
               .orientation = content.orientation,
               .doubts = doubts_about(content)};
    if (!colours.doubt.empty()) header_.doubts.push_back(colours.doubt);
}

PhotoFile::~PhotoFile() = default;
PhotoFile::PhotoFile(PhotoFile&&) noexcept = default;
PhotoFile& PhotoFile::operator=(PhotoFile&&) noexcept = default;

void PhotoFile::read_raw_rows(int y0, int y1, std::span<float> values) {
    std::vector<std::uint16_t>& raw = decoder_->raw;
    if (raw.empty()) raw = develop_raw(path_, decoder_->demosaic);
    const auto row = static_cast<std::size_t>(header_.width) * 3;
    const auto begin = raw.begin() + static_cast<std::ptrdiff_t>(row) * y0;
    std::transform(begin, begin + static_cast<std::ptrdiff_t>(row) * (y1 - y0), values.begin(),
                   [](std::uint16_t code) { return static_cast<float>(code) / 65535; });
    if (y1 == header_.height) std::vector<std::uint16_t>().swap(raw);
}

void PhotoFile::read_rows(int y0, int y1, std::span<float> values) {
    const auto row = static_cast<std::size_t>(header_.width) * static_cast<std::size_t>(header_.channels);
    TP_REQUIRE(y0 >= 0 && y0 < y1 && y1 <= header_.height, "rows lie in the picture");
    TP_REQUIRE(values.size() >= row * static_cast<std::size_t>(y1 - y0), "the buffer holds the rows");
    values = values.first(row * static_cast<std::size_t>(y1 - y0));
    if (header_.is_raw) return read_raw_rows(y0, y1, values);
    as_photo(path_, [&] {
        decoder_->rows->read(y0, y1, decoder_->first_channel, header_.channels, values);
        return true;
    });
    mask_what_is_no_number(y0, values);
    if (decoder_->lab) linear_of_lab(*decoder_->lab, decoder_->rows->content().bits, values);
}

// A colour of which one channel is not known is none.
void PhotoFile::mask_what_is_no_number(int y0, std::span<float> values) {
    if (!header_.is_float || decoder_->lab) return;
    const PictureContent& content = decoder_->rows->content();
    const auto channels = static_cast<std::size_t>(header_.channels),
               width = static_cast<std::size_t>(header_.width);
    for (std::size_t i = 0; i < values.size() / channels; ++i) {
        const std::span<float> pixel = values.subspan(i * channels, channels);
        if (std::all_of(pixel.begin(), pixel.end(), is_light)) continue;
        std::fill(pixel.begin(), pixel.end(), std::numeric_limits<float>::quiet_NaN());
        // What the file does not have is no number that is wrong.
        without_number_ += content.has(static_cast<int>(i % width), y0 + static_cast<int>(i / width));
    }
}

}  // namespace tangi
