#include "surface/painting_file/painting_file.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fcntl.h>
#include <half.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/file/version.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/dry_part.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/surface_channels.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kRowsOfBlock = 16;  // of ZIP_COMPRESSION, by the format

// Of rows of which the first is row `top` of the painting.
Imf::FrameBuffer frame_buffer(const Surface& s, int top) {
    Imf::FrameBuffer buffer;
    for (const DryChannel& c : channels_of(const_cast<Surface&>(s))) {  // OpenEXR only reads it
        const std::size_t x_bytes = c.stride * sizeof(float);
        buffer.insert(c.name, Imf::Slice::Make(Imf::FLOAT, c.base, Imath::V2i(0, top), s.width(), s.height(),
                                               x_bytes, x_bytes * static_cast<std::size_t>(s.width())));
    }
    return buffer;
}

// OpenEXR swallows what goes wrong while a file is closed. This stream remembers it, so that a disk that
// fills up with the very last bytes is not taken for success.
class CheckedStream : public Imf::OStream {
public:
    CheckedStream(const fs::path& path, bool has_parts)
        : Imf::OStream(path.c_str()),
          has_parts_(has_parts),
          file_(::open(path.c_str(), O_RDWR | O_TRUNC | O_CLOEXEC)) {
        if (file_ < 0) throw std::runtime_error(std::strerror(errno));
    }
    ~CheckedStream() override { ::close(file_); }
    CheckedStream(const CheckedStream&) = delete;
    CheckedStream& operator=(const CheckedStream&) = delete;

    void write(const char bytes[], int count) override {
        while (count > 0) {
            const ssize_t written = ::write(file_, bytes, static_cast<std::size_t>(count));
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) {
                failure_ = std::strerror(written == 0 ? ENOSPC : errno);
                throw std::runtime_error(failure_);
            }
            bytes += written;
            count -= static_cast<int>(written);
        }
    }
    std::uint64_t tellp() override { return static_cast<std::uint64_t>(::lseek(file_, 0, SEEK_CUR)); }
    void seekp(std::uint64_t position) override { ::lseek(file_, static_cast<off_t>(position), SEEK_SET); }
    const std::string& failure() const { return failure_; }

    // How many blocks of rows lie from `at` to where the file is written now. Each is the number of its part,
    // where there are several, that of its first row, and its length, of four bytes each, the lowest first;
    // and the packed pixels.
    int blocks_since(std::uint64_t at) {
        int blocks = 0;
        for (std::array<std::uint8_t, 4> bytes{}; at < tellp(); ++blocks) {
            at += has_parts_ ? 8 : 4;
            if (::pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(at)) != ssize_t{bytes.size()})
                throw std::runtime_error(std::strerror(errno));
            std::uint64_t length = 0;
            for (int i = 3; i >= 0; --i) length = length << 8 | bytes[static_cast<std::size_t>(i)];
            at += bytes.size() + length;
        }
        return blocks;
    }

private:
    const bool has_parts_;
    int file_;
    std::string failure_;
};

// Names of photographs come from file systems, where any bytes are allowed.
std::string utf8_of(const nlohmann::json& value) { return json_line(value); }

Imf::Header header_of(const PaintingHeader& s) {
    Imf::Header header(s.width, s.height);
    header.setName(kDryPart);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    Surface names = blank_surface(s, 1, 1);
    for (const DryChannel& c : channels_of(names)) header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
    header.insert("mm_per_pixel", Imf::FloatAttribute(static_cast<float>(s.mm_per_pixel)));
    for (const auto& [name, value] : {std::pair("diffuse_roughness", s.reflectance_model.diffuse_roughness),
                                      {"second_lobe_weight", s.reflectance_model.second_lobe_weight}})
        if (value != 0) header.insert(name, Imf::DoubleAttribute(value));
    header.insert("software", Imf::StringAttribute(program_name()));
    header.insert("format_version", Imf::IntAttribute(kPaintingFormatVersion));
    header.insert("scale_known", Imf::IntAttribute(s.scale_known ? 1 : 0));
    header.insert("photography", Imf::StringAttribute(utf8_of(to_json(s.photography))));
    header.insert("provenance", Imf::StringAttribute(s.provenance));
    header.insert("dry_hash", Imf::StringAttribute(s.dry_hash));
    return header;
}

Imf::Header header_of(const PartInfo& info) {
    Imf::Header header(info.width, info.height);
    header.setName(info.name);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const std::string& channel : info.channels)
        header.channels().insert(channel, Imf::Channel(info.half ? Imf::HALF : Imf::FLOAT));
    for (const auto& [name, text] : info.attributes) header.insert(name, Imf::StringAttribute(text));
    return header;
}

// Writes the next rows of a part: whole blocks, and no more of them than kRowsAtOnce holds. Where there was
// no memory to pack one, OpenEXR (3.1) may leave it out without a word, and the next block that goes through
// the same buffer runs over its end. So none does before all of these are seen in the file.
void write_rows(CheckedStream& stream, Imf::OutputPart& part, int rows) {
    TP_REQUIRE(rows <= kRowsAtOnce, "each buffer takes one block");
    const std::uint64_t before = stream.tellp();
    part.writePixels(rows);
    if (stream.blocks_since(before) != (rows + kRowsOfBlock - 1) / kRowsOfBlock) throw std::bad_alloc();
}

void write_part(CheckedStream& stream, Imf::MultiPartOutputFile& output, int number, const PartToWrite& part,
                const Progress& progress) {
    constexpr int rows_at_once = 4 * kRowsOfBlock;
    Imf::OutputPart target(output, number);
    const PartInfo& info = part.info;
    const auto band = static_cast<std::size_t>(info.width) * rows_at_once;
    std::vector<float> values(band * info.channels.size());
    std::vector<half> halves(info.half ? values.size() : 0);
    std::vector<float*> planes;
    for (std::size_t c = 0; c < info.channels.size(); ++c) planes.push_back(values.data() + c * band);
    for (int y = 0; y < info.height; y += rows_at_once) {
        report(progress, "write paint", y / static_cast<double>(info.height));
        const int end = std::min(y + rows_at_once, info.height);
        std::fill(values.begin(), values.end(), 0.0f);
        part.fill(y, end, planes);
        if (info.half)
            std::transform(values.begin(), values.end(), halves.begin(), [](float v) { return half(v); });
        Imf::FrameBuffer buffer;
        const std::size_t size = info.half ? sizeof(half) : sizeof(float);
        for (std::size_t c = 0; c < planes.size(); ++c) {
            const void* plane = planes[c];
            if (info.half) plane = &halves[c * band];
            buffer.insert(info.channels[c], Imf::Slice::Make(info.half ? Imf::HALF : Imf::FLOAT, plane,
                                                             Imath::V2i(0, y), info.width, end - y, size,
                                                             static_cast<std::size_t>(info.width) * size));
        }
        target.setFrameBuffer(buffer);
        write_rows(stream, target, end - y);
    }
}

}  // namespace

void write_painting(AtomicFile& file, const Surface& s, const Progress& progress) {
    std::vector<PartToWrite> parts;
    add_overview(parts, s, s);
    write_painting(file, s, parts, progress);
}

void write_painting(AtomicFile& file, const Surface& s, std::span<const PartToWrite> parts,
                    const Progress& progress) {
    fill_painting(file, s, parts, progress);
    file.commit();
}

void fill_painting(const AtomicFile& file, const Surface& s, std::span<const PartToWrite> parts,
                   const Progress& progress) {
    require_consistent(s);
    TP_REQUIRE(s.width() > 0 && s.height() > 0, "a painting has pixels");
    if (const std::string wrong = first_wrong(s); !wrong.empty())
        throw ContractError(fmt::format("{}: is not written, since it could not be read again: {}",
                                        file.target().string(), wrong));
    PaintingHeader header = header_of(s);
    header.dry_hash = hash_of(s);
    fill_painting(
        file, header,
        [&](int, int) {
            return DryRows{&s, 0};
        },
        parts, progress);
}

void fill_painting(const AtomicFile& file, const PaintingHeader& header,
                   const std::function<DryRows(int y0, int y1)>& rows, std::span<const PartToWrite> parts,
                   const Progress& progress) {
    const std::string target = file.target().string();
    std::string failure;
    let_openexr_use_threads();
    try {
        CheckedStream stream(file.temporary(), !parts.empty());
        try {
            std::vector<Imf::Header> headers = {header_of(header)};
            for (const PartToWrite& further : parts) {
                headers.push_back(header_of(further.info));
                // OpenEXR wants it to be the same for all parts, of whatever size.
                headers.back().displayWindow() = headers.front().displayWindow();
            }
            constexpr int threads = kRowsAtOnce / kRowsOfBlock / 2;  // which have two buffers each
            Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()), false,
                                            threads);
            Imf::OutputPart part(output, 0);
            for (int y = 0; y < header.height; y += kRowsAtOnce) {
                report(progress, "write painting", y / static_cast<double>(header.height));
                const int end = std::min(y + kRowsAtOnce, header.height);
                const DryRows band = rows(y, end);
                part.setFrameBuffer(frame_buffer(*band.surface, band.top));
                write_rows(stream, part, end - y);
            }
            for (std::size_t i = 0; i < parts.size(); ++i)
                write_part(stream, output, static_cast<int>(i) + 1, parts[i], progress);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error&) {  // of who makes the rows
            throw;
        } catch (const std::exception& error) {
            failure = says_no_memory(error) ? kNoMemory : error.what();
        }
        if (!stream.failure().empty()) failure = stream.failure();
    } catch (const Cancelled&) {
        throw;
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        failure = says_no_memory(error) ? kNoMemory : error.what();
    }
    if (!failure.empty()) fail("{}: cannot be written: {}", target, failure);
    report(progress, "write painting", 1);  // the last chance to stop: what is in place is not taken back
}

void write_painting(const fs::path& path, const Surface& s, const Progress& progress) {
    AtomicFile file(path);
    write_painting(file, s, progress);
}

}  // namespace tangi
