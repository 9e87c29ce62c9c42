#include "retouch/treatment/treatment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "paint/files/canvas_file.h"
#include "retouch/treatment/treatment_folder.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"
#include "surface/file/sha256.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

const DriedLayer* find(const Canvas& canvas, const std::string& name) {
    for (const DriedLayer& layer : canvas.dried())
        if (layer.name == name) return &layer;
    return nullptr;
}

bool is_among(const std::vector<TreatmentLayer>& layers, const std::string& name) {
    return std::any_of(layers.begin(), layers.end(), [&](const auto& layer) { return layer.name == name; });
}

void add_name(Sha256& sha, std::string_view name) {
    sha.add(name);
    sha.add("\0", 1);
}

// A name for the treatment, where a file was named that was taken for one.
fs::path folder_beside(const fs::path& file) { return fs::path(file).replace_extension(".treatment"); }

template <class Number>
void add_numbers(Sha256& sha, std::span<const Number> numbers) {
    sha.add(numbers.data(), numbers.size_bytes());
}

}  // namespace

std::string sha256_of(const Surface& surface) {
    Sha256 sha;
    const auto add = [&](std::string_view name, const auto& image) {
        add_name(sha, name);
        for (int y = 0; y < image.height(); ++y) sha.add(image.row(y).data(), image.row(y).size_bytes());
    };
    const std::array<std::int32_t, 2> size = {surface.width(), surface.height()};
    add_numbers(sha, std::span<const std::int32_t>(size));
    add("height", surface.height_mm);
    add("normal", surface.normal);
    add("diffuse", surface.diffuse);
    add("specular", surface.specular);
    add("roughness", surface.roughness);
    add("confidence", surface.confidence);
    if (!surface.specular_colour.empty()) add("lobe", surface.specular_colour);
    if (!surface.lobe_axes.empty()) add("lobe_axes", surface.lobe_axes);
    return sha.hex();
}

namespace {

// What is known of the painting as a whole, which relighting and the report go by: its reflectance model and
// its photographs' illuminants.
std::string sha256_of_what_is_known(const Surface& surface) {
    const json about = {
        {"law", {surface.reflectance_model.diffuse_roughness, surface.reflectance_model.second_lobe_weight}},
        {"photography", to_json(surface.photography)}};
    const std::string text = json_line(about);
    Sha256 sha;
    sha.add(text.data(), text.size());
    return sha.hex();
}

// Whether a file is the copy of a painting, which may be a folder of tiles.
bool is_copy(const fs::path& file, const fs::path& painting) {
    if (is_tiled_painting(painting))
        return open_painting(file)->header().dry_hash == open_painting(painting)->header().dry_hash;
    return fs::equivalent(file, painting) || sha256_of_file(file) == sha256_of_file(painting);
}

// The log's first line, but for "scale_known": the painting as it was.
json first_entry(const fs::path& painting, const Canvas& canvas, const Author& author) {
    return {{"action", "begin"},
            {"time", utc_now()},
            {"who", author.who},
            {"tool", author.tool},
            {"painting", painting.filename().string()},
            {"inputs", {{painting.filename().string(), sha256_of_painting(painting)}}},
            {"width", canvas.width()},
            {"height", canvas.height()},
            {"mm_per_pixel", canvas.mm_per_pixel()},
            {"dry_hash", hash_of(canvas.dry())},
            {"dry_sha256", sha256_of(canvas.dry())},
            {"about_sha256", sha256_of_what_is_known(canvas.dry())},
            {"layers", json::array()}};
}

}  // namespace

std::string sha256_of(const Canvas& canvas, const PaintLayer& layer) {
    Sha256 sha;
    for (const TileIndex at : layer.painted()) {
        const PaintTile& tile = *layer.tile(at);
        for (const IngredientId id : tile.ingredients) {
            const auto plane = tile.plane(id);
            if (std::all_of(plane.begin(), plane.end(), [](float mm) { return mm == 0; })) continue;
            const std::array<std::int32_t, 2> place = {at.x, at.y};
            add_numbers(sha, std::span<const std::int32_t>(place));
            const Pigment& paint = canvas.ingredients()[paint_of(id)];
            add_name(sha, is_upper(id) ? "upper film: " + paint.name : paint.name);
            add_numbers(sha, std::span<const float>(paint.k));
            add_numbers(sha, std::span<const float>(paint.s));
            const std::array<float, 2> gloss = {paint.specular, paint.roughness};
            add_numbers(sha, std::span<const float>(gloss));
            // What lies beyond the picture's border in a tile at its edge is in no file.
            const Region region = layer.region_of(at);
            for (int y = 0; y < region.height(); ++y)
                add_numbers(sha, plane.subspan(static_cast<std::size_t>(y * PaintTile::kSize),
                                               static_cast<std::size_t>(region.width())));
        }
    }
    return sha.hex();
}

Treatment Treatment::begin(const fs::path& named, const fs::path& painting, const Author& author,
                           std::optional<double> mm_per_pixel, const Progress& progress) {
    const fs::path folder = named.has_filename() || !named.has_relative_path() ? named : named.parent_path();
    const auto require_free = [&] {
        if (fs::exists(folder / kTreatmentLog))
            fail("{}: holds a treatment already; go on with it, or choose another folder", folder.string());
    };
    require_free();
    if (fs::exists(folder) && !fs::is_directory(folder))
        fail("{}: is a file, and a treatment is a folder; name one that is to be made, such as {}",
             folder.string(), folder_beside(folder).string());
    const Canvas canvas = tangi::read_canvas(painting, progress, mm_per_pixel);
    if (!canvas.ingredients().empty())
        fail("{}: has been painted on; a treatment begins with a painting as it was fitted",
             painting.string());
    MadeFolders made;
    const fs::path parent = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
    made.make(parent);
    const LogHold held(fs::exists(folder)
                           ? folder
                           : parent);  // of two programs that begin at once, the second comes too late
    require_free();
    // What a beginning of an earlier version left that did not come to its end is the same.
    const fs::path copy = folder / kTreatmentPainting;
    const bool is_there = fs::exists(copy);
    if (is_there && !is_copy(copy, painting))
        fail("{}: is another painting, and would be overwritten; choose another folder for the treatment",
             copy.string());
    json first = first_entry(painting, canvas, author);
    first["scale_known"] = canvas.dry().scale_known || mm_per_pixel.has_value();
    FolderFiles written(folder);  // all of it, or none
    told_of(written.temporary(), folder, [&] {
        if (!is_there) copy_whole(painting, written.temporary() / kTreatmentPainting, progress);
        TreatmentLog::begin(written.temporary() / kTreatmentLog, std::move(first));
    });
    written.place();
    made.keep();
    return open(folder);
}

Treatment Treatment::open(const fs::path& folder) {
    if (fs::is_regular_file(folder))
        fail("{}: is a file, and a treatment is a folder; tangipaint damage {} --treatment {} begins one",
             folder.string(), lower_extension(folder) == ".exr" ? folder.string() : "P.exr",
             folder_beside(folder).string());
    if (!fs::is_regular_file(folder / kTreatmentLog))
        fail("{}: is no treatment (there is no {} in it); tangipaint damage P.exr --treatment {} begins one",
             folder.string(), kTreatmentLog, folder.string());
    settle_outputs(folder);
    settle_pending(folder);
    Treatment treatment(folder, TreatmentLog::open(folder / kTreatmentLog));
    require_form(treatment.log_);
    return treatment;
}

int Treatment::width() const { return log_.entries().front().content["width"].get<int>(); }
int Treatment::height() const { return log_.entries().front().content["height"].get<int>(); }
double Treatment::mm_per_pixel() const {
    return log_.entries().front().content["mm_per_pixel"].get<double>();
}
bool Treatment::scale_known() const { return log_.entries().front().content.value("scale_known", false); }
std::string Treatment::dry_sha256() const {
    return log_.entries().front().content["dry_sha256"].get<std::string>();
}

std::vector<TreatmentLayer> Treatment::layers() const {
    std::vector<TreatmentLayer> layers;
    for (auto entry = log_.entries().rbegin(); entry != log_.entries().rend(); ++entry) {
        if (!entry->content.contains("layers")) continue;
        for (const json& layer : entry->content["layers"])
            layers.push_back({layer.at("name").get<std::string>(),
                              layer_role_named(layer.at("role").get<std::string>()).value_or(LayerRole::fill),
                              layer.at("sha256").get<std::string>()});
        break;
    }
    return layers;
}

std::string Treatment::new_layer_name(LayerRole role, bool proposal) const {
    std::set<std::string> taken;
    for (const LogEntry& entry : log_.entries())
        if (entry.content.contains("layers"))
            for (const json& layer : entry.content["layers"])
                taken.insert(layer.at("name").get<std::string>());
    for (int number = 1;; ++number) {
        std::string name = fmt::format("{}{} {}", proposal ? "proposal " : "", name_of(role), number);
        std::replace(name.begin(), name.end(), '_', ' ');
        if (!taken.contains(name)) return name;
    }
}

std::vector<std::string> Treatment::layer_faults(const Canvas& canvas) const {
    std::vector<std::string> faults;
    for (const TreatmentLayer& layer : layers()) {
        const DriedLayer* on_canvas = find(canvas, layer.name);
        if (!on_canvas)
            faults.push_back(fmt::format("layer '{}' is missing", layer.name));
        else if (sha256_of(canvas, on_canvas->paint) != layer.sha256)
            faults.push_back(fmt::format("layer '{}' is not the one that was logged", layer.name));
    }
    if (!faults.empty()) return faults;
    // What lies on what decides how the painting looks.
    const std::vector<TreatmentLayer> logged = layers();
    auto next = logged.begin();
    for (const DriedLayer& layer : canvas.dried()) {
        if (next != logged.end() && layer.name == next->name)
            ++next;
        else if (is_among(logged, layer.name))
            faults.push_back(fmt::format("layer '{}' does not lie where the log has it", layer.name));
    }
    return faults;
}

std::vector<std::string> Treatment::unlogged(const Canvas& canvas) const {
    const std::vector<TreatmentLayer> logged = layers();
    std::vector<std::string> unknown;
    for (const DriedLayer& layer : canvas.dried())
        if (!is_among(logged, layer.name))
            unknown.push_back(
                fmt::format("the painting has a layer '{}' that the log does not know", layer.name));
    if (!canvas.wet().empty()) unknown.emplace_back("the painting has wet paint that is not in the log");
    return unknown;
}

Canvas Treatment::read_canvas(const Progress& progress) const {
    std::optional<double> scale;
    if (scale_known()) scale = mm_per_pixel();
    Canvas canvas = tangi::read_canvas(painting(), progress, scale);
    if (sha256_of(canvas.dry()) != dry_sha256())
        fail("{}: its dry layer is not the painting's that the treatment began with; take it from a backup",
             painting().string());
    // Logs of before it was kept say nothing of it.
    const json& first = log_.entries().front().content;
    if (first.contains("about_sha256") && first["about_sha256"] != sha256_of_what_is_known(canvas.dry()))
        fail(
            "{}: its reflectance model or its illuminants are not those that the treatment began with; take "
            "it "
            "from a backup",
            painting().string());
    const std::vector<std::string> faults = layer_faults(canvas);
    if (!faults.empty()) fail("{}: {}; take the file from a backup", painting().string(), faults.front());
    return canvas;
}

std::map<std::string, std::pair<std::string, int>> Treatment::logged_files() const {
    std::map<std::string, std::pair<std::string, int>> files;
    for (const LogEntry& entry : log_.entries()) {
        if (entry.content.contains("outputs"))
            for (const auto& [name, hash] : entry.content["outputs"].items())
                files[name] = {hash.get<std::string>(), entry.line};
        if (entry.content.contains("withdrawn"))
            for (const json& name : entry.content["withdrawn"]) files.erase(name.get<std::string>());
    }
    return files;
}

std::vector<std::string> Treatment::mask_names() const {
    std::vector<std::string> names;
    for (const auto& [path, hash] : logged_files())
        if (fs::path(path).parent_path() == kTreatmentMasks) names.push_back(fs::path(path).stem().string());
    return names;
}

bool Treatment::has_mask(DamageClass damage) const {
    return logged_files().contains(treatment_mask(std::string(name_of(damage))).generic_string());
}

Mask Treatment::mask(const std::string& name) const {
    const auto files = logged_files();
    const auto found = files.find(treatment_mask(name).generic_string());
    if (found == files.end()) return Mask(width(), height());
    const fs::path path = folder_ / treatment_mask(name);
    if (sha256_of_file(path) != found->second.first) {
        log_.require_unchanged();  // or it is the mask of a line that is not known here
        fail(
            "{}: is not the mask that line {} of the log wrote; put that one back, and bring in what you "
            "changed with tangipaint damage --mask, so that it is logged",
            path.string(), found->second.second);
    }
    return read_mask(path, width(), height());
}

bool Treatment::has_earlier() const { return logged_files().contains(kTreatmentEarlier); }

Surface Treatment::read_earlier(const Progress& progress) const {
    TP_REQUIRE(has_earlier(), "an earlier state was kept");
    const auto logged = logged_files().at(kTreatmentEarlier);
    require_logged(folder_ / kTreatmentEarlier, logged.first, logged.second);
    return read_painted(folder_ / kTreatmentEarlier, progress);
}

std::vector<std::string> Treatment::check(const Progress& progress) const {
    std::vector<std::string> faults;
    for (const auto& [name, logged] : logged_files()) {
        const fs::path path = folder_ / name;
        if (!fs::exists(path))
            faults.push_back(
                fmt::format("{} is missing (line {} of the log wrote it)", path.string(), logged.second));
        else if (sha256_of_file(path) != logged.first)
            faults.push_back(
                fmt::format("{} is not what line {} of the log wrote", path.string(), logged.second));
    }
    try {
        (void)read_canvas(progress);
    } catch (const Error& error) {
        faults.emplace_back(error.what());
    }
    return faults;
}

}  // namespace tangi
