#include "paint/retouch/treatment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "paint/canvas_file.h"
#include "paint/retouch/sha256.h"
#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr const char* kLog = "log.jsonl";
constexpr const char* kMasks = "masks";
constexpr const char* kEarlier = "earlier.exr";

fs::path mask_path(const std::string& name) { return fs::path(kMasks) / (name + ".png"); }
// Where the one that a line of the log wrote is kept when another takes its place.
fs::path kept_path(const std::string& name, int line) {
    return fs::path(kMasks) / "earlier" / fmt::format("{}.{}.png", name, line);
}

json to_json(const TreatmentLayer& layer) {
    return {{"name", layer.name}, {"role", name_of(layer.role)}, {"sha256", layer.sha256}};
}

const DriedLayer* find(const Canvas& canvas, const std::string& name) {
    for (const DriedLayer& layer : canvas.dried())
        if (layer.name == name) return &layer;
    return nullptr;
}

void add_name(Sha256& sha, std::string_view name) {
    sha.add(name);
    sha.add("\0", 1);
}

template <class Number>
void add_numbers(Sha256& sha, std::span<const Number> numbers) {
    sha.add(numbers.data(), numbers.size_bytes());
}

void copy_whole(const fs::path& from, const fs::path& to) {
    AtomicFile file(to);
    std::error_code error;
    fs::copy_file(from, file.temporary(), fs::copy_options::overwrite_existing, error);
    if (error)
        fail("{}: cannot be copied to {}: {}", from.string(), to.parent_path().string(), error.message());
    file.commit();
}

// Into a folder of the treatment only: names come from logs and callers.
void require_inside(const std::string& path) {
    const fs::path p(path);
    TP_REQUIRE(!path.empty() && p.is_relative(), "a step keeps its files in the treatment's folder");
    for (const fs::path& part : p)
        TP_REQUIRE(part != "..", "a step keeps its files in the treatment's folder");
}

void require_logged(const fs::path& file, const std::string& sha256, int line) {
    if (!fs::exists(file) || sha256_of_file(file) != sha256)
        fail("{}: is not what line {} of the log wrote; take it from a backup", file.string(), line);
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
    if (!surface.lobe_colour.empty()) add("lobe", surface.lobe_colour);
    if (!surface.lobe_axes.empty()) add("lobe_axes", surface.lobe_axes);
    return sha.hex();
}

std::string sha256_of(const Canvas& canvas, const PaintLayer& layer) {
    Sha256 sha;
    for (const TileIndex at : layer.painted()) {
        const PaintTile& tile = *layer.tile(at);
        for (const IngredientId id : tile.ingredients) {
            const auto plane = tile.plane(id);
            if (std::all_of(plane.begin(), plane.end(), [](float mm) { return mm == 0; })) continue;
            const std::array<std::int32_t, 2> place = {at.x, at.y};
            add_numbers(sha, std::span<const std::int32_t>(place));
            const Pigment& paint = canvas.ingredients()[id];
            add_name(sha, paint.name);
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

Treatment Treatment::begin(const fs::path& folder, const fs::path& painting, const Author& author,
                           std::optional<double> mm_per_pixel, const Progress& progress) {
    if (fs::exists(folder / kLog))
        fail("{}: holds a treatment already; go on with it, or choose another folder", folder.string());
    const Canvas canvas = tangi::read_canvas(painting, progress, mm_per_pixel);
    if (!canvas.ingredients().empty())
        fail("{}: has been painted on; a treatment begins with a painting as it was fitted",
             painting.string());
    make_folder(folder / kMasks);
    copy_whole(painting, folder / "painting.exr");
    json first = {{"action", "begin"},
                  {"time", utc_now()},
                  {"who", author.who},
                  {"tool", author.tool},
                  {"painting", painting.filename().string()},
                  {"inputs", {{painting.filename().string(), sha256_of_file(painting)}}},
                  {"width", canvas.width()},
                  {"height", canvas.height()},
                  {"mm_per_pixel", canvas.mm_per_pixel()},
                  {"scale_known", canvas.dry().scale_known || mm_per_pixel.has_value()},
                  {"dry_hash", hash_of(canvas.dry())},
                  {"dry_sha256", sha256_of(canvas.dry())},
                  {"layers", json::array()}};
    return Treatment(folder, TreatmentLog::begin(folder / kLog, std::move(first)));
}

Treatment Treatment::open(const fs::path& folder) {
    if (!fs::is_regular_file(folder / kLog))
        fail("{}: is no treatment (there is no {} in it); tangipaint damage P.exr --treatment {} begins one",
             folder.string(), kLog, folder.string());
    Treatment treatment(folder, TreatmentLog::open(folder / kLog));
    const json& first = treatment.log_.entries().front().content;
    for (const char* field : {"width", "height", "mm_per_pixel", "dry_sha256"})
        if (!first.contains(field)) fail("{}:1: has no field '{}'", (folder / kLog).string(), field);
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
    return faults;
}

Canvas Treatment::read_canvas(const Progress& progress) const {
    std::optional<double> scale;
    if (scale_known()) scale = mm_per_pixel();
    Canvas canvas = tangi::read_canvas(painting(), progress, scale);
    if (sha256_of(canvas.dry()) != dry_sha256())
        fail("{}: its dry layer is not the painting's that the treatment began with; take it from a backup",
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
        if (fs::path(path).parent_path() == kMasks) names.push_back(fs::path(path).stem().string());
    return names;
}

bool Treatment::has_mask(DamageClass damage) const {
    return logged_files().contains(mask_path(std::string(name_of(damage))).generic_string());
}

Mask Treatment::mask(const std::string& name) const {
    const auto files = logged_files();
    const auto found = files.find(mask_path(name).generic_string());
    if (found == files.end()) return Mask(width(), height());
    const fs::path path = folder_ / mask_path(name);
    if (sha256_of_file(path) != found->second.first)
        fail(
            "{}: is not the mask that line {} of the log wrote; put that one back, and bring in what you "
            "changed with tangipaint damage --mask, so that it is logged",
            path.string(), found->second.second);
    return read_mask(path, width(), height());
}

void Treatment::record(const TreatmentStep& step, const Author& author, const Progress& progress) {
    json outputs = json::object(), inputs = json::object();
    for (const fs::path& input : step.inputs) inputs[input.filename().string()] = sha256_of_file(input);
    json entry = {{"action", step.action},
                  {"time", utc_now()},
                  {"who", author.who},
                  {"tool", author.tool},
                  {"parameters", step.parameters},
                  {"results", step.results},
                  {"inputs", inputs},
                  {"dry_sha256", dry_sha256()}};
    if (step.canvas) {
        if (sha256_of(step.canvas->dry()) != dry_sha256())
            fail("{}: the dry layer would change; nothing was written", painting().string());
        std::vector<TreatmentLayer> all = layers();
        for (const auto& [name, role] : step.added) all.push_back({name, role, {}});
        entry["layers"] = json::array();
        std::size_t known = 0;
        for (const DriedLayer& layer : step.canvas->dried()) {  // in their order on the canvas
            const auto about = std::find_if(all.begin(), all.end(),
                                            [&](const TreatmentLayer& l) { return l.name == layer.name; });
            if (about == all.end())
                fail(
                    "{}: has a layer '{}' that the log does not know; tangipaint treatment retouch takes in "
                    "what was painted in the window",
                    painting().string(), layer.name);
            entry["layers"].push_back(
                to_json({layer.name, about->role, sha256_of(*step.canvas, layer.paint)}));
            ++known;
        }
        TP_REQUIRE(known >= step.added.size(), "layers that were added are on the canvas");
        const std::vector<PartToWrite> further = parts_beside_paint(painting(), progress);
        AtomicFile file(painting());
        write_canvas(file, *step.canvas, progress, further);
    }
    const auto known = logged_files();
    for (const auto& [name, mask] : step.masks) {
        TP_REQUIRE(mask.width() == width() && mask.height() == height(), "a mask has the painting's size");
        const fs::path path = mask_path(name);
        require_inside(path.generic_string());
        if (const auto before = known.find(path.generic_string()); before != known.end()) {
            const fs::path kept = kept_path(name, before->second.second);
            make_folder(folder_ / kept.parent_path());
            write_mask(folder_ / kept, this->mask(name));
            outputs[kept.generic_string()] = sha256_of_file(folder_ / kept);
            entry["kept"][name] = kept.generic_string();
        }
        write_mask(folder_ / path, mask);
        outputs[path.generic_string()] = sha256_of_file(folder_ / path);
    }
    for (const auto& [name, text] : step.files) {
        require_inside(name);
        make_folder((folder_ / name).parent_path());
        write_text_file(folder_ / name, text);
        outputs[name] = sha256_of_file(folder_ / name);
    }
    for (const std::string& name : step.written) {
        require_inside(name);
        outputs[name] = sha256_of_file(folder_ / name);
    }
    entry["outputs"] = outputs;
    for (const std::string& name : step.withdrawn) require_inside(name);
    if (!step.withdrawn.empty()) entry["withdrawn"] = step.withdrawn;
    if (!step.kept.empty()) entry["kept"].update(step.kept);
    log_.append(std::move(entry));
    std::error_code there_already_not;
    for (const std::string& name : step.withdrawn) fs::remove(folder_ / name, there_already_not);
}

void Treatment::keep_earlier(const fs::path& painting, const Author& author, const Progress& progress) {
    const Surface earlier = read_painted(painting, progress);
    if (earlier.width() != width() || earlier.height() != height())
        fail(
            "{}: has {} x {} pixels, the treatment's painting {} x {}; fit it on the same pixels: tangipaint "
            "calibrate --align-to",
            painting.string(), earlier.width(), earlier.height(), width(), height());
    TreatmentStep step{.action = "keep earlier state",
                       .parameters = {{"painting", painting.filename().string()}},
                       .inputs = {painting},
                       .written = {kEarlier}};
    const auto known = logged_files();
    if (const auto before = known.find(kEarlier); before != known.end()) {
        const std::string kept = fmt::format("earlier.{}.exr", before->second.second);
        require_logged(folder_ / kEarlier, before->second.first, before->second.second);
        copy_whole(folder_ / kEarlier, folder_ / kept);
        step.kept[kEarlier] = kept;
        step.written.push_back(kept);
    }
    copy_whole(painting, folder_ / kEarlier);
    record(step, author, progress);
}

bool Treatment::has_earlier() const { return logged_files().contains(kEarlier); }

void Treatment::take_back_earlier(const LogEntry& entry, TreatmentStep& step) const {
    const json none = json::object(), kept = entry.content.value("kept", none);
    if (!kept.contains(kEarlier)) {
        step.withdrawn.emplace_back(kEarlier);
        return;
    }
    const auto file = kept[kEarlier].get<std::string>();
    require_logged(folder_ / file, entry.content.at("outputs").value(file, ""), entry.line);
    copy_whole(folder_ / file, folder_ / kEarlier);
    step.written.emplace_back(kEarlier);
}

Surface Treatment::read_earlier(const Progress& progress) const {
    TP_REQUIRE(has_earlier(), "an earlier state was kept");
    return read_painted(folder_ / kEarlier, progress);
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
