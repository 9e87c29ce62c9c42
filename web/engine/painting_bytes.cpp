#include "web/engine/painting_bytes.h"

#include <algorithm>
#include <cmath>

#include "paint/files/canvas_parts.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/version.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/surface_channels.h"
#include "web/engine/ground.h"

namespace tangi {

namespace {

const std::string kDry = "dry", kName = "the painting file";

Surface empty_surface(const PartInfo& info) {
    Surface surface(info.width, info.height);
    const auto has = [&](const char* name) {
        return std::find(info.channels.begin(), info.channels.end(), name) != info.channels.end();
    };
    if (has(kLobeChannels[0])) surface.specular_colour = Image<Rgb>(info.width, info.height, Rgb(1));
    if (has(kAxesChannels[0])) surface.lobe_axes = Image<LobeAxes>(info.width, info.height);
    for (const DryChannel& channel : channels_of(surface))
        if (!has(channel.name)) fail("the painting has no map '{}'", channel.name);
    return surface;
}

void take_attributes(const ExrPart& part, Surface& surface) {
    surface.mm_per_pixel = kept_scale_mm(static_cast<double>(part.get<float>("mm_per_pixel", 1)));
    if (!(surface.mm_per_pixel > 0) || !std::isfinite(surface.mm_per_pixel))
        fail("the painting's mm_per_pixel is {}", surface.mm_per_pixel);
    surface.scale_known = part.get<std::int32_t>("scale_known", 0) != 0;
    surface.reflectance_model.diffuse_roughness = part.get<double>("diffuse_roughness", 0);
    surface.reflectance_model.second_lobe_weight =
        part.get<double>("second_lobe_weight", part.get<double>("haze", 0));
    surface.provenance = part.text("provenance");
}

// Which channel of a part is which map; null for those that are none.
std::vector<const DryChannel*> maps_of(const PartInfo& info, const std::vector<DryChannel>& maps) {
    std::vector<const DryChannel*> found;
    for (const std::string& name : info.channels) {
        const auto map =
            std::find_if(maps.begin(), maps.end(), [&](const DryChannel& m) { return m.name == name; });
        found.push_back(map == maps.end() ? nullptr : &*map);
    }
    return found;
}

Surface dry_from(const ExrFile& file, const ExrPart& part) {
    const PartInfo info = ExrFile::info(part);
    Surface surface = empty_surface(info);
    const std::vector<DryChannel> maps = channels_of(surface);
    const std::vector<const DryChannel*> map = maps_of(info, maps);
    const auto width = static_cast<std::size_t>(info.width);
    file.read(part, [&](int y0, int y1, std::span<const float* const> planes) {
        const std::size_t first = static_cast<std::size_t>(y0) * width,
                          count = static_cast<std::size_t>(y1 - y0) * width;
        for (std::size_t c = 0; c < planes.size(); ++c)
            for (std::size_t i = 0; map[c] && i < count; ++i)
                map[c]->base[(first + i) * map[c]->stride] = planes[c][i];
    });
    take_attributes(part, surface);
    if (const std::string saved = part.text("dry_hash"); !saved.empty() && saved != hash_of(surface))
        fail("the painting's maps are not those that were saved: copy the file again");
    std::vector<std::string> wrong(static_cast<std::size_t>(surface.height()));
    make_usable(surface, 0, surface.height(), wrong);
    for (const std::string& what : wrong)
        if (!what.empty()) fail("the painting cannot be painted on: {}", what);
    return surface;
}

ExrPart dry_header(const Surface& s) {
    ExrPart header;
    header.attributes = {{"mm_per_pixel", exr_number(static_cast<float>(s.mm_per_pixel))},
                         {"software", exr_text(program_name())},
                         {"format_version", exr_number(std::int32_t{kPaintingFormatVersion})},
                         {"scale_known", exr_number(std::int32_t{s.scale_known})},
                         {"photography", exr_text(json_line(to_json(s.photography)))},
                         {"provenance", exr_text(s.provenance)},
                         {"dry_hash", exr_text(hash_of(s))}};
    for (const auto& [name, value] : {std::pair("diffuse_roughness", s.reflectance_model.diffuse_roughness),
                                      {"second_lobe_weight", s.reflectance_model.second_lobe_weight}})
        if (value != 0) header.attributes[name] = exr_number(value);
    return header;
}

// The maps in the order of their names, as OpenEXR has channels.
PartToWrite dry_rows(const Surface& s) {
    std::vector<DryChannel> maps = channels_of(const_cast<Surface&>(s));  // which are only read
    std::sort(maps.begin(), maps.end(),
              [](const DryChannel& a, const DryChannel& b) { return std::string(a.name) < b.name; });
    PartToWrite part;
    part.info = {kDry, s.width(), s.height(), {}, {}};
    for (const DryChannel& map : maps) part.info.channels.emplace_back(map.name);
    part.fill = [maps, width = static_cast<std::size_t>(s.width())](int y0, int y1,
                                                                    std::span<float* const> planes) {
        const std::size_t first = static_cast<std::size_t>(y0) * width,
                          count = static_cast<std::size_t>(y1 - y0) * width;
        for (std::size_t c = 0; c < maps.size(); ++c)
            for (std::size_t i = 0; i < count; ++i) planes[c][i] = maps[c].base[(first + i) * maps[c].stride];
    };
    return part;
}

bool stays(const std::string& name) {
    return !is_paint_part(name) && name != "overview" && name != "palette" && name != "brush";
}

}  // namespace

Canvas painting_from_bytes(const ByteSource& bytes, double memory_bytes) {
    const ExrFile file(bytes);
    const ExrPart* dry = file.part(kDry);
    if (!dry) fail("this EXR file is no painting: it has no part '{}'", kDry);
    const PartInfo size = ExrFile::info(*dry);
    require_memory_for(size.width, size.height, memory_bytes);
    std::vector<PartInfo> parts;
    for (const ExrPart& part : file.parts())
        if (is_paint_part(part.text("name"))) parts.push_back(ExrFile::info(part));
    const PartReader read = [&](const PartInfo& info, const TakeRows& take) {
        file.read(*file.part(info.name), take);
    };
    return canvas_of_parts(kName, std::make_shared<Surface>(dry_from(file, *dry)), parts, read);
}

PaintingToSave::PaintingToSave(const Canvas& canvas, const ByteSource& original) : canvas_(canvas) {
    if (original.size == 0) {
        parts_.push_back({dry_header(canvas_.dry()), dry_rows(canvas_.dry())});
    } else {
        file_.emplace(original);
        for (const ExrPart& part : file_->parts())
            if (stays(part.text("name"))) parts_.push_back({part, {}, &*file_});
    }
    for (PartToWrite& part : paint_parts_of(canvas_)) parts_.push_back({{}, std::move(part)});
    for (std::size_t part = 0; part < parts_.size(); ++part)
        for (std::size_t block = 0; block < block_count(parts_[part]); ++block)
            places_.emplace_back(part, block);
}

PaintingToSave::Block PaintingToSave::block(std::size_t number, bool sorted) const {
    TP_REQUIRE(number < places_.size(), "there is such a block");
    const auto [part, block] = places_[number];
    const ExrSource& source = parts_[part];
    Block found{
        static_cast<int>(part), static_cast<int>(block) * kExrRowsOfBlock, source.from != nullptr, {}};
    if (!source.from) {
        found.bytes = exr_block(source, block, sorted);
        return found;
    }
    ExrBlock kept = source.from->block(source.header, block);
    found.y = kept.y;
    found.bytes = std::move(kept.bytes);
    return found;
}

}  // namespace tangi
