#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/image_file/painting_errors.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/tiles_reader.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kPartRowsAtOnce = 64;

PartInfo info_of(const Imf::Header& header) {
    PartInfo info;
    info.name = header.hasName() ? header.name() : "";
    const auto& window = header.dataWindow();
    info.width = window.max.x - window.min.x + 1;
    info.height = window.max.y - window.min.y + 1;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        info.channels.emplace_back(c.name()), info.half = c.channel().type == Imf::HALF;
    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            info.attributes[a.name()] = text->value();
    return info;
}

}  // namespace

std::vector<PartInfo> painting_parts(const fs::path& path) {
    if (is_tiled_painting(path)) return open_painting(path)->header().parts;
    return reading_painting(path, [&] {
        const Imf::MultiPartInputFile file(path.c_str());
        std::vector<PartInfo> parts;
        for (int part = 0; part < file.parts(); ++part)
            if (PartInfo info = info_of(file.header(part)); info.name != "dry" && info.name != "overview")
                parts.push_back(std::move(info));
        return parts;
    });
}

void read_painting_part(const fs::path& path, const PartInfo& info,
                        const std::function<void(int, int, std::span<const float* const>)>& take,
                        const Progress& progress) {
    if (is_tiled_painting(path)) return read_part_of_tiles(path, info, take, progress);
    read_painting_rows(path, info, 0, info.height, take, progress);
}

void read_painting_rows(const fs::path& path, const PartInfo& info, int first, int end_row,
                        const std::function<void(int, int, std::span<const float* const>)>& take,
                        const Progress& progress) {
    reading_painting(path, [&] {
        Imf::MultiPartInputFile file(path.c_str(), thread_count());
        int number = 0;
        while (number < file.parts() &&
               !(file.header(number).hasName() && file.header(number).name() == info.name))
            ++number;
        if (number == file.parts()) fail("{}: has no part '{}'", path.string(), info.name);
        const auto& window = file.header(number).dataWindow();
        if (window.min.x != 0 || window.min.y != 0)
            fail("{}: the data window of part '{}' does not start at 0, 0", path.string(), info.name);
        Imf::InputPart part(file, number);
        const auto band = static_cast<std::size_t>(info.width) * kPartRowsAtOnce;
        std::vector<float> values(band * info.channels.size());
        std::vector<const float*> planes;
        for (std::size_t c = 0; c < info.channels.size(); ++c) planes.push_back(values.data() + c * band);
        for (int y = first; y < end_row; y += kPartRowsAtOnce) {
            report(progress, "read paint", y / static_cast<double>(info.height));
            const int end = std::min(y + kPartRowsAtOnce, end_row);
            Imf::FrameBuffer buffer;
            const std::size_t row_bytes = static_cast<std::size_t>(info.width) * sizeof(float);
            for (std::size_t c = 0; c < info.channels.size(); ++c)  // Slices begin where row 0 would be
                buffer.insert(info.channels[c],
                              Imf::Slice::Make(Imf::FLOAT, planes[c], Imath::V2i(0, y), info.width, end - y,
                                               sizeof(float), row_bytes));
            part.setFrameBuffer(buffer);
            part.readPixels(y, end - 1);
            take(y, end, planes);
        }
        return true;
    });
}

}  // namespace tangi
