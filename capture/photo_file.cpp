#include "capture/photo_file.h"

#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "capture/left_out.h"
#include "capture/raw_file.h"
#include "surface/error.h"
#include "surface/picture_file.h"
#include "surface/png_chunks.h"
#include "surface/safe_picture.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Where the compressed picture starts: at the first start-of-scan marker, behind segments of which one may
// hold a thumbnail with an end of its own (ITU-T T.81, B.1.1.4). 0 where that cannot be told.
std::streamoff scan_start(std::ifstream& stream) {
    for (std::streamoff at = 2;;) {
        unsigned char marker[4] = {};
        stream.seekg(at);
        if (!stream.read(reinterpret_cast<char*>(marker), sizeof marker) || marker[0] != 0xFF) {
            stream.clear();
            return 0;
        }
        if (marker[1] == 0xDA) return at;
        at += marker[1] == 0xFF ? 1 : 2 + 256 * marker[2] + marker[3];
    }
}

// What a file holds from `begin` on, or in its last 64 KiB where that is less. Empty where it can't be read.
std::string tail_of(std::ifstream& stream, const fs::path& path, std::streamoff begin) {
    const std::streamoff size = static_cast<std::streamoff>(fs::file_size(path));
    constexpr std::streamoff window = 65536;
    begin = std::max(begin, size - window);
    std::string tail(static_cast<std::size_t>(size - begin), '\0');
    stream.seekg(begin);
    stream.read(tail.data(), static_cast<std::streamsize>(tail.size()));
    return stream ? tail : std::string();
}

// A JPEG decoder fills what is missing of a truncated file with grey and goes on. Such a file lacks the
// end-of-image marker (ITU-T T.81, table B.1), which may only be followed by padding.
void require_complete_jpeg(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    const std::streamoff begin = scan_start(stream);
    if (tail_of(stream, path, begin).find("\xFF\xD9") == std::string::npos)
        fail_photo(path, "the JPEG file is truncated; copy it again from the camera or the archive");
}

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
    std::vector<char> stored;      // scratch for rows as stored
    std::vector<float> tile_rows;  // scratch for tiled files
    std::string demosaic;
    std::vector<std::uint16_t> raw;  // a developed camera raw, while its rows are read
};

bool is_photo_name(const fs::path& path) {
    static constexpr std::array<std::string_view, 7> known = {".jpg",  ".jpeg", ".png", ".tif",
                                                              ".tiff", ".exr",  ".tga"};
    return std::find(known.begin(), known.end(), lower_extension(path)) != known.end() || is_raw_name(path);
}

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
    OIIO::ImageSpec config, spec;
    config.attribute("oiio:UnassociatedAlpha", 1);
    decoder_->safe = safe_photo(path_);
    decoder_->input = OIIO::ImageInput::create(decoder_->safe->reader());
    if (!decoder_->input)
        fail_photo(path_, "is not a picture that can be read: {}", trouble_with_picture(OIIO::geterror()));
    if (!decoder_->input->open(decoder_->safe->path(), spec, config))
        fail_photo(path_, "is not a picture that can be read: {}",
                   trouble_with_picture(decoder_->input->geterror()));
    if (spec.nchannels < 1 || spec.width < 1 || spec.height < 1) fail_photo(path_, "holds no pixels");
    const std::string extension = lower_extension(path_);
    if (extension == ".jpg" || extension == ".jpeg") require_complete_jpeg(path_);
    header_ = {.width = spec.width,
               .height = spec.height,
               .channels = spec.nchannels >= 3 ? 3 : 1,
               .bits = spec.format.is_floating_point() ? 32 : static_cast<int>(spec.format.basesize()) * 8,
               .is_float = spec.format.is_floating_point(),
               .orientation = spec.get_int_attribute("Orientation", 1)};
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
    if (header_.is_raw) return read_raw_rows(y0, y1, values);
    OIIO::ImageInput& input = *decoder_->input;
    const OIIO::ImageSpec& spec = input.spec();
    bool read = false;
    if (spec.tile_width == 0 && spec.channelformats.empty()) {
        // As stored, and converted here: OpenImageIO 2.4 would take 64 MiB for each call to convert it.
        decoder_->stored.resize(spec.scanline_bytes(true) * static_cast<std::size_t>(y1 - y0));
        read =
            input.read_scanlines(0, 0, spec.y + y0, spec.y + y1, 0, 0, header_.channels,
                                 OIIO::TypeDesc::UNKNOWN, decoder_->stored.data()) &&
            to_floats(spec.format, decoder_->stored, values.first(row * static_cast<std::size_t>(y1 - y0)));
    } else if (spec.tile_width == 0) {
        read = input.read_scanlines(0, 0, spec.y + y0, spec.y + y1, 0, 0, header_.channels,
                                    OIIO::TypeDesc::FLOAT, values.data());
    } else {
        // Whole tiles only: read the rows of tiles that hold the wanted rows, then copy those out.
        const int th = spec.tile_height;
        const int t0 = y0 / th * th, t1 = std::min((y1 + th - 1) / th * th, header_.height);
        decoder_->tile_rows.resize(row * static_cast<std::size_t>(t1 - t0));
        read = input.read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + t0, spec.y + t1, 0, 1, 0,
                                header_.channels, OIIO::TypeDesc::FLOAT, decoder_->tile_rows.data());
        const auto from = decoder_->tile_rows.begin() + static_cast<std::ptrdiff_t>(row) * (y0 - t0);
        std::copy_n(from, row * static_cast<std::size_t>(y1 - y0), values.begin());
    }
    if (!read ||
        input.has_error())  // strips of a TIFF file that cannot be read show only there (OpenImageIO 2.4)
        fail_photo(path_, "cannot be decoded at rows {} to {}: {}", y0, y1 - 1,
                   trouble_with_picture(input.geterror()));
}

}  // namespace tangi
