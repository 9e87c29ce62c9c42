#include "surface/image_file/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <optional>
#include <utility>

#include "surface/base/case_insensitive.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/base/parallel.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/file_bytes.h"
#include "surface/file/memory_file.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/icc_profile.h"
#include "surface/image_file/image_alpha.h"
#include "surface/image_file/picture_rows.h"

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

bool is_readable(const std::string& format, const std::string& path) {
    const auto input = OIIO::ImageInput::create(format);
    OIIO::ImageSpec spec;
    if (!input || !input->open(path, spec)) return false;
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

// How samples are stored.
struct SampleStorage {
    int channels;
    Depth depth;
    std::string colour_space;
    int jpeg_quality = 95;
    bool is_srgb = false;
};

OIIO::ImageSpec spec_to_write(const std::string& extension, const Region& size,
                              const SampleStorage& storage) {
    const auto& [channels, depth, colour_space, jpeg_quality, is_srgb] = storage;
    OIIO::ImageSpec spec(size.width(), size.height(), channels,
                         depth == Depth::real      ? OIIO::TypeDesc::FLOAT
                         : depth == Depth::sixteen ? OIIO::TypeDesc::UINT16
                                                   : OIIO::TypeDesc::UINT8);
    // A PNG says how it is encoded once: a profile, or an sRGB chunk (ISO/IEC 15948, 11.3.3.3).
    const bool says_it_otherwise = extension == ".png" && is_srgb;
    if (!says_it_otherwise && !colour_space.empty()) spec.attribute("oiio:ColorSpace", colour_space);
    if (extension.starts_with(".tif") || depth == Depth::real) spec.attribute("DateTime", date_of_file());
    if (is_srgb) {
        const std::string profile = srgb_icc_profile();
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                       profile.data());
    }
    // The lower half of 16 bits is noise, in which looking for more than the nearest matches finds 1 %.
    const bool quick = depth == Depth::sixteen;
    spec.attribute("Compression", extension.starts_with(".jp") ? fmt::format("jpeg:{}", jpeg_quality)
                                                               : (quick ? "zip:1" : "zip"));
    if (quick) spec.attribute("png:compressionLevel", 1);
    return spec;
}

void write_samples(const fs::path& path, const RowSource& rows, const Region& size,
                   const SampleStorage& storage) {
    AtomicFile file(path);
    const std::string extension = lower_extension(path);
    const bool is_tiff = extension.starts_with(".tif");
    const auto output = OIIO::ImageOutput::create(format_of(path));  // a path may hold a '?'
    if (!output) fail("{}: no writer for this format: {}", path.string(), OIIO::geterror());
    const OIIO::ImageSpec spec = spec_to_write(extension, size, storage);
    // On a full disk OpenImageIO's writers notice little, and libjpeg ends the process: they write to memory.
    // That of TIFF cannot (OpenImageIO 2.4), and gets a file that is memory; what it wrote is read back.
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    std::optional<MemoryFile> memory_file;
    if (is_tiff) memory_file.emplace();
    if (!is_tiff) output->set_ioproxy(&memory);
    bool written = output->open(is_tiff ? memory_file->path() : file.temporary().string(), spec);
    for (int y = 0; y < size.height() && written; y += kStrip) {
        const int end = std::min(y + kStrip, size.height());
        written = output->write_scanlines(y, end, 0, OIIO::TypeDesc::FLOAT, rows(y, end));
    }
    written = written && output->close();
    if (is_tiff && !(written && is_readable("tiff", memory_file->path())))
        fail("{}: cannot be written: {}", path.string(), memory_file->refusal());
    if (!written) {
        const std::string why = output->geterror();
        fail("{}: cannot be written: {}", path.string(), says_no_memory(why) ? kNoMemory : first_line(why));
    }
    file.write(is_tiff ? memory_file->bytes()
                       : std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    // OpenEXR (3.1) may leave out rows without a word where there was no memory to pack them.
    if (extension == ".exr" && !is_readable("openexr", file.temporary().string())) {
        told_of(file.temporary(), path, [&] { require_readable(file.temporary()); });  // or the disk fails
        fail("{}: cannot be written: {}", path.string(), kNoMemory);
    }
    file.commit();
}

}  // namespace

std::string lower_extension(const fs::path& path) { return lower_case(path.extension().string()); }

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
    write_samples(
        path, encoded, linear.region(),
        {3, depth, colour_space_of(transfer), storage.jpeg_quality, transfer.kind == Transfer::Kind::srgb});
}

void write_map(const fs::path& path, const Image<float>& values, const PictureStorage& storage) {
    write_samples(path, [&](int y, int) { return &values(0, y); }, values.region(),
                  {1, depth_of(path, storage), {}, storage.jpeg_quality});
}

void write_map(const fs::path& path, const Image<Rgb>& values, const PictureStorage& storage) {
    write_samples(path, [&](int y, int) { return &values(0, y).r; }, values.region(),
                  {3, depth_of(path, storage), {}, storage.jpeg_quality});
}

void write_picture_8bit(const fs::path& path, const Image<Rgb>& encoded_srgb) {
    write_samples(path, [&](int y, int) { return &encoded_srgb(0, y).r; }, encoded_srgb.region(),
                  {3, Depth::eight, "sRGB", 95, true});
}

namespace {

// What has bands beside red, green, blue and one more may have these anywhere.
void require_colours(const fs::path& path, const PictureContent& content) {
    constexpr std::size_t most = 4;
    const std::vector<std::string>& names = content.channels;
    const bool begins_with_colours = content.is_exr && names.size() >= 3 && lower_case(names[0]) == "r" &&
                                     lower_case(names[1]) == "g" && lower_case(names[2]) == "b";
    if (names.size() > most && !begins_with_colours)
        fail(
            "{}: has {} channels, and nothing says which are red, green and blue; store these, or one grey "
            "channel",
            path.string(), names.size());
}

// `alpha`: where to put it; its channel is not read where that is null.
Image<Rgb> read_as_stored(const fs::path& path, Image<float>* alpha) {
    PictureRows rows(path);
    const PictureContent& content = rows.content();
    require_colours(path, content);
    const auto count = static_cast<int>(content.channels.size());
    // Of what an EXR file's data window leaves out nothing is known but that it was not drawn: transparent.
    const bool wants_alpha = alpha && (content.alpha >= 0 || !content.is_complete());
    const int channels = wants_alpha && content.alpha >= 0 ? count : std::min(count, 3);
    const double pixels = static_cast<double>(content.width) * content.height;
    require_memory(path, pixels * static_cast<double>(sizeof(Rgb) + (wants_alpha ? sizeof(float) : 0)),
                   fmt::format("its picture of {} x {} pixels", content.width, content.height));
    Image<Rgb> image(content.width, content.height);
    if (wants_alpha) *alpha = Image<float>(content.width, content.height);
    std::vector<float> strip(static_cast<std::size_t>(content.width) *
                             static_cast<std::size_t>(kStrip * channels));
    for (int y0 = 0; y0 < content.height; y0 += kStrip) {
        const int y1 = std::min(y0 + kStrip, content.height);
        rows.read(y0, y1, 0, channels, strip);
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < content.width; ++x) {
                const std::size_t pixel =
                    static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(content.width) +
                    static_cast<std::size_t>(x);
                if (!content.has(x, y)) continue;  // black, and transparent
                const float* v = &strip[pixel * static_cast<std::size_t>(channels)];
                image(x, y) = count >= 3 ? Rgb(v[0], v[1], v[2]) : Rgb(v[0]);
                if (!wants_alpha) continue;
                const float part = content.alpha >= 0 ? v[content.alpha] : 1;
                (*alpha)(x, y) = part;
                if (content.alpha >= 0 && content.multiplied && part > 0) image(x, y) /= part;
            }
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
