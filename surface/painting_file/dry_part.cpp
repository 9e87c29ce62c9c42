#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"
#include "surface/file/version.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/exr_header_check.h"
#include "surface/image_file/painting_errors.h"
#include "surface/maps/photography_json.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/dry_part.h"
#include "surface/painting_file/exr_attribute.h"
#include "surface/painting_file/exr_parallel_reader.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/surface_channels.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

int find_part(const Imf::MultiPartInputFile& file, const std::string& name) {
    for (int part = 0; part < file.parts(); ++part)
        if (file.header(part).hasName() && file.header(part).name() == name) return part;
    return -1;
}

// Where it is, and its size and maps. Throws Error where there is none, or its header cannot be right.
int find_dry_part(const fs::path& path, const Imf::MultiPartInputFile& file, PaintingHeader& found) {
    const int number = find_part(file, kDryPart);
    if (number < 0)
        fail("{}: is an EXR file, but not a painting: it has no part '{}'. Make one with: tangipaint fit",
             path.string(), kDryPart);
    const Imf::Header& header = file.header(number);
    const auto& window = header.dataWindow();
    found.width = window.max.x - window.min.x + 1, found.height = window.max.y - window.min.y + 1;
    if (window.min.x != 0 || window.min.y != 0)
        fail("{}: its data window does not start at 0, 0", path.string());
    // Paintings are whole pictures. A damaged size is so found before memory for it is asked for.
    if (header.displayWindow() != window)
        fail("{}: part '{}' is {} x {}, but its display window is not", path.string(), kDryPart, found.width,
             found.height);
    const auto has = [&](const char* channel) { return header.channels().findChannel(channel) != nullptr; };
    found.has_specular_colour = has(kLobeChannels[0]);
    found.has_lobe_axes = has(kAxesChannels[0]);
    Surface names = blank_surface(found, 1, 1);
    for (const DryChannel& c : channels_of(names))
        if (!has(c.name)) fail("{}: part '{}' has no channel '{}'", path.string(), kDryPart, c.name);
    return number;
}

// What the header says of the painting as a whole.
void read_attributes(const fs::path& path, const Imf::Header& header, PaintingHeader& s) {
    if (const int format = attribute<Imf::IntAttribute>(header, "format_version", 1);
        format > kPaintingFormatVersion)
        fail(
            "{}: is a painting of format version {}, and {} reads up to {}; take a newer version of the "
            "program",
            path.string(), format, program_name(), kPaintingFormatVersion);
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
    s.dry_hash = attribute<Imf::StringAttribute>(header, "dry_hash", std::string());
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

// The maps as the file has them; their hash, and what cannot be relit, looked at while rows are at hand.
struct Maps {
    Surface surface;
    std::vector<std::uint64_t> hashes;  // of rows, as they were
    std::vector<std::string> wrong;     // the first of each row
};

Maps read_maps(const fs::path& path, DryPart& dry, const Progress& progress) {
    const PaintingHeader& header = dry.header();
    const auto rows = static_cast<std::size_t>(header.height);
    Maps maps{blank_surface(header, header.width, header.height), std::vector<std::uint64_t>(rows),
              std::vector<std::string>(rows)};
    const auto channels = channels_of(maps.surface);
    const auto look_at = [&](int y0, int y1) {
        hash_rows(channels, header.width, y0, y1, maps.hashes);
        make_usable(maps.surface, y0, y1, maps.wrong);
    };
    std::vector<FloatPlane> planes;
    for (const DryChannel& c : channels) planes.push_back({c.name, c.base, c.stride});
    if (read_scan_blocks(path, kDryPart, planes, look_at, progress)) return maps;
    for (int y = 0; y < header.height; y += kRowsAtOnce) {
        report(progress, "read painting", y / static_cast<double>(header.height));
        const int end = std::min(y + kRowsAtOnce, header.height);
        dry.read(y, end, maps.surface, 0, y);
        parallel_for(y, end, 16, look_at);
    }
    return maps;
}

// That the maps are those that were saved, and make sense.
void require_intact(const fs::path& path, const PaintingHeader& header, const Maps& maps) {
    if (const std::string found = joined_hash(maps.hashes);
        !header.dry_hash.empty() && header.dry_hash != found)
        fail("{}: the dry layer is not the one that was saved (hash {} expected, {} found)", path.string(),
             shortened(header.dry_hash), found);
    for (const std::string& what : maps.wrong)
        if (!what.empty()) fail("{}: {}, {}", path.string(), what, kWrongMapRemedy);
}

Surface read_dry_part(const fs::path& path, const Progress& progress) {
    DryPart dry(path);
    const PaintingHeader& header = dry.header();
    const double beside =
        (header.has_specular_colour ? sizeof(Rgb) : 0.0) + (header.has_lobe_axes ? sizeof(LobeAxes) : 0.0);
    require_memory_of_surface(path, header.width, header.height, beside, "a painting");
    Maps maps = read_maps(path, dry, progress);
    require_intact(path, header, maps);
    describe(header, maps.surface);
    return std::move(maps.surface);
}

Surface read_all_tiles(const fs::path& path, const Progress& progress) {
    const auto reader = open_painting(path);
    const PaintingHeader& header = reader->header();
    const double beside =
        (header.has_specular_colour ? sizeof(Rgb) : 0.0) + (header.has_lobe_axes ? sizeof(LobeAxes) : 0.0);
    require_memory_of_surface(path, header.width, header.height, beside, "a painting, as a whole,");
    Surface all = blank_surface(header, header.width, header.height);
    const std::vector<Region> blocks = reader->blocks();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        report(progress, "read painting", static_cast<double>(i) / static_cast<double>(blocks.size()));
        paste(reader->read(blocks[i]), all, blocks[i].x0, blocks[i].y0);
    }
    describe(header, all);
    return all;
}

}  // namespace

Surface blank_surface(const PaintingHeader& header, int width, int height) {
    Surface s(width, height);
    if (header.has_specular_colour) s.specular_colour = Image<Rgb>(width, height, Rgb(1));
    if (header.has_lobe_axes) s.lobe_axes = Image<LobeAxes>(width, height);
    return s;
}

struct DryPart::Impl {
    fs::path path;
    Imf::MultiPartInputFile file;
    PaintingHeader header;
    std::optional<Imf::InputPart> part;

    explicit Impl(const fs::path& from) : path(from), file(from.c_str(), thread_count()) {
        const int number = find_dry_part(path, file, header);
        read_attributes(path, file.header(number), header);
        part.emplace(file, number);
    }
};

DryPart::DryPart(const fs::path& painting) {
    let_openexr_use_threads();
    impl_ = reading_painting(painting, [&] { return std::make_unique<Impl>(painting); });
    impl_->header.parts = painting_parts(painting);
}
DryPart::~DryPart() = default;
DryPart::DryPart(DryPart&&) noexcept = default;
DryPart& DryPart::operator=(DryPart&&) noexcept = default;

const PaintingHeader& DryPart::header() const { return impl_->header; }

void DryPart::read(int y0, int y1, Surface& into, int left, int top) {
    Impl& i = *impl_;
    TP_REQUIRE(y0 >= 0 && y1 <= i.header.height && left + i.header.width <= into.width() &&
                   top + y1 - y0 <= into.height(),
               "there is room for the rows");
    reading_painting(i.path, [&] {
        Imf::FrameBuffer buffer;
        for (const DryChannel& c : channels_of(into)) {
            const auto width = static_cast<std::size_t>(into.width());
            float* first =
                c.base + (static_cast<std::size_t>(top) * width + static_cast<std::size_t>(left)) * c.stride;
            buffer.insert(c.name,
                          Imf::Slice::Make(Imf::FLOAT, first, Imath::V2i(0, y0), i.header.width, y1 - y0,
                                           c.stride * sizeof(float), width * c.stride * sizeof(float)));
        }
        i.part->setFrameBuffer(buffer);
        i.part->readPixels(y0, y1 - 1);
        return true;
    });
}

void let_openexr_use_threads() {
    if (const int threads = thread_count(); Imf::globalThreadCount() != threads)
        Imf::setGlobalThreadCount(threads);
}

bool is_painting(const fs::path& path) {
    if (is_tiled_painting(path)) return true;
    // What is damaged is a painting all the same: who reads it is told so.
    if (const auto claim = exr_claim(path); claim && (claim->impossible || claim->cut_off))
        return std::ranges::find(claim->parts, kDryPart) != claim->parts.end();
    try {
        return find_part(Imf::MultiPartInputFile(path.c_str()), kDryPart) >= 0;
    } catch (const std::exception&) {  // not an EXR file at all
        return false;
    }
}

Surface read_painting(const fs::path& path, const Progress& progress) {
    if (is_tiled_painting(path)) return read_all_tiles(path, progress);
    return reading_painting(path, [&] { return read_dry_part(path, progress); });
}

}  // namespace tangi
