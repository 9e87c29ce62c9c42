#include "paint/files/ora_file.h"

#include <zip.h>

#include <cmath>
#include <new>
#include <nlohmann/json.hpp>

#include "paint/canvas/layer_pictures.h"
#include "paint/files/canvas_file.h"
#include "paint/files/paint_metadata.h"
#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/file/version.h"
#include "surface/report/png_encode.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kThumbnail = 256;  // [pixels] of its longer side, at most

// An archive of members that are in memory until it is closed.
class Archive {
public:
    explicit Archive(const AtomicFile& file) : target_(file.target()) {
        int trouble = 0;
        zip_ = zip_open(file.temporary().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &trouble);
        if (zip_) return;
        if (trouble == ZIP_ER_MEMORY) throw std::bad_alloc();
        zip_error_t error;
        zip_error_init_with_code(&error, trouble);
        const std::string words = zip_error_strerror(&error);
        zip_error_fini(&error);
        fail("{}: cannot be written: {}", target_.string(), words);
    }
    ~Archive() {
        if (zip_) zip_discard(zip_);
    }
    Archive(const Archive&) = delete;
    Archive& operator=(const Archive&) = delete;

    // PNG and EXR are compressed already.
    void add(const std::string& name, std::string bytes, bool compress = false) {
        members_.push_back(std::make_unique<std::string>(std::move(bytes)));
        put(name, zip_source_buffer(zip_, members_.back()->data(), members_.back()->size(), 0), compress);
    }
    void add_file(const std::string& name, const fs::path& path) {
        put(name, zip_source_file(zip_, path.c_str(), 0, -1), false);
    }
    void close() {
        if (zip_close(zip_) != 0) failed();
        zip_ = nullptr;
    }

private:
    void put(const std::string& name, zip_source_t* source, bool compress) {
        if (!source) failed();
        const zip_int64_t index = zip_file_add(zip_, name.c_str(), source, ZIP_FL_ENC_UTF_8);
        if (index < 0) {
            zip_source_free(source);
            failed();
        }
        const auto at = static_cast<zip_uint64_t>(index);
        if (zip_set_file_compression(zip_, at, compress ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0) != 0 ||
            zip_file_set_dostime(zip_, at, 0, 33, 0) != 0)  // 1980-01-01: the same painting, the same bytes
            failed();
    }
    [[noreturn]] void failed() const {
        if (zip_error_code_zip(zip_get_error(zip_)) == ZIP_ER_MEMORY || says_no_memory(zip_strerror(zip_)))
            throw std::bad_alloc();  // zlib's own, too
        fail("{}: cannot be written: {}", target_.string(), zip_strerror(zip_));
    }

    fs::path target_;
    zip_t* zip_ = nullptr;
    std::vector<std::unique_ptr<std::string>> members_;
};

// The mean of each square of pixels, of encoded colours: a small picture that is only looked at.
Image<Rgb> thumbnail(const Image<Rgb>& picture) {
    const int longer = std::max(picture.width(), picture.height());
    const int side = (longer + kThumbnail - 1) / kThumbnail;
    Image<Rgb> small((picture.width() + side - 1) / side, (picture.height() + side - 1) / side);
    for (int y = 0; y < small.height(); ++y)
        for (int x = 0; x < small.width(); ++x) {
            Rgb sum(0);
            const int x1 = std::min((x + 1) * side, picture.width()),
                      y1 = std::min((y + 1) * side, picture.height());
            for (int py = y * side; py < y1; ++py)
                for (int px = x * side; px < x1; ++px) sum += picture(px, py);
            small(x, y) = sum / static_cast<float>((x1 - x * side) * (y1 - y * side));
        }
    return small;
}

std::string xml_text(std::string words) {
    std::erase_if(words,
                  [](char c) { return static_cast<unsigned char>(c) < ' '; });  // XML does not allow them
    return escaped(words);
}

std::string png_of(const LayerPicture& layer) {
    return layer.thickness_mm.empty() ? png_bytes(layer.srgb) : png_bytes(layer.srgb, layer.alpha);
}

nlohmann::json volumes_of(const Canvas& canvas, const PaintLayer& paint) {
    nlohmann::json volumes = nlohmann::json::array();
    const auto mm3 = volumes_mm3(paint, canvas.ingredients().size(), canvas.mm_per_pixel());
    for (std::size_t i = 0; i < mm3.size(); ++i)
        if (mm3[i] > 0) volumes.push_back(in_words(canvas.ingredients()[i], mm3[i]));
    return volumes;
}

// Heights as 0..1, and where 0 and 1 are.
Image<float> stretched(Image<float> height_mm, float& low_mm, float& high_mm) {
    const auto [low, high] = std::minmax_element(height_mm.pixels().begin(), height_mm.pixels().end());
    low_mm = *low;
    high_mm = *high;
    const float span = high_mm > low_mm ? high_mm - low_mm : 1.0f;
    const float from = *low;
    for (float& mm : height_mm.pixels()) mm = (mm - from) / span;
    return height_mm;
}

// Fills the file beside the archive that becomes its member. What goes wrong is told of the archive.
void fill_beside(const AtomicFile& painting, const AtomicFile& archive, const Canvas& canvas,
                 const Progress& progress, std::span<const PartToWrite> further) {
    try {
        fill_canvas(painting, canvas, progress, further);
    } catch (const Error& error) {
        std::string words = error.what();
        const std::string name = painting.target().string();
        if (const auto at = words.find(name); at != std::string::npos)
            words.replace(at, name.size(), archive.target().string());
        throw Error(words);
    }
}

}  // namespace

void write_ora(AtomicFile& file, const Canvas& canvas, const Progress& progress,
               std::span<const PartToWrite> further) {
    Archive archive(file);
    archive.add("mimetype", "image/openraster");  // first and stored: programs look for it at byte 38

    const std::vector<LayerPicture> layers = layer_pictures(canvas, {}, progress);
    std::string stack = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<image version=\"0.0.5\" w=\"{}\" h=\"{}\" xres=\"{}\" yres=\"{}\">\n<stack>\n",
        canvas.width(), canvas.height(), std::lround(25.4 / canvas.mm_per_pixel()),
        std::lround(25.4 / canvas.mm_per_pixel()));
    for (std::size_t i = layers.size(); i-- > 0;)  // the topmost first
        stack += fmt::format(
            "  <layer name=\"{}\" src=\"data/layer{}.png\" x=\"0\" y=\"0\" opacity=\"1.0\" "
            "visibility=\"visible\" composite-op=\"svg:src-over\"/>\n",
            xml_text(layers[i].name), i);
    archive.add("stack.xml", stack + "</stack>\n</image>\n", true);
    for (std::size_t i = 0; i < layers.size(); ++i)
        archive.add(fmt::format("data/layer{}.png", i), png_of(layers[i]));
    const Image<Rgb> merged = laid_over(layers);
    archive.add("mergedimage.png", png_bytes(merged));
    archive.add("Thumbnails/thumbnail.png", png_bytes(thumbnail(merged)));

    const Surface painted = appearance(canvas, {}, progress);
    float low_mm = 0, high_mm = 0;
    Image<float> height = painted.height_mm;
    for (float& h : height.pixels()) h *= static_cast<float>(canvas.height_unit_mm());
    archive.add("tangipaint/height.png", png_bytes(stretched(std::move(height), low_mm, high_mm)));
    nlohmann::json about = scale_in_words(canvas);
    about.update({{"format", "tangipaint painting"},
                  {"software", program_name()},
                  {"version", 1},
                  {"height_low_mm", shortest(low_mm)},
                  {"height_high_mm", shortest(high_mm)},
                  {"layers", nlohmann::json::array()}});
    for (const DriedLayer& dried : canvas.dried())
        about["layers"].push_back({{"name", dried.name}, {"paint", volumes_of(canvas, dried.paint)}});
    about["layers"].push_back({{"name", "wet"}, {"paint", volumes_of(canvas, canvas.wet())}});
    archive.add("tangipaint/painting.json", json_lines(about), true);
    const AtomicFile painting(file.target().string() +
                              ".exr");  // not committed: gone when the archive is done
    fill_beside(painting, file, canvas, progress, further);
    archive.add_file("tangipaint/painting.exr", painting.temporary());
    archive.close();
    file.commit();
}

}  // namespace tangi
