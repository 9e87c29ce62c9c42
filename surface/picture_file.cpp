#include "surface/picture_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <utility>

#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/icc_profile.h"
#include "surface/jpeg_segments.h"
#include "surface/json_text.h"
#include "surface/letter_case.h"
#include "surface/parallel.h"
#include "surface/picture_with_alpha.h"
#include "surface/png_chunks.h"
#include "surface/safe_picture.h"
#include "surface/tiff_pages.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

enum class Depth { eight, sixteen, real };

Depth depth_of(const fs::path& path, const PictureStorage& storage = {}) {
    TP_REQUIRE(storage.bits == 8 || storage.bits == 16, "integer pictures have 8 or 16 bits a sample");
    const std::string extension = lower_extension(path);
    if (extension == ".png" || extension == ".tif" || extension == ".tiff")
        return storage.bits == 8 ? Depth::eight : Depth::sixteen;
    if (extension == ".jpg" || extension == ".jpeg") return Depth::eight;
    if (extension == ".exr") return Depth::real;
    fail("{}: pictures are written as .png, .tif, .jpg or .exr", path.string());
}

std::string format_of(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension.empty() ? extension : extension.substr(1);
}

// The same input gives the same bytes: OpenImageIO would write the time at which it runs into EXR and TIFF
// files. Who wants a date there gives it, as other programs take it (reproducible-builds.org).
std::string date_of_file() {
    const char* text = std::getenv("SOURCE_DATE_EPOCH");
    char* end = nullptr;
    const long long seconds = text ? std::strtoll(text, &end, 10) : 0;
    if (!text || end == text || *end != '\0' || seconds < 0 || seconds > 253'402'300'799) return {};
    const auto time = static_cast<std::time_t>(seconds);
    std::tm utc{};
    std::array<char, 32> date{};
    if (!::gmtime_r(&time, &utc) || std::strftime(date.data(), date.size(), "%Y:%m:%d %H:%M:%S", &utc) == 0)
        return {};
    return date.data();
}

bool is_readable(const fs::path& path) {
    const auto input = OIIO::ImageInput::create(reader_name(path));
    OIIO::ImageSpec spec;
    if (!input || !input->open(path.string(), spec)) return false;
    std::vector<float> row(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
    for (int y = 0; y < spec.height; ++y)
        if (!input->read_scanline(y, 0, OIIO::TypeDesc::FLOAT, row.data()) || input->has_error())
            return false;
    return true;
}

// As OpenImageIO's writers take it; nothing where a file has no word for it.
std::string colour_space_of(const Transfer& transfer) {
    switch (transfer.kind) {
        case Transfer::Kind::linear:
            return "Linear";
        case Transfer::Kind::srgb:
            return "sRGB";
        case Transfer::Kind::gamma:
            return fmt::format("Gamma{}", transfer.gamma);
        case Transfer::Kind::curve:
            break;
    }
    return {};
}

constexpr int kStrip = 256;  // [rows] that are encoded at once: whole blocks of any format

// Numbers of the rows from `begin` on, interleaved.
using RowSource = std::function<const float*(int begin, int end)>;

void write_samples(const fs::path& path, const RowSource& rows, const Region& size, int channels, Depth depth,
                   const std::string& colour_space, int jpeg_quality = 95, bool is_srgb = false) {
    AtomicFile file(path);
    const auto output = OIIO::ImageOutput::create(format_of(path));  // a path may hold a '?'
    if (!output) fail("{}: no writer for this format: {}", path.string(), OIIO::geterror());
    OIIO::ImageSpec spec(size.width(), size.height(), channels,
                         depth == Depth::real      ? OIIO::TypeDesc::FLOAT
                         : depth == Depth::sixteen ? OIIO::TypeDesc::UINT16
                                                   : OIIO::TypeDesc::UINT8);
    // A PNG says how it is encoded once: a profile, or an sRGB chunk (ISO/IEC 15948, 11.3.3.3).
    const bool is_png = lower_extension(path) == ".png";
    const bool is_tiff = lower_extension(path).starts_with(".tif");
    if (!(is_png && is_srgb) && !colour_space.empty()) spec.attribute("oiio:ColorSpace", colour_space);
    if (is_tiff || depth == Depth::real) spec.attribute("DateTime", date_of_file());
    if (is_srgb) {
        const std::string profile = srgb_icc_profile();
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                       profile.data());
    }
    // The lower half of 16 bits is noise, in which looking for more than the nearest matches finds 1 %.
    const bool quick = depth == Depth::sixteen;
    spec.attribute("Compression", lower_extension(path).starts_with(".jp")
                                      ? fmt::format("jpeg:{}", jpeg_quality)
                                      : (quick ? "zip:1" : "zip"));
    if (quick) spec.attribute("png:compressionLevel", 1);
    // On a full disk OpenImageIO's writers notice little, and libjpeg ends the process: they write to memory.
    // All but that of TIFF, which fails there (OpenImageIO 2.4); what it wrote is read back instead.
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    if (!is_tiff) output->set_ioproxy(&memory);
    bool written = output->open(file.temporary().string(), spec);
    for (int y = 0; y < size.height() && written; y += kStrip) {
        const int end = std::min(y + kStrip, size.height());
        written = output->write_scanlines(y, end, 0, OIIO::TypeDesc::FLOAT, rows(y, end));
    }
    if (!written || !output->close())
        fail("{}: cannot be written: {}", path.string(), first_line(output->geterror()));
    if (is_tiff && !is_readable(file.temporary()))
        fail("{}: cannot be written: is the disk full?", path.string());
    if (!is_tiff) file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.commit();
}

}  // namespace

std::string lower_extension(const fs::path& path) { return lower_case(path.extension().string()); }

std::string reader_name(const fs::path& path) {
    return path.string().find('?') == std::string::npos ? path.string() : format_of(path);
}

void require_picture_format(const fs::path& path) { depth_of(path); }

void write_picture(const fs::path& path, const Image<Rgb>& linear, const Transfer& transfer,
                   const PictureStorage& storage) {
    const Depth depth = depth_of(path, storage);
    if (depth == Depth::real && transfer.kind != Transfer::Kind::linear)
        fail("{}: EXR files hold linear light; use --encoding linear, or write .png or .tif", path.string());
    Image<Rgb> strip;
    const auto encoded = [&](int begin, int end) {
        if (depth == Depth::real) return &linear(0, begin).r;
        if (strip.empty()) strip = Image<Rgb>(linear.width(), std::min(kStrip, linear.height()));
        parallel_for(begin, end, 8, [&](int first, int last) {
            for (int y = first; y < last; ++y)
                std::ranges::transform(linear.row(y), strip.row(y - begin).begin(),
                                       [&](const Rgb& pixel) { return transfer.encode(pixel); });
        });
        return &std::as_const(strip)(0, 0).r;
    };
    write_samples(path, encoded, linear.region(), 3, depth, colour_space_of(transfer), storage.jpeg_quality,
                  transfer.kind == Transfer::Kind::srgb);
}

void write_map(const fs::path& path, const Image<float>& values, const PictureStorage& storage) {
    write_samples(
        path, [&](int y, int) { return &values(0, y); }, values.region(), 1, depth_of(path, storage), {},
        storage.jpeg_quality);
}

void write_map(const fs::path& path, const Image<Rgb>& values, const PictureStorage& storage) {
    write_samples(
        path, [&](int y, int) { return &values(0, y).r; }, values.region(), 3, depth_of(path, storage), {},
        storage.jpeg_quality);
}

void write_picture_8bit(const fs::path& path, const Image<Rgb>& encoded_srgb) {
    write_samples(
        path, [&](int y, int) { return &encoded_srgb(0, y).r; }, encoded_srgb.region(), 3, Depth::eight,
        "sRGB", 95, true);
}

namespace {

// `alpha`: where to put it; its channel is not read where that is null.
Image<Rgb> read_as_stored(const fs::path& path, Image<float>* alpha) {
    if (!is_whole_png(path))
        fail("{}: cannot be read: the PNG file is cut off, or damaged; copy it again", path.string());
    const SafePicture safe(path);
    OIIO::ImageSpec as_stored;
    as_stored.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::create(safe.reader());
    OIIO::ImageSpec spec;
    if (!input || !input->open(safe.path(), spec, as_stored))
        fail("{}: cannot be read: {}", path.string(),
             trouble_with_picture(input ? input->geterror() : OIIO::geterror()));
    const auto pages = tiff_pages(path);
    const int page = pages ? static_cast<int>(pages->chosen) : 0;
    if (page > 0 && input->seek_subimage(page, 0)) spec = input->spec();
    if (!is_whole_jpeg(path))
        fail("{}: cannot be read: the JPEG file is cut off, or damaged; copy it again", path.string());
    const bool wants_alpha = alpha && spec.alpha_channel >= 0;
    const int channels = wants_alpha ? spec.nchannels : std::min(spec.nchannels, 3);
    std::vector<float> values(static_cast<std::size_t>(spec.width) * spec.height * channels);
    // Strips of a TIFF file that cannot be read show only in has_error() (OpenImageIO 2.4).
    if (!input->read_image(page, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data()) || input->has_error())
        fail("{}: cannot be read: {}", path.string(), trouble_with_pixels(input->geterror()));
    const bool coloured = spec.nchannels >= 3,
               multiplied = spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    Image<Rgb> image(spec.width, spec.height);
    if (wants_alpha) *alpha = Image<float>(spec.width, spec.height);
    for (std::size_t i = 0; i < image.size(); ++i) {
        const float* v = &values[i * static_cast<std::size_t>(channels)];
        image.pixels()[i] = coloured ? Rgb(v[0], v[1], v[2]) : Rgb(v[0]);
        if (!wants_alpha) continue;
        const float part = v[spec.alpha_channel];
        alpha->pixels()[i] = part;
        if (multiplied && part > 0) image.pixels()[i] /= part;
    }
    return image;
}

}  // namespace

Image<Rgb> read_picture(const fs::path& path) { return read_as_stored(path, nullptr); }

PictureWithAlpha read_picture_with_alpha(const fs::path& path) {
    PictureWithAlpha picture;
    picture.colour = read_as_stored(path, &picture.alpha);
    return picture;
}

}  // namespace tangi
