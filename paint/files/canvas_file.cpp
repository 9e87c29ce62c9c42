#include "paint/files/canvas_file.h"

#include <algorithm>

#include "paint/canvas/appearance_part.h"
#include "paint/files/canvas_parts.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kReadWhole = 16e6;  // [pixels] up to which a painting is read at once: 0.8 GB

}  // namespace

namespace {

// All parts of the file, with an overview of what is seen.
std::vector<PartToWrite> parts_of(const Canvas& canvas, std::span<const PartToWrite> further) {
    std::vector<PartToWrite> parts = paint_parts_of(canvas);
    parts.insert(parts.end(), further.begin(), further.end());
    const bool has_overview = std::any_of(further.begin(), further.end(), is_overview);
    if (!has_overview && canvas.ingredients().empty())
        add_overview(parts, canvas.dry(), canvas.dry());
    else if (!has_overview)
        add_overview(
            parts, [&](const Region& part) { return appearance_in(canvas, part); }, canvas.dry());
    return parts;
}

}  // namespace

void fill_canvas(const AtomicFile& file, const Canvas& canvas, const Progress& progress,
                 std::span<const PartToWrite> further) {
    fill_painting(file, canvas.dry(), parts_of(canvas, further), progress);
}

void fill_canvas(PaintingOutput& output, const Canvas& canvas, const Progress& progress,
                 std::span<const PartToWrite> further) {
    output.fill(canvas.dry(), parts_of(canvas, further), progress);
}

void write_canvas(AtomicFile& file, const Canvas& canvas, const Progress& progress,
                  std::span<const PartToWrite> further) {
    fill_canvas(file, canvas, progress, further);
    file.commit();
}

void write_canvas(const fs::path& path, const Canvas& canvas, const Progress& progress) {
    AtomicFile file(path);
    write_canvas(file, canvas, progress);
}

std::vector<PartToWrite> parts_beside_paint(const fs::path& path, const Progress& progress) {
    std::vector<PartToWrite> kept;
    for (const PartInfo& info : painting_parts(path)) {
        if (is_paint_part(info.name)) continue;
        auto planes = std::make_shared<std::vector<Image<float>>>(info.channels.size(),
                                                                  Image<float>(info.width, info.height));
        read_painting_part(
            path, info,
            [&](int y0, int y1, std::span<const float* const> rows) {
                for (std::size_t c = 0; c < rows.size(); ++c)
                    std::copy_n(rows[c], static_cast<std::ptrdiff_t>(y1 - y0) * info.width,
                                (*planes)[c].row(y0).data());
            },
            progress);
        kept.push_back({info, [planes](int y0, int y1, std::span<float* const> rows) {
                            for (std::size_t c = 0; c < rows.size(); ++c) {
                                const Image<float>& plane = (*planes)[c];
                                std::copy_n(plane.row(y0).data(),
                                            static_cast<std::ptrdiff_t>(y1 - y0) * plane.width(), rows[c]);
                            }
                        }});
    }
    return kept;
}

Canvas read_canvas(const fs::path& path, const Progress& progress, std::optional<double> mm_per_pixel) {
    const PartReader read = [&](const PartInfo& info, const TakeRows& take) {
        read_painting_part(path, info, take, progress);
    };
    return canvas_of_parts(path, std::make_shared<Surface>(read_painting(path, progress)),
                           painting_parts(path), read, mm_per_pixel);
}

Surface read_painted(const fs::path& path, const Progress& progress) {
    const Canvas canvas = read_canvas(path, progress);
    return canvas.ingredients().empty() ? canvas.dry() : appearance(canvas, {}, progress);
}

bool is_painted(const PaintingHeader& header) {
    return std::ranges::any_of(header.parts, [](const PartInfo& part) { return is_paint_part(part.name); });
}

std::shared_ptr<const PaintingReader> open_painted(const fs::path& path, const AppearanceOptions& look,
                                                   const Progress& progress) {
    const auto reader = open_painting(path);
    const bool is_large = static_cast<double>(reader->width()) * reader->height() > kReadWhole;
    if (is_painted(reader->header()) || look.illuminant != Illuminant::d65)
        return reader_of(shown(read_canvas(path, progress), look, progress), path);
    if (is_large) return reader;
    return reader_of(std::make_shared<const Surface>(read_painting(path, progress)), path);
}

}  // namespace tangi
