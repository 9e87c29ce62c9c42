#include "surface/painting_file.h"

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

#include "surface/error.h"
#include "surface/overview.h"
#include "surface/painting_errors.h"
#include "surface/painting_parts.h"
#include "surface/parallel.h"
#include "surface/photography_json.h"
#include "surface/scan_blocks.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDry = "dry";
constexpr std::array kLobe = {"lobe.R", "lobe.G", "lobe.B"};
constexpr std::size_t kLobeAt = 10;  // their place among the channels
constexpr int kRowsAtOnce = 256;
constexpr float kSmallestRoughness = 1e-6f;  // [1] its square divides
constexpr std::uint64_t kHashOffset = 0xcbf29ce484222325u, kHashPrime = 0x100000001b3u;  // FNV-1a

// One channel of the file and where its floats lie in a Surface.
struct Channel {
    const char* name;
    float* base;
    std::size_t stride;  // [floats] from pixel to pixel
};

// Paintings whose lobes are all white have no colours of them, neither in memory nor in the file.
std::vector<Channel> channels_of(Surface& s) {
    float* normal = &s.normal.data()->x;
    float* diffuse = &s.diffuse.data()->r;
    std::vector<Channel> channels = {{"height", s.height_mm.data(), 1},
                                     {"normal.X", normal, 3},
                                     {"normal.Y", normal + 1, 3},
                                     {"normal.Z", normal + 2, 3},
                                     {"diffuse.R", diffuse, 3},
                                     {"diffuse.G", diffuse + 1, 3},
                                     {"diffuse.B", diffuse + 2, 3},
                                     {"specular", s.specular.data(), 1},
                                     {"roughness", s.roughness.data(), 1},
                                     {"confidence", s.confidence.data(), 1}};
    if (!s.lobe_colour.empty())
        for (std::size_t c = 0; c < kLobe.size(); ++c)
            channels.push_back({kLobe[c], &s.lobe_colour.data()->r + c, 3});
    return channels;
}

Imf::FrameBuffer frame_buffer(Surface& s) {
    Imf::FrameBuffer buffer;
    for (const Channel& c : channels_of(s)) {
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
    explicit CheckedStream(const fs::path& path)
        : Imf::OStream(path.c_str()), file_(::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC)) {
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

private:
    int file_;
    std::string failure_;
};

// Names of photographs come from file systems, where any bytes are allowed.
std::string utf8_of(const nlohmann::json& json) {
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Imf::Header header_of(const Surface& s) {
    Imf::Header header(s.width(), s.height());
    header.setName(kDry);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const Channel& c : channels_of(const_cast<Surface&>(s)))  // only the names are read
        header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
    header.insert("mm_per_pixel", Imf::FloatAttribute(static_cast<float>(s.mm_per_pixel)));
    for (const auto& [name, value] :
         {std::pair("diffuse_roughness", s.law.diffuse_roughness), {"haze", s.law.haze}})
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

void write_part(Imf::MultiPartOutputFile& output, int number, const PartToWrite& part,
                const Progress& progress) {
    constexpr int rows_at_once = 64;
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
        target.writePixels(end - y);
    }
}

int find_part(const Imf::MultiPartInputFile& file, const std::string& name) {
    for (int part = 0; part < file.parts(); ++part)
        if (file.header(part).hasName() && file.header(part).name() == name) return part;
    return -1;
}

template <class Attribute, class Value>
Value attribute(const Imf::Header& header, const char* name, const Value& otherwise) {
    const auto* found = header.findTypedAttribute<Attribute>(name);
    return found ? found->value() : otherwise;
}

// What a pixel must not hold where it was measured; empty where all is well.
std::string wrong_at(const Surface& s, std::span<const Channel> channels, std::size_t i) {
    for (const Channel& c : channels)
        if (const float value = c.base[i * c.stride]; !std::isfinite(value))
            return fmt::format("map '{}' holds {}", c.name, value);
    const float roughness = s.roughness.pixels()[i];
    if (!(roughness >= kSmallestRoughness))
        return fmt::format("map 'roughness' holds {}, less than {}", roughness, kSmallestRoughness);
    if (!s.lobe_colour.empty()) {
        const Rgb& colour = s.lobe_colour.pixels()[i];
        if (!(std::min({colour.r, colour.g, colour.b}) >= 0 && std::max({colour.r, colour.g, colour.b}) <= 1))
            return fmt::format("map 'lobe' holds ({}, {}, {}), which is not from 0 to 1", colour.r, colour.g,
                               colour.b);
    }
    const Vec3& normal = s.normal.pixels()[i];
    if (!(normal.z > 0))
        return fmt::format("map 'normal' holds ({}, {}, {}), which points away", normal.x, normal.y,
                           normal.z);
    if (!(std::abs(glm::length(normal) - 1) <= 0.01f))
        return fmt::format("map 'normal' holds ({}, {}, {}), which is no unit vector", normal.x, normal.y,
                           normal.z);
    return {};
}

// Other programs write zeros where nothing was measured: what surface.h promises of such pixels.
void clear_pixel(Surface& s, std::size_t i) {
    static const Surface unmeasured(1, 1);
    if (!std::isfinite(s.height_mm.pixels()[i])) s.height_mm.pixels()[i] = unmeasured.height_mm(0, 0);
    s.normal.pixels()[i] = unmeasured.normal(0, 0);
    s.diffuse.pixels()[i] = unmeasured.diffuse(0, 0);
    s.specular.pixels()[i] = unmeasured.specular(0, 0);
    s.roughness.pixels()[i] = unmeasured.roughness(0, 0);
    s.confidence.pixels()[i] = unmeasured.confidence(0, 0);
    if (!s.lobe_colour.empty()) s.lobe_colour.pixels()[i] = Rgb(1);
}

// Nothing to do about a pixel: numbers, and a unit vector to rounding. What is not told here may still be all
// right.
bool is_plain(std::span<const Channel> channels, std::size_t i) {
    float none = 0;  // x - x is 0 unless x is infinite or no number
    for (const Channel& c : channels) {
        const float value = c.base[i * c.stride];
        none += value - value;
    }
    const float *normal = channels[1].base + 3 * i,
                length2 = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    for (const Channel& c : channels.subspan(kLobeAt))
        if (const float value = c.base[i * c.stride]; !(value >= 0 && value <= 1)) return false;
    return none == 0 && channels[8].base[i] >= kSmallestRoughness && normal[2] > 0 &&
           std::abs(length2 - 1) <= 1.5e-5f;
}

// Maps that another program wrote, or changed, may hold what cannot be relit. Our own come through bit for
// bit. What is wrong in these rows, the first of each row.
void make_usable(Surface& s, int y0, int y1, std::vector<std::string>& wrong) {
    const auto channels = channels_of(s);
    for (int y = y0; y < y1; ++y)
        for (int x = 0; x < s.width(); ++x) {
            const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width()) +
                           static_cast<std::size_t>(x);
            if (is_plain(channels, i)) continue;
            const std::string what = wrong_at(s, channels, i);
            Vec3& normal = s.normal.pixels()[i];
            if (what.empty()) {
                // Half floats and resampling shorten normals; a float's rounding is no reason to touch
                // them.
                if (std::abs(glm::length(normal) - 1) > 1e-5f) normal = glm::normalize(normal);
            } else if (s.confidence.pixels()[i] <= 0) {
                clear_pixel(s, i);
            } else if (wrong[static_cast<std::size_t>(y)].empty()) {
                wrong[static_cast<std::size_t>(y)] = fmt::format("{} at pixel ({}, {})", what, x, y);
            }
        }
}

// Hashes of the rows [y0, y1), into hashes[y]. Four rows at a time: each waits for its own products only.
void hash_rows(std::span<const Channel> channels, int width, int y0, int y1,
               std::span<std::uint64_t> hashes) {
    for (int y = y0; y < y1; y += 4) {
        std::array<std::uint64_t, 4> hash;
        hash.fill(kHashOffset);
        for (const Channel& c : channels) {
            std::array<const float*, 4> value;
            for (int k = 0; k < 4; ++k)
                value[static_cast<std::size_t>(k)] =
                    c.base + static_cast<std::size_t>(std::min(y + k, y1 - 1)) *
                                 static_cast<std::size_t>(width) * c.stride;
            for (std::size_t at = 0; at < static_cast<std::size_t>(width) * c.stride; at += c.stride)
                for (std::size_t k = 0; k < 4; ++k)
                    hash[k] = (hash[k] ^ std::bit_cast<std::uint32_t>(value[k][at])) * kHashPrime;
        }
        for (int k = 0; k < 4 && y + k < y1; ++k)
            hashes[static_cast<std::size_t>(y + k)] = hash[static_cast<std::size_t>(k)];
    }
}

// Rows are hashed side by side and their hashes joined in order, so threads don't change the result.
std::string joined(std::span<const std::uint64_t> rows) {
    std::uint64_t hash = kHashOffset;
    for (const std::uint64_t row : rows) hash = (hash ^ row) * kHashPrime;
    return fmt::format("{:016x}", hash);
}

// The maps, as the file has them; their hash, and what cannot be relit, looked at while rows are at hand.
struct Maps {
    Surface surface;
    std::vector<std::uint64_t> hashes;  // of rows, as they were
    std::vector<std::string> wrong;     // the first of each row
};

Maps read_maps(const fs::path& path, Imf::MultiPartInputFile& file, int number, int width, int height,
               bool coloured, const Progress& progress) {
    const auto rows = static_cast<std::size_t>(height);
    Maps maps{Surface(width, height), std::vector<std::uint64_t>(rows), std::vector<std::string>(rows)};
    if (coloured) maps.surface.lobe_colour = Image<Rgb>(width, height);
    const auto channels = channels_of(maps.surface);
    const auto look_at = [&](int y0, int y1) {
        hash_rows(channels, width, y0, y1, maps.hashes);
        make_usable(maps.surface, y0, y1, maps.wrong);
    };
    std::vector<FloatPlane> planes;
    for (const Channel& c : channels) planes.push_back({c.name, c.base, c.stride});
    if (read_scan_blocks(path, kDry, planes, look_at, progress)) return maps;
    Imf::InputPart part(file, number);
    part.setFrameBuffer(frame_buffer(maps.surface));
    for (int y = 0; y < height; y += kRowsAtOnce) {
        report(progress, "read painting", y / static_cast<double>(height));
        const int end = std::min(y + kRowsAtOnce, height);
        part.readPixels(y, end - 1);
        parallel_for(y, end, 16, look_at);
    }
    return maps;
}

Surface read_dry_part(const fs::path& path, const Progress& progress) {
    let_openexr_use_threads();
    Imf::MultiPartInputFile file(path.c_str(), thread_count());
    const int number = find_part(file, kDry);
    if (number < 0)
        fail("{}: is an EXR file, but not a painting: it has no part '{}'. Make one with: tangipaint fit",
             path.string(), kDry);
    const Imf::Header& header = file.header(number);
    const auto& window = header.dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    if (window.min.x != 0 || window.min.y != 0)
        fail("{}: its data window does not start at 0, 0", path.string());
    // Paintings are whole pictures. A damaged size is so found before memory for it is asked for.
    if (header.displayWindow() != window)
        fail("{}: part '{}' is {} x {}, but its display window is not", path.string(), kDry, width, height);

    Surface names(1, 1);
    const bool coloured = header.channels().findChannel(kLobe[0]) != nullptr;
    if (coloured) names.lobe_colour = Image<Rgb>(1, 1);
    for (const Channel& c : channels_of(names))
        if (!header.channels().findChannel(c.name))
            fail("{}: part '{}' has no channel '{}'", path.string(), kDry, c.name);
    Maps maps = read_maps(path, file, number, width, height, coloured, progress);
    Surface& s = maps.surface;
    // A float of 0.1 mm is 0.1 mm again, not 0.10000000149: a sitting that goes on has the same pixels.
    s.mm_per_pixel =
        std::stod(fmt::format("{}", attribute<Imf::FloatAttribute>(header, "mm_per_pixel", 1.0f)));
    if (!(s.mm_per_pixel > 0) || !std::isfinite(s.mm_per_pixel))
        fail("{}: mm_per_pixel = {} is not positive", path.string(), s.mm_per_pixel);
    s.law.diffuse_roughness = attribute<Imf::DoubleAttribute>(header, "diffuse_roughness", 0.0);
    s.law.haze = attribute<Imf::DoubleAttribute>(header, "haze", 0.0);
    for (const auto& [name, value] :
         {std::pair("diffuse_roughness", s.law.diffuse_roughness), {"haze", s.law.haze}})
        if (!(value >= 0 && value <= 1)) fail("{}: {} = {} is not from 0 to 1", path.string(), name, value);
    s.scale_known = attribute<Imf::IntAttribute>(header, "scale_known", 0) != 0;
    s.provenance = attribute<Imf::StringAttribute>(header, "provenance", std::string());
    const std::string photography = attribute<Imf::StringAttribute>(header, "photography", std::string("{}"));
    try {
        s.photography = photography_from_json(nlohmann::json::parse(photography));
    } catch (const std::exception& error) {
        fail("{}: attribute 'photography': {}", path.string(), error.what());
    }
    const std::string stored = attribute<Imf::StringAttribute>(header, "dry_hash", std::string());
    if (const std::string found = joined(maps.hashes); !stored.empty() && stored != found)
        fail("{}: the dry layer is not the one that was saved (hash {} expected, {} found)", path.string(),
             stored, found);
    for (const std::string& what : maps.wrong)
        if (!what.empty())
            fail("{}: {}, where confidence is not 0; correct the map, or set confidence to 0 there",
                 path.string(), what);
    return std::move(maps.surface);
}

}  // namespace

std::string hash_of(const Surface& s) {
    std::vector<std::uint64_t> rows(static_cast<std::size_t>(s.height()));
    const auto channels = channels_of(const_cast<Surface&>(s));  // read only
    parallel_for(0, s.height(), 16,
                 [&](int begin, int end) { hash_rows(channels, s.width(), begin, end, rows); });
    return joined(rows);
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
    const std::string target = file.target().string();
    std::string failure;
    let_openexr_use_threads();
    try {
        CheckedStream stream(file.temporary());
        try {
            std::vector<Imf::Header> headers = {header_of(s)};
            for (const PartToWrite& further : parts) {
                headers.push_back(header_of(further.info));
                // OpenEXR wants it to be the same for all parts, of whatever size.
                headers.back().displayWindow() = headers.front().displayWindow();
            }
            Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()), false,
                                            thread_count());
            Imf::OutputPart part(output, 0);
            part.setFrameBuffer(frame_buffer(const_cast<Surface&>(s)));  // OpenEXR only reads it
            for (int y = 0; y < s.height(); y += kRowsAtOnce) {
                report(progress, "write painting", y / static_cast<double>(s.height()));
                part.writePixels(std::min(kRowsAtOnce, s.height() - y));
            }
            for (std::size_t i = 0; i < parts.size(); ++i)
                write_part(output, static_cast<int>(i) + 1, parts[i], progress);
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& error) {
            failure = error.what();
        }
        if (!stream.failure().empty()) failure = stream.failure();
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        failure = error.what();
    }
    if (!failure.empty()) fail("{}: cannot be written: {}", target, failure);
    report(progress, "write painting", 1);  // the last chance to stop: what is in place is not taken back
}

void write_painting(const fs::path& path, const Surface& s, const Progress& progress) {
    AtomicFile file(path);
    write_painting(file, s, progress);
}

bool is_painting(const fs::path& path) {
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
