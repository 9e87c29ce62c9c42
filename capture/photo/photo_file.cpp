#include "capture/photo/photo_file.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "capture/photo/colour_channels.h"
#include "capture/photo/lab_colour.h"
#include "capture/photo/photo_metadata.h"
#include "capture/photo/raw_file.h"
#include "capture/photo/rejected_photo.h"
#include "capture/photo/stated_transfer.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_rows.h"
#include "surface/image_file/tiff_pages.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// From which on a pixel is the picture's more than that of what lies behind, as see_through() asks of masks.
constexpr float kLeastAlpha = 0.5f;

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
    int alpha = -1;  // the channel that says what is transparent; -1: none
    std::vector<float>
        with_alpha{};              // scratch for rows of all channels from the first to the last one needed
    std::vector<float> alphas{};   // of the pixels of the rows that are read; empty: there is none
    std::optional<LabKind> lab{};  // stored as L*a*b*
    std::optional<Transfer> profile{};  // of floats: by which they are decoded
    std::string demosaic;
    std::vector<std::uint16_t> raw;  // a developed camera raw, while its rows are read
};

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
        doubts.push_back(
            fmt::format("its colour profile (ICC) is damaged ({}), and it is read as if it had none: by what "
                        "else it says of its encoding (EXIF, sRGB and gAMA chunks), or by what the "
                        "photographs show; where colours "
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
    open_picture();
}

namespace {

// How floats of a TIFF file are encoded, by their ICC profile; nothing where they are linear light, or none
// tells.
struct FloatEncoding {
    std::optional<Transfer> curve{};
    bool is_told = false;
    std::string doubt{};
};

FloatEncoding float_encoding(const fs::path& path) {
    const std::string profile = read_photo_metadata(path).icc_profile;
    if (profile.empty()) return {};
    const std::optional<Transfer> curve = transfer_of_icc(profile);
    if (!curve)
        return {
            .doubt =
                "the tone curve of its colour profile (ICC) is neither linear, nor sRGB, nor a gamma, nor "
                "smooth, and is not used: its floats are taken for linear light; convert them to linear "
                "light or sRGB"};
    if (*curve == Transfer{}) return {.is_told = true};
    return {
        curve, true,
        fmt::format("holds floats that are stored as {} by its colour profile (ICC), and is decoded by it",
                    curve->name())};
}

void refuse_what_is_no_light(const fs::path& path, const PictureContent& content) {
    if (content.of_inks)
        fail_photo(path,
                   "is stored in printing inks (CMYK), which do not say how much light there was; convert it "
                   "to RGB, or develop the camera's file anew");
}

}  // namespace

void PhotoFile::open_picture() {
    constexpr bool lab_as_stored = true;
    decoder_->rows =
        as_photo(path_, [&] { return std::optional<PictureRows>(std::in_place, path_, lab_as_stored); });
    const PictureContent& content = decoder_->rows->content();
    refuse_what_is_no_light(path_, content);
    const ColourChannels colours = colour_channels(content.channels, content.alpha, content.is_exr);
    if (colours.count == 0) fail_photo(path_, "{}", colours.doubt);
    decoder_->first_channel = colours.first;
    decoder_->alpha = content.alpha_is_vague ? -1 : content.alpha;
    decoder_->lab = lab_of(content.photometric);
    const bool is_float = content.is_float || decoder_->lab;
    header_ = {.width = content.width,
               .height = content.height,
               .channels = colours.count,
               .bits = is_float ? 32 : std::min(content.bits, 16),
               .is_float = is_float,
               .says_linear = content.is_exr || decoder_->lab,
               .orientation = content.orientation,
               .doubts = doubts_about(content)};
    if (!colours.doubt.empty()) header_.doubts.push_back(colours.doubt);
    if (!is_float || header_.says_linear) return;
    const FloatEncoding encoding = as_photo(path_, [&] { return float_encoding(path_); });
    decoder_->profile = encoding.curve;
    header_.says_linear = encoding.is_told;
    if (!encoding.doubt.empty()) header_.doubts.push_back(encoding.doubt);
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

namespace {

// Linear light; NaN where a channel has full scale, to rounding: what is clipped leaves just that, and light
// hardly.
void decode(const Transfer& profile, std::size_t channels, std::span<float> values) {
    constexpr float rounding = 1e-6f, nan = std::numeric_limits<float>::quiet_NaN();
    for (; !values.empty(); values = values.subspan(channels)) {
        const std::span<float> pixel = values.first(channels);
        const bool clipped = std::any_of(pixel.begin(), pixel.end(),
                                         [](float value) { return std::abs(value - 1) < rounding; });
        for (float& value : pixel) value = clipped ? nan : profile.decode(value);
    }
}

}  // namespace

void PhotoFile::read_rows(int y0, int y1, std::span<float> values) {
    const auto row = static_cast<std::size_t>(header_.width) * static_cast<std::size_t>(header_.channels);
    TP_REQUIRE(y0 >= 0 && y0 < y1 && y1 <= header_.height, "rows lie in the picture");
    TP_REQUIRE(values.size() >= row * static_cast<std::size_t>(y1 - y0), "the buffer holds the rows");
    values = values.first(row * static_cast<std::size_t>(y1 - y0));
    if (header_.is_raw) return read_raw_rows(y0, y1, values);
    as_photo(path_, [&] {
        if (decoder_->alpha < 0)
            decoder_->rows->read(y0, y1, decoder_->first_channel, header_.channels, values);
        else
            read_with_alpha(y0, y1, values);
        return true;
    });
    require_no_negative(y0, y1, values);
    mask_what_is_no_number(y0, values);  // as stored: marks are values
    mask_transparent(values);
    if (decoder_->profile) decode(*decoder_->profile, static_cast<std::size_t>(header_.channels), values);
    if (decoder_->lab) linear_of_lab(*decoder_->lab, decoder_->rows->content().bits, values);
}

void PhotoFile::read_with_alpha(int y0, int y1, std::span<float> values) {
    const int first = std::min(decoder_->first_channel, decoder_->alpha),
              end = std::max(decoder_->first_channel + header_.channels, decoder_->alpha + 1);
    const auto channels = static_cast<std::size_t>(header_.channels),
               all = static_cast<std::size_t>(end - first),
               colour = static_cast<std::size_t>(decoder_->first_channel - first),
               alpha = static_cast<std::size_t>(decoder_->alpha - first);
    std::vector<float>& rows = decoder_->with_alpha;
    decoder_->alphas.resize(values.size() / channels);
    rows.resize(decoder_->alphas.size() * all);
    decoder_->rows->read(y0, y1, first, end - first, rows);
    for (std::size_t i = 0; i < decoder_->alphas.size(); ++i) {
        std::copy_n(&rows[i * all + colour], channels, &values[i * channels]);
        decoder_->alphas[i] = rows[i * all + alpha];
    }
}

void PhotoFile::mask_transparent(std::span<float> values) {
    constexpr float most = 1;
    const bool multiplied = decoder_->rows->content().multiplied;
    const auto channels = static_cast<std::size_t>(header_.channels);
    for (std::size_t i = 0; i < decoder_->alphas.size(); ++i) {
        const std::span<float> pixel = values.subspan(i * channels, channels);
        const float part = decoder_->alphas[i];
        if (part < kLeastAlpha) {
            std::fill(pixel.begin(), pixel.end(), std::numeric_limits<float>::quiet_NaN());
            ++transparent_;
        } else if (multiplied && part < most) {
            for (float& value : pixel) value = header_.is_float ? value / part : std::min(value / part, most);
        }
    }
}

void PhotoFile::require_no_negative(int y0, int y1, std::span<const float> values) const {
    if (!decoder_->rows->content().is_signed || decoder_->lab) return;
    if (std::any_of(values.begin(), values.end(), [](float value) { return value < 0; }))
        fail_photo(
            path_,
            "holds negative integers (SampleFormat 2) at rows {} to {}, and nothing says which of them is "
            "black; save it as unsigned integers, or as floats",
            y0, y1 - 1);
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
        const bool counts = decoder_->alphas.empty() || decoder_->alphas[i] >= kLeastAlpha;
        without_number_ +=
            counts && content.has(static_cast<int>(i % width), y0 + static_cast<int>(i / width));
    }
}

void divide_by_full_scale(std::span<float> values, double full_scale, bool codes) {
    const auto factor = static_cast<float>(1 / full_scale);
    for (float& value : values) {
        value *= factor;
        if (codes && !std::isnan(value)) value = std::clamp(value, 0.0f, 1.0f);
    }
}

}  // namespace tangi
