#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>

#include <cmath>

#include "surface/base/parallel.h"
#include "surface/image_file/painting_errors.h"
#include "surface/maps/material.h"
#include "surface/painting_file/exr_attribute.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char *kOverview = "overview", *kHash = "dry_hash";
constexpr int kSide = 1024;                 // [pixels] at most
constexpr std::size_t kFewest = 4'000'000;  // [pixels] of a painting that has one
constexpr int kBandRows = 256;              // [pixels] of what is seen at a time, about

// In the order of their names, as parts want it.
const std::vector<std::string> kChannels = {"confidence", "diffuse.B", "diffuse.G", "diffuse.R", "height",
                                            "normal.X",   "normal.Y",  "normal.Z",  "roughness", "specular"};

struct ChannelPlane {
    float* base;
    std::ptrdiff_t stride;
};

std::array<ChannelPlane, 10> planes_of(Surface& s) {
    float *diffuse = &s.diffuse.data()->r, *normal = &s.normal.data()->x;
    return {{{s.confidence.data(), 1},
             {diffuse + 2, 3},
             {diffuse + 1, 3},
             {diffuse, 3},
             {s.height_mm.data(), 1},
             {normal, 3},
             {normal + 1, 3},
             {normal + 2, 3},
             {s.roughness.data(), 1},
             {s.specular.data(), 1}}};
}

// Of the pixels in `r`, into pixel (x, y) of `small`.
void average(const Surface& s, const Region& r, Surface& small, int x, int y) {
    MeanMaterial mean(false);
    for (int sy = r.y0; sy < r.y1; ++sy)
        for (int sx = r.x0; sx < r.x1; ++sx) mean.add(material_at(s, sx, sy));
    set_material(small, x, y, mean.material());
}

// Rows of `small` from `first` on, as many as there are in `s`.
void reduce_band(const Surface& s, int factor, Surface& small, int first) {
    parallel_for(0, (s.height() + factor - 1) / factor, 4, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < small.width(); ++x)
                average(s,
                        {x * factor, y * factor, std::min((x + 1) * factor, s.width()),
                         std::min((y + 1) * factor, s.height())},
                        small, x, first + y);
    });
}

int factor_of(int width, int height) { return (std::max(width, height) + kSide - 1) / kSide; }

PartToWrite part_of_overview(Surface&& overview, const std::string& dry_hash) {
    const auto small = std::make_shared<Surface>(std::move(overview));
    PartToWrite part;
    part.info = {kOverview, small->width(), small->height(), kChannels, {{kHash, dry_hash}}, true};
    part.fill = [small](int y0, int y1, std::span<float* const> rows) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y0) * small->width(),
                             count = static_cast<std::ptrdiff_t>(y1 - y0) * small->width();
        const auto planes = planes_of(*small);
        for (std::size_t c = 0; c < planes.size(); ++c)
            for (std::ptrdiff_t i = 0; i < count; ++i)
                rows[c][i] = planes[c].base[(first + i) * planes[c].stride];
    };
    return part;
}

const Imf::Header* header_of(const Imf::MultiPartInputFile& file, const char* name) {
    for (int part = 0; part < file.parts(); ++part)
        if (file.header(part).hasName() && file.header(part).name() == name) return &file.header(part);
    return nullptr;
}

// Halves and mean normals are what can be drawn, as `dry` must be.
bool can_be_drawn(Surface& s) {
    for (std::size_t i = 0; i < s.normal.size(); ++i) {
        float sum = 0;  // of what is finite
        for (const ChannelPlane& plane : planes_of(s))
            sum += plane.base[static_cast<std::ptrdiff_t>(i) * plane.stride];
        Vec3& n = s.normal.pixels()[i];
        if (!std::isfinite(sum) || !(n.z > 0) || !(s.roughness.pixels()[i] > 0)) return false;
        n = glm::normalize(n);
    }
    return true;
}

std::optional<Overview> read(const fs::path& path) {
    Overview overview;
    double mm_per_pixel = 1;
    ReflectanceModel reflectance_model;
    PartInfo info;
    info.name = kOverview;
    info.channels = kChannels;
    {
        const Imf::MultiPartInputFile file(path.c_str(), 0);
        const Imf::Header *dry = header_of(file, "dry"), *there = header_of(file, kOverview);
        if (!dry)
            fail(
                "{}: is an EXR file, but not a painting: it has no part 'dry'. Make one with: tangipaint fit",
                path.string());
        if (!there) return {};
        const std::string hash = attribute<Imf::StringAttribute>(*dry, kHash, std::string());
        if (hash.empty() || attribute<Imf::StringAttribute>(*there, kHash, std::string()) != hash) return {};
        const auto &whole = dry->dataWindow(), &small = there->dataWindow();
        overview.width = whole.max.x + 1;
        overview.height = whole.max.y + 1;
        info.width = small.max.x + 1;
        info.height = small.max.y + 1;
        mm_per_pixel = attribute<Imf::FloatAttribute>(*dry, "mm_per_pixel", 1.0f);
        reflectance_model.diffuse_roughness = attribute<Imf::DoubleAttribute>(*dry, "diffuse_roughness", 0.0);
        reflectance_model.second_lobe_weight = second_lobe_weight_of<Imf::DoubleAttribute>(*dry);
    }
    if (info.width < 1 || info.height < 1 || info.width > kSide || info.height > kSide) return {};
    overview.surface = Surface(info.width, info.height);
    Surface& s = overview.surface;
    read_painting_part(path, info, [&](int y0, int y1, std::span<const float* const> rows) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y0) * info.width,
                             count = static_cast<std::ptrdiff_t>(y1 - y0) * info.width;
        const auto planes = planes_of(s);
        for (std::size_t c = 0; c < planes.size(); ++c)
            for (std::ptrdiff_t i = 0; i < count; ++i)
                planes[c].base[(first + i) * planes[c].stride] = rows[c][i];
    });
    s.mm_per_pixel = mm_per_pixel * overview.width / info.width;
    s.reflectance_model = reflectance_model;
    if (!(s.mm_per_pixel > 0) || !can_be_drawn(s)) return {};
    return overview;
}

// Of what is seen in bands of rows, of a painting of so many pixels.
Surface reduced(const std::function<Surface(const Region&)>& seen, int width, int height) {
    const int factor = factor_of(width, height), rows = std::max(kBandRows / factor, 1);
    Surface small((width + factor - 1) / factor, (height + factor - 1) / factor);
    for (int y = 0; y < small.height(); y += rows)
        reduce_band(seen({0, y * factor, width, std::min((y + rows) * factor, height)}), factor, small, y);
    return small;
}

}  // namespace

bool wants_overview(const Surface& dry) { return dry.height_mm.size() >= kFewest; }

bool is_overview(const PartToWrite& part) { return part.info.name == kOverview; }

bool is_overview_of(const PartToWrite& part, const std::string& dry_hash) {
    const auto hash = part.info.attributes.find(kHash);
    return is_overview(part) && hash != part.info.attributes.end() && hash->second == dry_hash;
}

void add_overview(std::vector<PartToWrite>& parts, const Surface& seen, const Surface& dry) {
    std::erase_if(parts, is_overview);
    if (!wants_overview(seen)) return;
    const int factor = factor_of(seen.width(), seen.height());
    Surface small((seen.width() + factor - 1) / factor, (seen.height() + factor - 1) / factor);
    reduce_band(seen, factor, small, 0);
    parts.push_back(part_of_overview(std::move(small), hash_of(dry)));
}

void add_overview(std::vector<PartToWrite>& parts, const std::function<Surface(const Region&)>& seen,
                  const Surface& dry) {
    std::erase_if(parts, is_overview);
    if (!wants_overview(dry)) return;
    parts.push_back(part_of_overview(reduced(seen, dry.width(), dry.height()), hash_of(dry)));
}

void add_overview(std::vector<PartToWrite>& parts, const PaintingReader& painting) {
    std::erase_if(parts, is_overview);
    const int width = painting.width(), height = painting.height();
    if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) < kFewest) return;
    const auto seen = [&](const Region& rows) { return painting.read_rows(rows.y0, rows.y1); };
    parts.push_back(part_of_overview(reduced(seen, width, height), painting.header().dry_hash));
}

std::optional<Overview> read_overview(const fs::path& path) {
    if (!is_tiled_painting(path)) return reading_painting(path, [&] { return read(path); });
    const auto painting = open_painting(path);
    const int coarsest = painting->levels() - 1;
    if (coarsest == 0) return {};
    Overview overview{painting->read(painting->extent(coarsest).region(), coarsest), painting->width(),
                      painting->height()};
    overview.surface.photography = {};
    overview.surface.part_of.reset();
    return overview;
}

}  // namespace tangi
