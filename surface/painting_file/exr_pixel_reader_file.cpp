#include "surface/painting_file/exr_pixel_reader.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <algorithm>

#include "surface/base/error.h"
#include "surface/image_file/painting_errors.h"

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
    std::filesystem::path path;
    PartInfo info;
    Imf::MultiPartInputFile file;
    Imf::InputPart part;
    int first = -1, end = -1;   // rows that are held
    std::vector<float> values;  // [row][column][channel]

    Impl(const std::filesystem::path& from, const PartInfo& wanted)
        : path(from), info(wanted), file(from.c_str()), part(file, number_of(file, from, wanted)) {}

    void hold(int row) {
        const std::size_t channels = info.channels.size(), pixel_bytes = channels * sizeof(float);
        values.resize(static_cast<std::size_t>(info.width) * kRows * channels);
        first = end = -1;  // should reading fail
        const int begin = row / kRows * kRows, beyond = std::min(begin + kRows, info.height);
        Imf::FrameBuffer buffer;
        for (std::size_t c = 0; c < channels; ++c)
            buffer.insert(info.channels[c],
                          Imf::Slice::Make(Imf::FLOAT, values.data() + c, Imath::V2i(0, begin), info.width,
                                           beyond - begin, pixel_bytes,
                                           static_cast<std::size_t>(info.width) * pixel_bytes));
        part.setFrameBuffer(buffer);
        part.readPixels(begin, beyond - 1);
        first = begin;
        end = beyond;
    }
};

PartPixels::PartPixels(const std::filesystem::path& painting, const PartInfo& part)
    : impl_(reading_painting(painting, [&] { return std::make_unique<Impl>(painting, part); })) {}
PartPixels::~PartPixels() = default;
PartPixels::PartPixels(PartPixels&&) noexcept = default;
PartPixels& PartPixels::operator=(PartPixels&&) noexcept = default;

const PartInfo& PartPixels::info() const { return impl_->info; }

std::span<const float> PartPixels::at(int x, int y) {
    Impl& i = *impl_;
    TP_REQUIRE(x >= 0 && y >= 0 && x < i.info.width && y < i.info.height, "a pixel of the part");
    if (y < i.first || y >= i.end) reading_painting(i.path, [&] { return i.hold(y), true; });
    const std::size_t pixel = static_cast<std::size_t>(y - i.first) * static_cast<std::size_t>(i.info.width) +
                              static_cast<std::size_t>(x);
    return std::span<const float>(i.values).subspan(pixel * i.info.channels.size(), i.info.channels.size());
}

}  // namespace tangi
