#include "surface/painting_file/painting_file.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fcntl.h>
#include <half.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <span>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/base/parallel.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/exr_header_check.h"
#include "surface/image_file/painting_errors.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/exr_attribute.h"
#include "surface/painting_file/exr_parallel_reader.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/surface_channels.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDry = "dry";
constexpr int kRowsOfBlock = 16;  // of ZIP_COMPRESSION, by the format
constexpr int kRowsAtOnce = 256;

Imf::FrameBuffer frame_buffer(Surface& s) {
    Imf::FrameBuffer buffer;
    for (const DryChannel& c : channels_of(s)) {
        const std::size_t x_bytes = c.stride * sizeof(float);
        buffer.insert(c.name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(c.base), x_bytes,
                                         x_bytes * static_cast<std::size_t>(s.width())));
    }
    return buffer;
}

// OpenEXR packs and unpacks in threads that it keeps, and has none before it is told.
void let_openexr_use_threads() {
    if (const int threads = thread_count(); Imf::globalThreadCount() != threads)
        Imf::setGlobalThreadCount(threads);
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

Imf::Header header_of(const Surface& s) {
    Imf::Header header(s.width(), s.height());
    header.setName(kDry);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const DryChannel& c : channels_of(const_cast<Surface&>(s)))  // only the names are read
        header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
    header.insert("mm_per_pixel", Imf::FloatAttribute(static_cast<float>(s.mm_per_pixel)));
    for (const auto& [name, value] : {std::pair("diffuse_roughness", s.reflectance_model.diffuse_roughness),
                                      {"second_lobe_weight", s.reflectance_model.second_lobe_weight}})
        if (value != 0) header.insert(name, Imf::DoubleAttribute(value));
    header.insert("scale_known", Imf::IntAttribute(s.scale_known ? 1 : 0));
    header.insert("photography", Imf::StringAttribute(utf8_of(to_json(s.photography))));
    header.insert("provenance", Imf::StringAttribute(s.provenance));
    header.insert("dry_hash", Imf::StringAttribute(hash_of(s)));
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

int find_part(const Imf::MultiPartInputFile& file, const std::string& name) {
    for (int part = 0; part < file.parts(); ++part)
        if (file.header(part).hasName() && file.header(part).name() == name) return part;
    return -1;
}

// The maps that `names` has, as the file has them; their hash, and what cannot be relit, looked at while rows
// are at hand.
struct Maps {
    Surface surface;
    std::vector<std::uint64_t> hashes;  // of rows, as they were
    std::vector<std::string> wrong;     // the first of each row
};

// Where the dry layer is in a file, and which maps it has.
struct DryPart {
    int number = 0, width = 0, height = 0;
    Surface names{1, 1};  // its maps are those of the part
};

Maps read_maps(const fs::path& path, Imf::MultiPartInputFile& file, const DryPart& dry,
               const Progress& progress) {
    const int width = dry.width, height = dry.height;
    const auto rows = static_cast<std::size_t>(height);
    Maps maps{Surface(width, height), std::vector<std::uint64_t>(rows), std::vector<std::string>(rows)};
    if (!dry.names.specular_colour.empty()) maps.surface.specular_colour = Image<Rgb>(width, height);
    if (!dry.names.lobe_axes.empty()) maps.surface.lobe_axes = Image<LobeAxes>(width, height);
    const auto channels = channels_of(maps.surface);
    const auto look_at = [&](int y0, int y1) {
        hash_rows(channels, width, y0, y1, maps.hashes);
        make_usable(maps.surface, y0, y1, maps.wrong);
    };
    std::vector<FloatPlane> planes;
    for (const DryChannel& c : channels) planes.push_back({c.name, c.base, c.stride});
    if (read_scan_blocks(path, kDry, planes, look_at, progress)) return maps;
    Imf::InputPart part(file, dry.number);
    part.setFrameBuffer(frame_buffer(maps.surface));
    for (int y = 0; y < height; y += kRowsAtOnce) {
        report(progress, "read painting", y / static_cast<double>(height));
        const int end = std::min(y + kRowsAtOnce, height);
        part.readPixels(y, end - 1);
        parallel_for(y, end, 16, look_at);
    }
    return maps;
}

// Throws Error where there is none, its header cannot be right, or memory does not suffice for it.
DryPart find_dry_part(const fs::path& path, const Imf::MultiPartInputFile& file) {
    DryPart dry;
    dry.number = find_part(file, kDry);
    if (dry.number < 0)
        fail("{}: is an EXR file, but not a painting: it has no part '{}'. Make one with: tangipaint fit",
             path.string(), kDry);
    const Imf::Header& header = file.header(dry.number);
    const auto& window = header.dataWindow();
    dry.width = window.max.x - window.min.x + 1, dry.height = window.max.y - window.min.y + 1;
    if (window.min.x != 0 || window.min.y != 0)
        fail("{}: its data window does not start at 0, 0", path.string());
    // Paintings are whole pictures. A damaged size is so found before memory for it is asked for.
    if (header.displayWindow() != window)
        fail("{}: part '{}' is {} x {}, but its display window is not", path.string(), kDry, dry.width,
             dry.height);
    const auto has = [&](const char* channel) { return header.channels().findChannel(channel) != nullptr; };
    if (has(kLobeChannels[0])) dry.names.specular_colour = Image<Rgb>(1, 1);
    if (has(kAxesChannels[0])) dry.names.lobe_axes = Image<LobeAxes>(1, 1);
    for (const DryChannel& c : channels_of(dry.names))
        if (!header.channels().findChannel(c.name))
            fail("{}: part '{}' has no channel '{}'", path.string(), kDry, c.name);
    const double beside = (dry.names.specular_colour.empty() ? 0.0 : sizeof(Rgb)) +
                          (dry.names.lobe_axes.empty() ? 0.0 : sizeof(LobeAxes));
    require_memory_of_surface(path, dry.width, dry.height, beside, "a painting");
    return dry;
}

// What the header says of the painting as a whole.
void read_attributes(const fs::path& path, const Imf::Header& header, Surface& s) {
    s.mm_per_pixel = kept_scale_mm(attribute<Imf::FloatAttribute>(header, "mm_per_pixel", 1.0f));
    if (!(s.mm_per_pixel > 0) || !std::isfinite(s.mm_per_pixel))
        fail("{}: mm_per_pixel = {} is not positive", path.string(), s.mm_per_pixel);
    s.reflectance_model.diffuse_roughness = attribute<Imf::DoubleAttribute>(header, "diffuse_roughness", 0.0);
    s.reflectance_model.second_lobe_weight = second_lobe_weight_of<Imf::DoubleAttribute>(header);
    for (const auto& [name, value] : {std::pair("diffuse_roughness", s.reflectance_model.diffuse_roughness),
                                      {"second_lobe_weight", s.reflectance_model.second_lobe_weight}})
        if (!(value >= 0 && value <= 1)) fail("{}: {} = {} is not from 0 to 1", path.string(), name, value);
    s.scale_known = attribute<Imf::IntAttribute>(header, "scale_known", 0) != 0;
    s.provenance = attribute<Imf::StringAttribute>(header, "provenance", std::string());
    const std::string photography = attribute<Imf::StringAttribute>(header, "photography", std::string("{}"));
    try {
        s.photography = photography_from_json(json_or_discarded(photography));
    } catch (const std::exception&) {  // of a parser, about columns that nobody sees
        fail(
            "{}: is damaged: what it says of its photographs (attribute 'photography') cannot be read; copy "
            "it again, or take a copy from before",
            path.string());
    }
}

// That the maps are those that were saved, and make sense.
void require_intact(const fs::path& path, const Imf::Header& header, const Maps& maps) {
    const std::string stored = attribute<Imf::StringAttribute>(header, "dry_hash", std::string());
    if (const std::string found = joined_hash(maps.hashes); !stored.empty() && stored != found)
        fail("{}: the dry layer is not the one that was saved (hash {} expected, {} found)", path.string(),
             shortened(stored), found);
    for (const std::string& what : maps.wrong)
        if (!what.empty())
            fail("{}: {}, where confidence is not 0; correct the map, or set confidence to 0 there",
                 path.string(), what);
}

Surface read_dry_part(const fs::path& path, const Progress& progress) {
    let_openexr_use_threads();
    Imf::MultiPartInputFile file(path.c_str(), thread_count());
    const DryPart dry = find_dry_part(path, file);
    Maps maps = read_maps(path, file, dry, progress);
    read_attributes(path, file.header(dry.number), maps.surface);
    require_intact(path, file.header(dry.number), maps);
    return std::move(maps.surface);
}

}  // namespace

double kept_scale_mm(double mm_per_pixel) {
    return std::stod(fmt::format("{}", static_cast<float>(mm_per_pixel)));
}

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
    const std::string target = file.target().string();
    std::string failure;
    let_openexr_use_threads();
    try {
        CheckedStream stream(file.temporary(), !parts.empty());
        try {
            std::vector<Imf::Header> headers = {header_of(s)};
            for (const PartToWrite& further : parts) {
                headers.push_back(header_of(further.info));
                // OpenEXR wants it to be the same for all parts, of whatever size.
                headers.back().displayWindow() = headers.front().displayWindow();
            }
            constexpr int threads = kRowsAtOnce / kRowsOfBlock / 2;  // which have two buffers each
            Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()), false,
                                            threads);
            Imf::OutputPart part(output, 0);
            part.setFrameBuffer(frame_buffer(const_cast<Surface&>(s)));  // OpenEXR only reads it
            for (int y = 0; y < s.height(); y += kRowsAtOnce) {
                report(progress, "write painting", y / static_cast<double>(s.height()));
                write_rows(stream, part, std::min(kRowsAtOnce, s.height() - y));
            }
            for (std::size_t i = 0; i < parts.size(); ++i)
                write_part(stream, output, static_cast<int>(i) + 1, parts[i], progress);
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& error) {
            failure = says_no_memory(error) ? kNoMemory : error.what();
        }
        if (!stream.failure().empty()) failure = stream.failure();
    } catch (const Cancelled&) {
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

bool is_painting(const fs::path& path) {
    // What is damaged is a painting all the same: who reads it is told so.
    if (const auto claim = exr_claim(path); claim && (claim->impossible || claim->cut_off))
        return std::ranges::find(claim->parts, kDry) != claim->parts.end();
    try {
        return find_part(Imf::MultiPartInputFile(path.c_str()), kDry) >= 0;
    } catch (const std::exception&) {  // not an EXR file at all
        return false;
    }
}

Surface read_painting(const fs::path& path, const Progress& progress) {
    return reading_painting(path, [&] { return read_dry_part(path, progress); });
}

}  // namespace tangi
