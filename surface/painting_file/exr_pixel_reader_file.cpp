#include "surface/painting_file/exr_pixel_reader.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <algorithm>

#include "surface/base/error.h"
#include "surface/image_file/painting_errors.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace {

constexpr int kRows = 16;  // that ZIP packs together

int number_of(const Imf::MultiPartInputFile& file, const std::filesystem::path& path, const PartInfo& info) {
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::Header& header = file.header(part);
        if (!header.hasName() || header.name() != info.name) continue;
        const auto& window = header.dataWindow();
        if (window.min.x != 0 || window.min.y != 0 || window.max.x + 1 != info.width ||
            window.max.y + 1 != info.height)
            fail("{}: part '{}' has another size than it had", path.string(), info.name);
        return part;
    }
    fail("{}: has no part '{}'", path.string(), info.name);
}

}  // namespace

struct PartPixels::Impl {
    PartInfo info;
    explicit Impl(PartInfo wanted) : info(std::move(wanted)) {}
    virtual ~Impl() = default;
    virtual std::span<const float> at(int x, int y) = 0;
};

namespace {

// Of a file, which is held open; rows that are packed together are kept.
class FilePixels : public PartPixels::Impl {
public:
    FilePixels(const std::filesystem::path& from, const PartInfo& wanted)
        : Impl(wanted), path_(from), file_(from.c_str()), part_(file_, number_of(file_, from, wanted)) {}

    std::span<const float> at(int x, int y) override {
        if (y < first_ || y >= end_) reading_painting(path_, [&] { return hold(y), true; });
        const std::size_t pixel =
            static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(info.width) +
            static_cast<std::size_t>(x);
        return std::span<const float>(values_).subspan(pixel * info.channels.size(), info.channels.size());
    }

private:
    void hold(int row) {
        const std::size_t channels = info.channels.size(), pixel_bytes = channels * sizeof(float);
        values_.resize(static_cast<std::size_t>(info.width) * kRows * channels);
        first_ = end_ = -1;  // should reading fail
        const int begin = row / kRows * kRows, beyond = std::min(begin + kRows, info.height);
        Imf::FrameBuffer buffer;
        for (std::size_t c = 0; c < channels; ++c)
            buffer.insert(info.channels[c],
                          Imf::Slice::Make(Imf::FLOAT, values_.data() + c, Imath::V2i(0, begin), info.width,
                                           beyond - begin, pixel_bytes,
                                           static_cast<std::size_t>(info.width) * pixel_bytes));
        part_.setFrameBuffer(buffer);
        part_.readPixels(begin, beyond - 1);
        first_ = begin;
        end_ = beyond;
    }

    std::filesystem::path path_;
    Imf::MultiPartInputFile file_;
    Imf::InputPart part_;
    int first_ = -1, end_ = -1;  // rows that are held
    std::vector<float> values_;  // [row][column][channel]
};

// Of a folder of tiles, one of which is kept.
class TilePixels : public PartPixels::Impl {
public:
    TilePixels(const std::filesystem::path& folder, const PartInfo& wanted)
        : Impl(wanted), reader_(open_painting(folder)), grid_(wanted.width, wanted.height) {}

    std::span<const float> at(int x, int y) override {
        if (x < held_.x0 || y < held_.y0 || x >= held_.x1 || y >= held_.y1) {
            held_ = {};
            const Region tile = grid_.region({0, x / kPaintingTile, y / kPaintingTile});
            planes_ = reader_->read_part(info, tile);
            held_ = tile;
        }
        pixel_.clear();
        for (const Image<float>& plane : planes_) pixel_.push_back(plane(x - held_.x0, y - held_.y0));
        return pixel_;
    }

private:
    std::shared_ptr<const PaintingReader> reader_;
    TileGrid grid_;
    Region held_{};
    std::vector<Image<float>> planes_;
    std::vector<float> pixel_;
};

}  // namespace

PartPixels::PartPixels(const std::filesystem::path& painting, const PartInfo& part)
    : impl_(reading_painting(painting, [&]() -> std::unique_ptr<Impl> {
          if (is_tiled_painting(painting)) return std::make_unique<TilePixels>(painting, part);
          return std::make_unique<FilePixels>(painting, part);
      })) {}
PartPixels::~PartPixels() = default;
PartPixels::PartPixels(PartPixels&&) noexcept = default;
PartPixels& PartPixels::operator=(PartPixels&&) noexcept = default;

const PartInfo& PartPixels::info() const { return impl_->info; }

std::span<const float> PartPixels::at(int x, int y) {
    TP_REQUIRE(x >= 0 && y >= 0 && x < impl_->info.width && y < impl_->info.height, "a pixel of the part");
    return impl_->at(x, y);
}

}  // namespace tangi
