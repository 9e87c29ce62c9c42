#include "capture/photo_file.h"

#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "capture/colour_channels.h"
#include "capture/lab_colour.h"
#include "capture/left_out.h"
#include "capture/raw_file.h"
#include "surface/error.h"
#include "surface/image.h"
#include "surface/jpeg_segments.h"
#include "surface/json_text.h"
#include "surface/picture_file.h"
#include "surface/png_chunks.h"
#include "surface/safe_picture.h"
#include "surface/tiff_pages.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::optional<SafePicture> safe_photo(const fs::path& path) {
    try {
        return std::optional<SafePicture>(path);
    } catch (const Error& error) {
        throw PhotoError(path, error.what());
    }
}

}  // namespace

struct PhotoFile::Decoder {
    std::optional<SafePicture> safe;  // what `input` reads
    std::unique_ptr<OIIO::ImageInput> input;
    int page = 0;  // of the file's pictures
    int first_channel = 0;
    Region window;                 // what the file has of the picture
    std::optional<LabKind> lab{};  // stored as L*a*b*
    std::vector<float> in_window;  // scratch for rows of it
    std::vector<char> stored;      // scratch for rows as stored
    std::vector<float> tile_rows;  // scratch for tiled files
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

void require_no_hidden_picture(const fs::path& path, const TiffPages& pages) {
    if (const TiffPage* larger = pages.larger_hidden())
        fail_photo(path,
                   "its picture of {} x {} lies below a smaller one ({} x {}), where it cannot be read "
                   "(SubIFD); save it as a plain TIFF",
                   larger->width, larger->height, pages.picture().width, pages.picture().height);
}

std::optional<LabKind> lab_of(const std::optional<TiffPages>& pages) {
    if (!pages) return {};
    const int photometric = pages->picture().photometric;
    if (photometric == kTiffCielab) return LabKind::cielab;
    if (photometric == kTiffIccLab) return LabKind::icc_lab;
    return {};
}

// What the picture is in an EXR file (OpenEXR, "Display Window"), from its corner.
Region display_window(const fs::path& path, const OIIO::ImageSpec& spec) {
    // Of a window far larger than what is there, memory would be asked for to hold nothing.
    constexpr double kLeastThere = 1.0 / 64;
    const Region window{0, 0, spec.full_width, spec.full_height};
    const int x0 = std::max(spec.x, spec.full_x),
              x1 = std::min(spec.x + spec.width, spec.full_x + spec.full_width);
    const int y0 = std::max(spec.y, spec.full_y),
              y1 = std::min(spec.y + spec.height, spec.full_y + spec.full_height);
    const double there = std::max(x1 - x0, 0) * static_cast<double>(std::max(y1 - y0, 0));
    if (!(there >= kLeastThere * window.width() * window.height()) || window.empty())
        fail_photo(
            path,
            "its data window ({} x {} at {}, {}) has next to nothing of its display window ({} x {} at {}, "
            "{}); store the picture with the right windows",
            spec.width, spec.height, spec.x, spec.y, spec.full_width, spec.full_height, spec.full_x,
            spec.full_y);
    return window;
}

std::vector<std::string> doubts_about(const OIIO::ImageSpec& spec, int page,
                                      const std::optional<TiffPages>& pages, const Region& window,
                                      const Region& picture) {
    std::vector<std::string> doubts;
    const std::size_t alike = pages ? pages->alike : 1;
    if (alike > 1)
        doubts.push_back(fmt::format(
            "holds {} pictures of the same size, of which the first (page {}) is used; where another one is "
            "meant, save it as a file of its own",
            alike, page + 1));
    if (window.x0 > 0 || window.y0 > 0 || window.x1 < picture.x1 || window.y1 < picture.y1)
        doubts.push_back(
            "does not have all pixels of its display window; there is no sample where they are missing");
    constexpr float kSquare = 0.01f;  // [1] resolutions are often rounded
    if (const float aspect = spec.get_float_attribute("PixelAspectRatio", 1.0f);
        aspect > 0 && std::abs(aspect - 1) > kSquare)
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
    if (!fs::exists(path_)) fail_photo(path_, "no such photograph");
    if (fs::is_directory(path_)) fail_photo(path_, "is a folder, not a photograph");
    if (!fs::is_regular_file(path_)) fail_photo(path_, "is a pipe or a device, not a photograph");
    if (::access(path_.c_str(), R_OK) != 0) fail_photo(path_, "cannot be read: {}", std::strerror(errno));
    decoder_->demosaic = std::move(demosaic);
    if (is_raw_name(path_)) {
        const RawHeader raw = read_raw_header(path_);
        header_ = {.width = raw.width,
                   .height = raw.height,
                   .channels = 3,
                   .bits = 16,
                   .is_raw = true,
                   .orientation = raw.orientation};
        return;
    }
    if (!is_whole_png(path_))
        fail_photo(path_, "the PNG file is truncated; copy it again from the camera or the archive");
    const std::optional<TiffPages> pages = tiff_pages(path_);
    if (pages) require_no_hidden_picture(path_, *pages);
    decoder_->page = pages ? static_cast<int>(pages->chosen) : 0;
    decoder_->lab = lab_of(pages);
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    if (decoder_->lab) config.attribute("oiio:RawColor", 1);  // else OpenImageIO makes 8 bits of sRGB of it
    decoder_->safe = safe_photo(path_);
    decoder_->input = OIIO::ImageInput::create(decoder_->safe->reader());
    OIIO::ImageSpec spec;
    if (!decoder_->input)
        fail_photo(path_, "is not a picture that can be read: {}", trouble_with_picture(OIIO::geterror()));
    if (!decoder_->input->open(decoder_->safe->path(), spec, config) ||
        !decoder_->input->seek_subimage(decoder_->page, 0))
        fail_photo(path_, "is not a picture that can be read: {}",
                   trouble_with_picture(decoder_->input->geterror()));
    spec = decoder_->input->spec();
    if (!is_whole_jpeg(path_))
        fail_photo(path_, "the JPEG file is truncated; copy it again from the camera or the archive");
    if (spec.nchannels < 1 || spec.width < 1 || spec.height < 1) fail_photo(path_, "holds no pixels");
    const bool is_exr = lower_extension(path_) == ".exr";
    const ColourChannels colours = colour_channels(spec.channelnames, spec.alpha_channel, is_exr);
    if (colours.count == 0) fail_photo(path_, "{}", colours.doubt);
    decoder_->first_channel = colours.first;
    const Region picture = is_exr ? display_window(path_, spec) : Region{0, 0, spec.width, spec.height};
    const glm::ivec2 corner = is_exr ? glm::ivec2(spec.x - spec.full_x, spec.y - spec.full_y) : glm::ivec2(0);
    decoder_->window = {corner.x, corner.y, corner.x + spec.width, corner.y + spec.height};
    const bool is_float = spec.format.is_floating_point() || decoder_->lab;
    header_ = {.width = picture.width(),
               .height = picture.height(),
               .channels = colours.count,
               .bits = is_float ? 32 : static_cast<int>(spec.format.basesize()) * 8,
               .is_float = is_float,
               .orientation = spec.get_int_attribute("Orientation", 1),
               .doubts = doubts_about(spec, decoder_->page, pages, decoder_->window, picture)};
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

namespace {

// As OIIO::convert_pixel_values(), which takes bytes one at a time.
bool to_floats(OIIO::TypeDesc format, const std::vector<char>& stored, std::span<float> values) {
    if (format != OIIO::TypeDesc::UINT8)
        return OIIO::convert_pixel_values(format, stored.data(), OIIO::TypeDesc::FLOAT, values.data(),
                                          static_cast<int>(values.size()));
    constexpr float scale = 1.0f / 255;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(static_cast<unsigned char>(stored[i])) * scale;
    return true;
}

}  // namespace

void PhotoFile::read_rows(int y0, int y1, std::span<float> values) {
    const auto row = static_cast<std::size_t>(header_.width) * static_cast<std::size_t>(header_.channels);
    TP_REQUIRE(y0 >= 0 && y0 < y1 && y1 <= header_.height, "rows lie in the picture");
    TP_REQUIRE(values.size() >= row * static_cast<std::size_t>(y1 - y0), "the buffer holds the rows");
    values = values.first(row * static_cast<std::size_t>(y1 - y0));
    if (header_.is_raw) return read_raw_rows(y0, y1, values);
    if (decoder_->window == Region{0, 0, header_.width, header_.height}) {
        decode_rows(y0, y1, values);
        mask_what_is_no_number(values);
    } else {
        read_window(y0, y1, values);
    }
    if (decoder_->lab)
        linear_of_lab(*decoder_->lab, static_cast<int>(decoder_->input->spec().format.basesize()) * 8,
                      values);
}

// Rows of the picture of which the file may have a part, or more.
void PhotoFile::read_window(int y0, int y1, std::span<float> values) {
    const Region& window = decoder_->window;
    const auto channels = static_cast<std::size_t>(header_.channels),
               row = static_cast<std::size_t>(header_.width) * channels;
    std::fill(values.begin(), values.end(), std::numeric_limits<float>::quiet_NaN());
    const int first = std::max(y0, window.y0), last = std::min(y1, window.y1);
    const int x0 = std::max(window.x0, 0), x1 = std::min(window.x1, header_.width);
    if (first >= last || x0 >= x1) return;
    const std::size_t in_row = static_cast<std::size_t>(window.width()) * channels,
                      count = static_cast<std::size_t>(x1 - x0) * channels;
    std::vector<float>& rows = decoder_->in_window;
    rows.resize(in_row * static_cast<std::size_t>(last - first));
    decode_rows(first - window.y0, last - window.y0, rows);
    for (int y = first; y < last; ++y) {
        const auto from =
            rows.begin() + static_cast<std::ptrdiff_t>(in_row * static_cast<std::size_t>(y - first) +
                                                       static_cast<std::size_t>(x0 - window.x0) * channels);
        const std::span<float> to = values.subspan(
            row * static_cast<std::size_t>(y - y0) + static_cast<std::size_t>(x0) * channels, count);
        std::copy_n(from, count, to.begin());
        mask_what_is_no_number(to);
    }
}

// A colour of which one channel is not known is none.
void PhotoFile::mask_what_is_no_number(std::span<float> values) {
    if (!header_.is_float || decoder_->lab) return;
    const auto channels = static_cast<std::size_t>(header_.channels);
    for (std::size_t i = 0; i < values.size(); i += channels) {
        const std::span<float> pixel = values.subspan(i, channels);
        if (std::all_of(pixel.begin(), pixel.end(), is_light)) continue;
        std::fill(pixel.begin(), pixel.end(), std::numeric_limits<float>::quiet_NaN());
        ++without_number_;
    }
}

// Rows of what the file has, as stored.
void PhotoFile::decode_rows(int y0, int y1, std::span<float> values) {
    OIIO::ImageInput& input = *decoder_->input;
    const OIIO::ImageSpec& spec = input.spec();
    const int page = decoder_->page, c0 = decoder_->first_channel, c1 = c0 + header_.channels;
    const std::size_t row = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(header_.channels);
    bool read = false;
    if (spec.tile_width == 0 && spec.channelformats.empty()) {
        // As stored, and converted here: OpenImageIO 2.4 would take 64 MiB for each call to convert it.
        decoder_->stored.resize(spec.scanline_bytes(true) * static_cast<std::size_t>(y1 - y0));
        read = input.read_scanlines(page, 0, spec.y + y0, spec.y + y1, 0, c0, c1, OIIO::TypeDesc::UNKNOWN,
                                    decoder_->stored.data()) &&
               to_floats(spec.format, decoder_->stored, values);
    } else if (spec.tile_width == 0) {
        read = input.read_scanlines(page, 0, spec.y + y0, spec.y + y1, 0, c0, c1, OIIO::TypeDesc::FLOAT,
                                    values.data());
    } else {
        // Whole tiles only: read the rows of tiles that hold the wanted rows, then copy those out.
        const int th = spec.tile_height;
        const int t0 = y0 / th * th, t1 = std::min((y1 + th - 1) / th * th, spec.height);
        decoder_->tile_rows.resize(row * static_cast<std::size_t>(t1 - t0));
        read = input.read_tiles(page, 0, spec.x, spec.x + spec.width, spec.y + t0, spec.y + t1, 0, 1, c0, c1,
                                OIIO::TypeDesc::FLOAT, decoder_->tile_rows.data());
        const auto from = decoder_->tile_rows.begin() + static_cast<std::ptrdiff_t>(row) * (y0 - t0);
        std::copy_n(from, row * static_cast<std::size_t>(y1 - y0), values.begin());
    }
    if (!read ||
        input.has_error())  // strips of a TIFF file that cannot be read show only there (OpenImageIO 2.4)
        fail_photo(path_, "cannot be decoded at rows {} to {}: {}", y0, y1 - 1,
                   trouble_with_pixels(input.geterror()));
}

}  // namespace tangi
