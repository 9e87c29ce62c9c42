#include "surface/image_file/image_io.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/words.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/image_alpha.h"
#include "surface/image_file/picture_rows.h"
#include "surface/image_file/sample_writer.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

SampleDepth depth_of(const fs::path& path, const PictureStorage& storage = {}) {
    TP_REQUIRE(storage.bits == 8 || storage.bits == 16, "integer pictures have 8 or 16 bits a sample");
    const std::string extension = lower_extension(path);
    if (extension == ".png" || extension == ".tif" || extension == ".tiff")
        return storage.bits == 8 ? SampleDepth::eight : SampleDepth::sixteen;
    if (extension == ".jpg" || extension == ".jpeg") return SampleDepth::eight;
    if (extension == ".exr") return SampleDepth::real;
    fail("{}: pictures are written as .png, .tif, .jpg or .exr", path.string());
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

void write_samples(const fs::path& path, const RowSource& rows, const Region& size,
                   const SampleStorage& storage) {
    SampleWriter writer(path, size.width(), size.height(), storage);
    for (int y = 0; y < size.height(); y += kStrip) {
        const int end = std::min(y + kStrip, size.height());
        writer.write(y, end, rows(y, end));
    }
    writer.commit();
}

SampleStorage storage_of(const fs::path& path, const Transfer& transfer, const PictureStorage& storage) {
    const SampleDepth depth = depth_of(path, storage);
    if (depth == SampleDepth::real && transfer.kind != Transfer::Kind::linear)
        fail("{}: EXR files hold linear light; use --encoding linear, or write .png or .tif", path.string());
    return {3,
            depth,
            colour_space_of(transfer),
            storage.jpeg_quality,
            transfer.kind == Transfer::Kind::srgb,
            storage.notes};
}

}  // namespace

std::string lower_extension(const fs::path& path) { return lower_case(path.extension().string()); }

void require_picture_format(const fs::path& path) { depth_of(path); }

struct PictureWriter::Impl {
    Transfer transfer;
    bool encodes;
    int height, row = 0;
    SampleWriter writer;
    Image<Rgb> strip{};
};

PictureWriter::PictureWriter(const fs::path& path, int width, int height, const Transfer& transfer,
                             const PictureStorage& storage) {
    const SampleStorage samples = storage_of(path, transfer, storage);
    impl_.reset(new Impl{transfer, samples.depth != SampleDepth::real, height, 0,
                         SampleWriter(path, width, height, samples)});
}
PictureWriter::~PictureWriter() = default;
PictureWriter::PictureWriter(PictureWriter&&) noexcept = default;

void PictureWriter::write(const Image<Rgb>& linear) {
    Impl& i = *impl_;
    TP_REQUIRE(i.row + linear.height() <= i.height, "as many rows as the picture has");
    if (i.encodes && i.strip.width() != linear.width()) i.strip = Image<Rgb>(linear.width(), kStrip);
    for (int y = 0; y < linear.height();) {
        const int rows = std::min(kStrip - i.row % kStrip, linear.height() - y);
        if (i.encodes)
            parallel_for(0, rows, 8, [&](int first, int last) {
                for (int r = first; r < last; ++r)
                    std::ranges::transform(linear.row(y + r), i.strip.row(r).begin(),
                                           [&](const Rgb& pixel) { return i.transfer.encode(pixel); });
            });
        i.writer.write(i.row, i.row + rows, i.encodes ? &i.strip(0, 0).r : &linear(0, y).r);
        i.row += rows;
        y += rows;
    }
}

void PictureWriter::commit() {
    TP_REQUIRE(impl_->row == impl_->height, "all rows are written");
    impl_->writer.commit();
}

void write_picture(const fs::path& path, const Image<Rgb>& linear, const Transfer& transfer,
                   const PictureStorage& storage) {
    PictureWriter writer(path, linear.width(), linear.height(), transfer, storage);
    writer.write(linear);
    writer.commit();
}

void write_map(const fs::path& path, const Image<float>& values, const PictureStorage& storage) {
    write_samples(path, [&](int y, int) { return &values(0, y); }, values.region(),
                  {1, depth_of(path, storage), {}, storage.jpeg_quality, false, storage.notes});
}

void write_map(const fs::path& path, const Image<Rgb>& values, const PictureStorage& storage) {
    write_samples(path, [&](int y, int) { return &values(0, y).r; }, values.region(),
                  {3, depth_of(path, storage), {}, storage.jpeg_quality, false, storage.notes});
}

void write_picture_8bit(const fs::path& path, const Image<Rgb>& encoded_srgb, const PictureStorage& storage) {
    write_samples(path, [&](int y, int) { return &encoded_srgb(0, y).r; }, encoded_srgb.region(),
                  {3, SampleDepth::eight, "sRGB", storage.jpeg_quality, true, storage.notes});
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
