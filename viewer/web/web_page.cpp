#include "viewer/web/web_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "surface/base/html_escape.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"
#include "viewer/render/view.h"
#include "viewer/web/lossy_tiles.h"
#include "viewer/web/page_parts.h"
#include "viewer/web/web_data.h"
#include "viewer/web/web_page_html.h"
#include "viewer/web/web_tiles.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// Keys of web_picture_data() that differ between states.
constexpr std::array kOfState = {"range", "reflectance_model", "specular_colour", "anisotropic_specular"};

constexpr std::array kPackings = {"colour", "grey", "exact"};  // as Packing has them

json fields(const TexelRange& range) {
    json all = json::array();
    for (const WebField& f : web_fields(range))
        all.push_back({{"word", f.word},
                       {"shift", f.shift},
                       {"bits", f.bits},
                       {"kept", f.kept},
                       {"packing", kPackings[static_cast<std::size_t>(f.packing)]}});
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

// What the largest codes stand for in all states: what is alike in two of them becomes the same bytes.
TexelRange range_of_all(std::span<const WebState> states) {
    TexelRange all = range_of(*states.front().surface);
    for (const WebState& state : states.subspan(1)) {
        const TexelRange range = range_of(*state.surface);
        all.diffuse_max = std::max(all.diffuse_max, range.diffuse_max);
        all.specular_max = std::max(all.specular_max, range.specular_max);
        all.height_min_mm = std::min(all.height_min_mm, range.height_min_mm);
        all.height_max_mm = std::max(all.height_max_mm, range.height_max_mm);
        all.coloured_specular |= range.coloured_specular;
        all.anisotropic_specular |= range.anisotropic_specular;
    }
    return all;
}

// What a page knows of all states, and moves to each: which parts are its own is known once they are written.
json data_of(const Surface& s, const TexelRange& range, const WebWords& words, const WebOptions& options) {
    json data = web_picture_data(s, range, heights_of(s));
    for (const char* key : kOfState) data.erase(key);
    data.update({{"title", words.title},
                 {"credit", words.credit},
                 {"creator", words.creator},
                 {"id", words.id.empty() ? words.title : words.id},
                 {"annotations", words.annotations},
                 {"origins", words.origins},
                 {"origin", origin(s)},
                 {"states", json::array()},
                 {"light_deg", {options.light_azimuth_deg, options.light_elevation_deg}}});
    return data;
}

json data_of_state(const WebState& state, const TexelRange& range, const HorizonMap& horizon) {
    const json all = web_picture_data(*state.surface, range, heights_of(*state.surface));
    json data = {{"name", state.name},
                 {"fields", fields(range)},
                 {"horizon", {horizon.width, horizon.height, HorizonMap::kAzimuths}}};
    for (const char* key : kOfState) data[key] = all[key];
    return data;
}

std::string page_with(const json& data, const json& linked, const std::string& parts) {
    std::string page = kWebPageHtml;
    const std::string head = linked.is_null()
                                 ? ""
                                 : fmt::format("<script type=\"application/ld+json\">{}</script>",
                                               inside_script(json_line(linked)));
    // The last place first: what is put in may contain anything.
    for (const auto& [mark, text] : {std::pair<std::string, std::string>{"{{parts}}", parts},
                                     {"{{data}}", inside_script(json_line(data))},
                                     {"{{linked}}", head},
                                     {"{{program}}", program_name()}}) {
        const std::size_t at = page.rfind(mark);
        TP_REQUIRE(at != std::string::npos, "the page has a place for its data");
        page.replace(at, mark.size(), text);
    }
    return page;
}

// The parts of one state after the other. What a state has of the one before it is not written again.
class StatesOfPage {
public:
    StatesOfPage(PageParts& parts, std::size_t states, WebReport& report, const Progress& progress)
        : parts_(parts), states_(states), report_(report), progress_(progress) {}

    // With losses, of the quality that the first state needs.
    void lose(const WebOptions& options, const Surface& first, const TexelTiles& tiles) {
        if (!(options.lossy_psnr_db > 0) || lossy()) return;
        const double azimuth = options.light_azimuth_deg;
        for (const auto& [turn, elevation] :
             {std::pair{0.0, options.light_elevation_deg}, {0.0, 15.0}, {90.0, 15.0}})
            lights_.push_back(distant_light(direction_of(azimuth + turn, elevation)));
        report_.jpeg_quality = quality_for(options.lossy_psnr_db, first, tiles, lights_);
    }

    // The names of the parts that are the state's own; null of the first, of which all are.
    json add(const Surface& surface, const TexelTiles& tiles, const HorizonMap& horizon) {
        own_ = json::array();
        const std::vector<TileName> places = places_of(tiles);
        const int count = static_cast<int>(places.size());
        std::vector<LossyError> errors(places.size());
        constexpr int kAtOnce = 32;  // so that progress is told, and can be cancelled
        for (int first = 0; first < count; first += kAtOnce) {
            tangi::report(progress_, "tiles",
                          (static_cast<double>(state_) + first / static_cast<double>(count)) /
                              static_cast<double>(states_));
            parallel_for(first, std::min(first + kAtOnce, count), 1, [&](int begin, int end) {
                for (int i = begin; i < end; ++i) {
                    const TileName& p = places[static_cast<std::size_t>(i)];
                    put(fmt::format("{}/{}_{}", p.level, p.column, p.row),
                        packed(surface, tiles, p, errors[static_cast<std::size_t>(i)]), i == 0);
                }
            });
        }
        for (const LossyError& error : errors) error_ += error;  // in one order, for any number of threads
        if (!horizon.values.empty())
            put("horizon", lossy() ? lossy_horizon(horizon, report_.jpeg_quality) : web_horizon(horizon),
                false);
        std::sort(own_.begin(), own_.end());
        return state_++ == 0 ? json() : own_;
    }

    // What was lost, in all states.
    void tell_losses() const {
        if (!lossy()) return;
        report_.psnr_db = error_.psnr_db();
        report_.height_rms = error_.height_rms();
    }

private:
    bool lossy() const { return report_.jpeg_quality > 0; }
    std::string packed(const Surface& surface, const TexelTiles& tiles, const TileName& name,
                       LossyError& error) const {
        if (!lossy()) return web_tile(tiles, name);
        std::string bytes = lossy_tile(tiles, name, report_.jpeg_quality);
        if (name.level == 0) error = error_of(bytes, surface, tiles, name, lights_);
        return bytes;
    }
    static std::vector<TileName> places_of(const TexelTiles& tiles) {
        std::vector<TileName> places;
        for (int level = web_levels(tiles.width(), tiles.height()) - 1; level >= 0; --level) {
            const LevelSize size = level_size(tiles.width(), tiles.height(), level);
            for (int row = 0; row < size.rows(); ++row)
                for (int column = 0; column < size.columns(); ++column)
                    places.push_back({level, column, row});
        }
        return places;
    }
    void put(const std::string& name, const std::string& bytes, bool coarsest) {
        const std::string hash = states_ > 1 ? sha256_of(bytes) : "";
        {
            const std::lock_guard lock(mutex_);
            std::string& before = hashes_[name];
            if (state_ > 0 && before == hash) {
                report_.shared_tiles += name != "horizon";
                return;
            }
            before = hash;
            own_.push_back(name);
        }
        const std::size_t sent =
            parts_.add(state_ == 0 ? name : fmt::format("state{}/{}", state_, name), bytes);
        const std::lock_guard lock(mutex_);
        report_.bytes += sent;
        report_.tiles += name != "horizon";
        // Of two that are compared, both are seen at first: the first and the last.
        if (coarsest && (state_ == 0 || state_ + 1 == states_)) report_.first_bytes += sent;
    }

    PageParts& parts_;
    std::size_t states_, state_ = 0;
    WebReport& report_;
    const Progress& progress_;
    std::vector<Light> lights_;  // that losses are measured under
    LossyError error_;
    std::mutex mutex_;
    std::map<std::string, std::string>
        hashes_;  // of the state before, and of this one as far as it is written
    json own_;
};

HorizonMap horizon_of(const Surface& s, const WebOptions& options, const Progress& progress) {
    if (options.shadow_side <= 0 || s.width() < 2 || s.height() < 2) return {};
    return horizon_map(coarse_heights(s.height_mm, s.mm_per_pixel, options.shadow_side), progress);
}

}  // namespace

WebReport write_web_page(const fs::path& path, std::span<const WebState> states, const WebWords& words,
                         const WebOptions& options, const Progress& progress) {
    TP_REQUIRE(!states.empty(), "a page shows something");
    validate(options);
    const Surface& first = *states.front().surface;
    for (const WebState& state : states) {
        require_consistent(*state.surface);
        TP_REQUIRE(state.surface->width() == first.width() && state.surface->height() == first.height(),
                   "states are of the same pixels");
    }
    if (first.width() < 1 || first.height() < 1) fail("{}: the painting has no pixels", path.string());
    const bool single = lower_extension(path) == ".html";
    WebReport report;
    std::optional<PartsInside> inside;
    std::optional<PartsBeside> beside;
    if (single)
        inside.emplace(path, options.largest_page_mb);
    else
        beside.emplace(path);
    AtomicFile page(single ? path : path / "index.html");
    const TexelRange range = range_of_all(states);
    json data = data_of(first, range, words, options);
    StatesOfPage pages(single ? static_cast<PageParts&>(*inside) : *beside, states.size(), report, progress);
    for (const WebState& state : states) {
        const HorizonMap horizon = horizon_of(*state.surface, options, progress);
        data["states"].push_back(data_of_state(state, range, horizon));
        const TexelTiles tiles(*state.surface, range);
        pages.lose(options, *state.surface, tiles);
        data["states"].back()["own"] = pages.add(*state.surface, tiles, horizon);
    }
    pages.tell_losses();
    if (report.jpeg_quality > 0)
        data["lossy"] = {{"psnr_db", report.psnr_db}, {"height_rms", report.height_rms}};
    tangi::report(progress, "tiles", 1);
    const std::string text = page_with(data, words.linked, single ? inside->text() : "");
    page.write(text);
    report.levels = web_levels(first.width(), first.height());
    report.bytes = single ? text.size() : report.bytes + text.size();
    report.first_bytes = single ? text.size() : report.first_bytes + text.size();
    if (single) {
        page.commit();
    } else {
        beside->place_with(page);
        report.files.push_back(path / "parts");
    }
    report.files.insert(report.files.begin(), page.target());
    return report;
}

WebReport write_web_page(const fs::path& path, const Surface& surface, const WebWords& words,
                         const WebOptions& options, const Progress& progress) {
    // Not its owner: it outlives the call.
    const WebState one{words.title, std::shared_ptr<const Surface>(std::shared_ptr<void>(), &surface)};
    return write_web_page(path, std::span(&one, 1), words, options, progress);
}

}  // namespace tangi
