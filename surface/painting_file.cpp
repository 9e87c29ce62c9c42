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
#include <cerrno>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>

#include "surface/error.h"
#include "surface/painting_errors.h"
#include "surface/painting_parts.h"
#include "surface/parallel.h"
#include "surface/photography_json.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDry = "dry";
constexpr int kRowsAtOnce = 256;
constexpr float kSmallestRoughness = 1e-6f;  // [1] its square divides

// One channel of the file and where its floats lie in a Surface.
struct Channel {
    const char* name;
    float* base;
    std::size_t stride;  // [floats] from pixel to pixel
};

std::array<Channel, 10> channels_of(Surface& s) {
    float* normal = &s.normal.data()->x;
    float* diffuse = &s.diffuse.data()->r;
    return {{{"height", s.height_mm.data(), 1},
             {"normal.X", normal, 3},
             {"normal.Y", normal + 1, 3},
             {"normal.Z", normal + 2, 3},
             {"diffuse.R", diffuse, 3},
             {"diffuse.G", diffuse + 1, 3},
             {"diffuse.B", diffuse + 2, 3},
             {"specular", s.specular.data(), 1},
             {"roughness", s.roughness.data(), 1},
             {"confidence", s.confidence.data(), 1}}};
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
std::string wrong_at(const Surface& s, const std::array<Channel, 10>& channels, std::size_t i) {
    for (const Channel& c : channels)
        if (const float value = c.base[i * c.stride]; !std::isfinite(value))
            return fmt::format("map '{}' holds {}", c.name, value);
    const float roughness = s.roughness.pixels()[i];
    if (!(roughness >= kSmallestRoughness))
        return fmt::format("map 'roughness' holds {}, less than {}", roughness, kSmallestRoughness);
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
}

// Maps that another program wrote, or changed, may hold what cannot be relit. Our own come through bit for
// bit.
void require_usable(Surface& s, const fs::path& path) {
    std::vector<std::string> wrong(static_cast<std::size_t>(s.height()));  // the first of each row
    const auto channels = channels_of(s);
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) {
                const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width()) +
                               static_cast<std::size_t>(x);
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
    });
    for (const std::string& what : wrong)
        if (!what.empty())
            fail("{}: {}, where confidence is not 0; correct the map, or set confidence to 0 there",
                 path.string(), what);
}

Surface read_dry_part(const fs::path& path, const Progress& progress) {
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

    Surface s(width, height);
    for (const Channel& c : channels_of(s))
        if (!header.channels().findChannel(c.name))
            fail("{}: part '{}' has no channel '{}'", path.string(), kDry, c.name);
    Imf::InputPart part(file, number);
    part.setFrameBuffer(frame_buffer(s));
    for (int y = 0; y < height; y += kRowsAtOnce) {
        report(progress, "read painting", y / static_cast<double>(height));
        part.readPixels(y, std::min(y + kRowsAtOnce, height) - 1);
    }
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
    if (!stored.empty() && stored != hash_of(s))
        fail("{}: the dry layer is not the one that was saved (hash {} expected, {} found)", path.string(),
             stored, hash_of(s));
    require_usable(s, path);
    return s;
}

}  // namespace

std::string hash_of(const Surface& s) {
    // Rows are hashed side by side and their hashes joined in order, so threads don't change the result.
    constexpr std::uint64_t offset = 0xcbf29ce484222325u, prime = 0x100000001b3u;
    Image<std::uint64_t> rows(1, s.height(), offset);
    const auto channels = channels_of(const_cast<Surface&>(s));  // read only
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            std::uint64_t hash = offset;
            for (const Channel& c : channels) {
                const float* value = c.base + static_cast<std::size_t>(y) * s.width() * c.stride;
                for (int x = 0; x < s.width(); ++x, value += c.stride) {
                    std::uint32_t bits = 0;
                    std::memcpy(&bits, value, sizeof bits);
                    hash = (hash ^ bits) * prime;
                }
            }
            rows(0, y) = hash;
        }
    });
    std::uint64_t hash = offset;
    for (const std::uint64_t row : rows.pixels()) hash = (hash ^ row) * prime;
    return fmt::format("{:016x}", hash);
}

void write_painting(AtomicFile& file, const Surface& s, const Progress& progress) {
    write_painting(file, s, {}, progress);
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
