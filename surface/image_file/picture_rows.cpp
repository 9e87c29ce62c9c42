#include "surface/image_file/picture_rows.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <limits>

#include "surface/base/error.h"
#include "surface/image_file/jpeg_segments.h"
#include "surface/image_file/png_check.h"
#include "surface/image_file/safe_picture.h"
#include "surface/image_file/tiff_pages.h"

namespace tangi {

namespace fs = std::filesystem;

struct PictureRows::Decoder {
    explicit Decoder(const fs::path& path) : safe(path) {}

    SafePicture safe;  // what `input` reads
    std::unique_ptr<OIIO::ImageInput> input;
    std::vector<float> in_window;  // scratch for rows of the window
    std::vector<char> stored;      // scratch for rows as stored
    std::vector<float> tile_rows;  // scratch for tiled files
};

namespace {

void require_no_hidden_picture(const fs::path& path, const TiffPages& pages) {
    if (const TiffPage* larger = pages.larger_hidden())
        fail(
            "{}: its picture of {} x {} lies below a smaller one ({} x {}), where it cannot be read "
            "(SubIFD); save it as a plain TIFF",
            path.string(), larger->width, larger->height, pages.picture().width, pages.picture().height);
}

// What the picture is in an EXR file (OpenEXR, "Display Window"), from its corner.
void require_display_window(const fs::path& path, const OIIO::ImageSpec& spec) {
    // Of a window far larger than what is there, memory would be asked for to hold nothing.
    constexpr double kLeastThere = 1.0 / 64;
    const int x0 = std::max(spec.x, spec.full_x),
              x1 = std::min(spec.x + spec.width, spec.full_x + spec.full_width);
    const int y0 = std::max(spec.y, spec.full_y),
              y1 = std::min(spec.y + spec.height, spec.full_y + spec.full_height);
    const double there = std::max(x1 - x0, 0) * static_cast<double>(std::max(y1 - y0, 0));
    const double whole = static_cast<double>(spec.full_width) * spec.full_height;
    if (!(there >= kLeastThere * whole) || spec.full_width < 1 || spec.full_height < 1)
        fail(
            "{}: its data window ({} x {} at {}, {}) has next to nothing of its display window ({} x {} at "
            "{}, {}); store the picture with the right windows",
            path.string(), spec.width, spec.height, spec.x, spec.y, spec.full_width, spec.full_height,
            spec.full_x, spec.full_y);
}

PictureContent content_of(const OIIO::ImageSpec& spec, bool is_exr) {
    PictureContent content;
    content.is_exr = is_exr;
    content.width = is_exr ? spec.full_width : spec.width;
    content.height = is_exr ? spec.full_height : spec.height;
    const int x = is_exr ? spec.x - spec.full_x : 0, y = is_exr ? spec.y - spec.full_y : 0;
    content.window = {x, y, x + spec.width, y + spec.height};
    content.channels = spec.channelnames;
    content.alpha = spec.alpha_channel;
    content.multiplied = spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    content.bits = static_cast<int>(spec.format.basesize()) * 8;
    content.is_float = spec.format.is_floating_point();
    content.is_signed = spec.format.is_signed() && !content.is_float;
    content.orientation = spec.get_int_attribute("Orientation", 1);
    content.pixel_aspect = spec.get_float_attribute("PixelAspectRatio", 1.0f);
    return content;
}

// Integers of which 0 is white (TIFF 6.0, MinIsWhite), turned round: OpenImageIO 2.4 does so with bytes
// alone, and then with their alpha as well. `first`: the channel of the first value of a pixel.
void turn_white_to_one(const OIIO::ImageSpec& spec, int first, int count, std::span<float> values) {
    const bool is_turned = spec.format == OIIO::TypeDesc::UINT8;
    const auto channels = static_cast<std::size_t>(count);
    for (std::size_t c = 0; c < channels; ++c) {
        const bool is_alpha = first + static_cast<int>(c) == spec.alpha_channel;
        if (is_turned != is_alpha) continue;
        for (std::size_t i = c; i < values.size(); i += channels) values[i] = 1 - values[i];
    }
}

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

PictureRows::PictureRows(const fs::path& path, bool lab_as_stored) : path_(path) {
    constexpr const char* kTruncated = "{}: the {} file is truncated; copy it again from where it came";
    if (!is_whole_png(path)) fail(kTruncated, path.string(), "PNG");
    const std::optional<TiffPages> pages = tiff_pages(path);
    if (pages) require_no_hidden_picture(path, *pages);
    if (pages)
        if (const std::string why = unreadable_kind(pages->picture()); !why.empty())
            fail("{}: {}", path.string(), why);
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    const int photometric = pages ? pages->picture().photometric : -1;
    // Of L*a*b* alone: YCbCr would stay that, too.
    if (lab_as_stored && (photometric == kTiffCielab || photometric == kTiffIccLab))
        config.attribute("oiio:RawColor", 1);
    decoder_ = std::make_unique<Decoder>(path);
    const SafePicture& safe = decoder_->safe;
    std::unique_ptr<OIIO::ImageInput>& input = decoder_->input = OIIO::ImageInput::create(safe.reader());
    const int page = pages ? static_cast<int>(pages->chosen) : 0;
    OIIO::ImageSpec spec;
    if (!input || !input->open(safe.path(), spec, config) || !input->seek_subimage(page, 0))
        fail("{}: is not a picture that can be read: {}", path.string(),
             trouble_with_picture(path, input ? input->geterror() : OIIO::geterror()));
    spec = input->spec();
    if (!is_whole_jpeg(path)) fail(kTruncated, path.string(), "JPEG");
    if (spec.nchannels < 1 || spec.width < 1 || spec.height < 1) fail("{}: holds no pixels", path.string());
    const bool is_exr = safe.reader() == std::string_view("openexr");
    if (is_exr) require_display_window(path, spec);
    content_ = content_of(spec, is_exr);
    content_.alpha_is_vague =
        safe.reader() == std::string_view("bmp") || safe.reader() == std::string_view("targa");
    content_.page = page;
    content_.alike = pages ? pages->alike : 1;
    content_.photometric = photometric;
    content_.of_inks = safe.of_inks() || content_.photometric == kTiffInks;
    content_.profile_damage = safe.profile_damage();
}

PictureRows::~PictureRows() = default;
PictureRows::PictureRows(PictureRows&&) noexcept = default;
PictureRows& PictureRows::operator=(PictureRows&&) noexcept = default;

void PictureRows::read(int y0, int y1, int first, int count, std::span<float> values) {
    const auto channels = static_cast<std::size_t>(count),
               row = static_cast<std::size_t>(content_.width) * channels;
    TP_REQUIRE(y0 >= 0 && y0 < y1 && y1 <= content_.height, "rows lie in the picture");
    TP_REQUIRE(values.size() >= row * static_cast<std::size_t>(y1 - y0), "the buffer holds the rows");
    values = values.first(row * static_cast<std::size_t>(y1 - y0));
    const Region& window = content_.window;
    if (window == Region{0, 0, content_.width, content_.height}) return decode(y0, y1, first, count, values);
    std::fill(values.begin(), values.end(), std::numeric_limits<float>::quiet_NaN());
    const int from = std::max(y0, window.y0), to = std::min(y1, window.y1);
    const int x0 = std::max(window.x0, 0), x1 = std::min(window.x1, content_.width);
    if (from >= to || x0 >= x1) return;
    const std::size_t in_row = static_cast<std::size_t>(window.width()) * channels,
                      before = static_cast<std::size_t>(x0 - window.x0) * channels,
                      wanted = static_cast<std::size_t>(x1 - x0) * channels;
    std::vector<float>& rows = decoder_->in_window;
    rows.resize(in_row * static_cast<std::size_t>(to - from));
    decode(from - window.y0, to - window.y0, first, count, rows);
    for (int y = from; y < to; ++y) {
        const auto source =
            std::span(rows).subspan(in_row * static_cast<std::size_t>(y - from) + before, wanted);
        std::ranges::copy(
            source,
            values.subspan(row * static_cast<std::size_t>(y - y0) + static_cast<std::size_t>(x0) * channels)
                .begin());
    }
}

// Rows of what the file has.
void PictureRows::decode(int y0, int y1, int first, int count, std::span<float> values) {
    OIIO::ImageInput& input = *decoder_->input;
    const OIIO::ImageSpec& spec = input.spec();
    const int page = content_.page, end = first + count;
    const std::size_t row = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(count);
    bool read = false;
    if (spec.tile_width == 0 && spec.channelformats.empty()) {
        // As stored, and converted here: OpenImageIO 2.4 would take 64 MiB for each call to convert it.
        decoder_->stored.resize(spec.scanline_bytes(true) * static_cast<std::size_t>(y1 - y0));
        read = input.read_scanlines(page, 0, spec.y + y0, spec.y + y1, 0, first, end, OIIO::TypeDesc::UNKNOWN,
                                    decoder_->stored.data()) &&
               to_floats(spec.format, decoder_->stored, values);
    } else if (spec.tile_width == 0) {
        read = input.read_scanlines(page, 0, spec.y + y0, spec.y + y1, 0, first, end, OIIO::TypeDesc::FLOAT,
                                    values.data());
    } else {
        // Whole tiles only: read the rows of tiles that hold the wanted rows, then copy those out.
        const int th = spec.tile_height;
        const int t0 = y0 / th * th, t1 = std::min((y1 + th - 1) / th * th, spec.height);
        decoder_->tile_rows.resize(row * static_cast<std::size_t>(t1 - t0));
        read = input.read_tiles(page, 0, spec.x, spec.x + spec.width, spec.y + t0, spec.y + t1, 0, 1, first,
                                end, OIIO::TypeDesc::FLOAT, decoder_->tile_rows.data());
        const auto from = decoder_->tile_rows.begin() + static_cast<std::ptrdiff_t>(row) * (y0 - t0);
        std::copy_n(from, row * static_cast<std::size_t>(y1 - y0), values.begin());
    }
    // Strips of a TIFF file that cannot be read show only in has_error() (OpenImageIO 2.4).
    if (!read || input.has_error())
        fail("{}: cannot be decoded at rows {} to {}: {}", path_.string(), y0, y1 - 1,
             trouble_with_pixels(path_, input.geterror()));
    decoder_->safe.unpacked();
    if (content_.photometric == kTiffMinIsWhite) turn_white_to_one(spec, first, count, values);
}

}  // namespace tangi
