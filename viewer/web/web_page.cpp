#include "viewer/web/web_page.h"

#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>

#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/base64.h"
#include "surface/file/output_set.h"
#include "surface/file/stale_temporaries.h"
#include "surface/image_file/image_io.h"
#include "viewer/render/painting_shader.h"
#include "viewer/render/scene.h"
#include "viewer/render/vertex_shader.h"
#include "viewer/render/view_mode.h"
#include "viewer/web/web_page_html.h"
#include "viewer/web/web_tiles.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// Where the parts of a page go: into the page, or into files beside it.
class Parts {
public:
    virtual ~Parts() = default;
    // From any thread. Returns how many bytes it takes as it is sent.
    virtual std::size_t add(const std::string& name, const std::string& bytes) = 0;
};

// <script type="text/plain"> is not run and not shown: text that the page looks up by its id.
class PartsInside : public Parts {
public:
    PartsInside(const fs::path& page, double largest_mb) : page_(page), largest_mb_(largest_mb) {}
    std::size_t add(const std::string& name, const std::string& bytes) override {
        const std::string element =
            fmt::format("<script type=\"text/plain\" id=\"part-{}\">{}</script>\n", name, base64(bytes));
        const std::lock_guard lock(mutex_);
        elements_[name] = element;
        size_ += element.size();
        if (static_cast<double>(size_) > 1e6 * largest_mb_)
            fail(
                "{}: the painting takes more than {} MB, too much for a page of one file; name a folder, "
                "from "
                "which browsers fetch what they show, or raise --largest-page-mb",
                page_.string(), largest_mb_);
        return element.size();
    }
    std::string text() const {  // in the order of their names, whatever thread was first
        std::string all;
        for (const auto& [name, element] : elements_) all += element;
        return all;
    }

private:
    fs::path page_;
    double largest_mb_;
    std::mutex mutex_;
    std::map<std::string, std::string> elements_;
    std::size_t size_ = 0;
};

// parts/<name>.js, each a call with its name and its bytes; in a hidden folder until place().
class PartsBeside : public Parts {
public:
    explicit PartsBeside(const fs::path& folder)
        : folder_(folder), hidden_(folder / temporary_name("parts", "")) {
        made_.make(folder_);
        tidy_folder(folder_);
        make_folder(hidden_);
    }
    ~PartsBeside() override {
        std::error_code ignored;
        if (!left_) fs::remove_all(hidden_, ignored);
    }
    std::size_t add(const std::string& name, const std::string& bytes) override {
        const fs::path path = hidden_ / (name + ".js");
        const std::string text = fmt::format("tangiPart('{}','{}');\n", name, base64(bytes));
        make_folder(path.parent_path());
        told_of(hidden_, folder_ / "parts", [&] { write_text_file(path, text); });
        return text.size();
    }
    // The old parts are gone once the new ones are there, with the page that wants them.
    void place_with(AtomicFile& page) {
        OutputSet set;
        set.add_folder(hidden_, folder_ / "parts", [&](bool cleaned) {
            made_.keep();
            left_ = !cleaned;
        });
        set.add(page);
        set.commit();
    }

private:
    fs::path folder_, hidden_;
    MadeFolders made_;
    bool left_ = false;
};

json fields(const TexelRange& range) {
    json all = json::array();
    for (const WebField& f : web_fields(range))
        all.push_back({{"word", f.word}, {"shift", f.shift}, {"bits", f.bits}, {"kept", f.kept}});
    return all;
}

// View modes in the order of their numbers: names, and what the scale of each begins and ends with.
json looks(const Surface& s) {
    const auto [low, high] = std::minmax_element(s.height_mm.pixels().begin(), s.height_mm.pixels().end());
    Scene scene;
    scene.lowest_mm = *low;
    scene.highest_mm = *high;
    scene.most_curvature = first_most_curvature(s.mm_per_pixel);
    json all = json::array();
    for (const ViewModeTraits& mode : view_modes()) {
        scene.mode = mode.mode;
        const ScaleEnds ends = scale_ends(scene);
        all.push_back({{"name", mode.name}, {"ends", {ends.lowest, ends.highest}}});
    }
    return all;
}

// Program and version of whatever the painting came from, for the page's caption.
json origin(const Surface& surface) {
    const json provenance = json_or_discarded(surface.provenance);
    json told = json::object();
    if (provenance.is_object())
        for (const char* key : {"program", "version", "command"})
            if (provenance.contains(key)) told[key] = provenance[key];
    const auto& photos = surface.photography.photos;
    told["photographs"] =
        std::count_if(photos.begin(), photos.end(), [](const auto& photo) { return photo.fitted; });
    return told;
}

json data_of(const Surface& s, const TexelTiles& tiles, const HorizonMap& horizon, const WebWords& words,
             const WebOptions& options) {
    const TexelRange& range = tiles.range();
    return {{"title", words.title},
            {"credit", words.credit},
            {"origin", origin(s)},
            {"width", s.width()},
            {"height", s.height()},
            {"mm_per_pixel", s.mm_per_pixel},
            {"scale_known", s.scale_known},
            {"range",
             {range.diffuse_max, range.specular_max, range.height_min_mm,
              range.height_max_mm - range.height_min_mm}},
            {"reflectance_model",
             {s.reflectance_model.diffuse_roughness, s.reflectance_model.second_lobe_weight}},
            {"specular_colour", range.coloured_specular},
            {"anisotropic_specular", range.anisotropic_specular},
            {"levels", web_levels(s.width(), s.height())},
            {"fields", fields(range)},
            {"looks", looks(s)},
            {"horizon", {horizon.width, horizon.height, HorizonMap::kAzimuths}},
            {"light_deg", {options.light_azimuth_deg, options.light_elevation_deg}},
            {"vertex_shader", kPaintingVertexShader},
            {"fragment_shader", painting_fragment_shader()}};
}

// Inside <script>, only "<" could end the text early; JSON lets it be written as an escape.
std::string inert(const json& data) {
    std::string text;
    for (const char c : json_line(data)) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return text;
}

std::string page_with(const json& data, const std::string& parts) {
    std::string page = kWebPageHtml;
    // The last place first: what is put in may contain anything.
    for (const auto& [mark, text] :
         {std::pair<std::string, std::string>{"{{parts}}", parts}, {"{{data}}", inert(data)}}) {
        const std::size_t at = page.rfind(mark);
        TP_REQUIRE(at != std::string::npos, "the page has a place for its data");
        page.replace(at, mark.size(), text);
    }
    return page;
}

void add_parts(Parts& parts, const TexelTiles& tiles, const HorizonMap& horizon, WebReport& report,
               const Progress& progress) {
    std::vector<TileName> places;
    const int levels = web_levels(tiles.width(), tiles.height());
    for (int level = levels - 1; level >= 0; --level) {
        const LevelSize size = level_size(tiles.width(), tiles.height(), level);
        for (int row = 0; row < size.rows(); ++row)
            for (int column = 0; column < size.columns(); ++column) places.push_back({level, column, row});
    }
    constexpr int kAtOnce = 32;  // so that progress is told, and can be cancelled
    std::atomic<std::size_t> bytes = 0;
    const int count = static_cast<int>(places.size());
    for (int first = 0; first < count; first += kAtOnce) {
        tangi::report(progress, "tiles", first / static_cast<double>(count));
        parallel_for(first, std::min(first + kAtOnce, count), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                const TileName& p = places[static_cast<std::size_t>(i)];
                const std::size_t sent =
                    parts.add(fmt::format("{}/{}_{}", p.level, p.column, p.row), web_tile(tiles, p));
                bytes += sent;
                if (i == 0) report.first_bytes = sent;
            }
        });
    }
    if (!horizon.values.empty()) bytes += parts.add("horizon", web_horizon(horizon));
    report.levels = levels;
    report.tiles = count;
    report.bytes = bytes;
    tangi::report(progress, "tiles", 1);
}

}  // namespace

WebReport write_web_page(const fs::path& path, const Surface& surface, const WebWords& words,
                         const WebOptions& options, const Progress& progress) {
    require_consistent(surface);
    validate(options);
    if (surface.width() < 1 || surface.height() < 1) fail("{}: the painting has no pixels", path.string());
    const bool single = lower_extension(path) == ".html";
    WebReport report;
    std::optional<PartsInside> inside;
    std::optional<PartsBeside> beside;
    if (single)
        inside.emplace(path, options.largest_page_mb);
    else
        beside.emplace(path);
    AtomicFile page(single ? path : path / "index.html");
    Parts& parts = single ? static_cast<Parts&>(*inside) : *beside;
    const TexelTiles tiles(surface, range_of(surface));
    HorizonMap horizon;
    if (options.shadow_side > 0 && surface.width() > 1 && surface.height() > 1)
        horizon = horizon_map(coarse_heights(surface.height_mm, surface.mm_per_pixel, options.shadow_side),
                              progress);
    add_parts(parts, tiles, horizon, report, progress);
    const std::string text =
        page_with(data_of(surface, tiles, horizon, words, options), single ? inside->text() : "");
    page.write(text);
    if (single) {
        report.bytes = report.first_bytes = text.size();
    } else {
        report.bytes += text.size();
        report.first_bytes += text.size();
        beside->place_with(page);
        report.files.push_back(path / "parts");
    }
    if (single) page.commit();
    report.files.insert(report.files.begin(), page.target());
    return report;
}

}  // namespace tangi
