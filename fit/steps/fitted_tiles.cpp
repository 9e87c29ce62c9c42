#include "fit/steps/fitted_tiles.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "fit/steps/block_file.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "surface/maps/surface_part.h"

namespace tangi {

using nlohmann::json;

namespace {

// Calls visit(name, map, map of `others`) for each map that is stored of pixels.
template <class Pixels, class Others, class Visit>
void each_map(Pixels& pixels, Others& others, const Visit& visit) {
    auto &s = pixels.surface, &t = others.surface;
    auto &e = pixels.errors, &f = others.errors;
    visit("height", s.height_mm, t.height_mm);
    visit("normal", s.normal, t.normal);
    visit("diffuse", s.diffuse, t.diffuse);
    visit("specular", s.specular, t.specular);
    visit("roughness", s.roughness, t.roughness);
    visit("confidence", s.confidence, t.confidence);
    visit("specular_colour", s.specular_colour, t.specular_colour);
    visit("lobe_axes", s.lobe_axes, t.lobe_axes);
    visit("error.slope", e.slope, f.slope);
    visit("error.diffuse", e.diffuse, f.diffuse);
    visit("error.specular", e.specular, f.specular);
    visit("error.roughness", e.roughness, f.roughness);
}

// Lights of a part's rows within columns x0 <= x < x1, counted from x0.
struct LightRows {
    std::vector<std::uint32_t> counts;  // of each row
    std::vector<SeenLight> lights;
};
LightRows lights_in(const LightVisibility& all, const Region& part) {
    LightRows rows;
    for (int y = part.y0; y < part.y1; ++y) {
        const std::size_t before = rows.lights.size();
        for (SeenLight light : all.row(y)) {
            const int x = static_cast<int>(light.x);
            if (x < part.x0 || x >= part.x1) continue;
            light.x = static_cast<std::uint32_t>(x - part.x0);
            rows.lights.push_back(light);
        }
        rows.counts.push_back(static_cast<std::uint32_t>(rows.lights.size() - before));
    }
    return rows;
}

json json_of(const PassCounts& counts) {
    const SolverAgreement& s = counts.solvers;
    return {{"fitted", counts.fitted},
            {"not_converged", counts.not_converged},
            {"solvers", {s.compared, s.cost_agrees, s.cheaper, s.slope_agrees, s.doubtful, s.polished}}};
}

PassCounts counts_from(const json& j) {
    const json& s = j.at("solvers");
    return {.fitted = j.at("fitted"),
            .not_converged = j.at("not_converged"),
            .solvers = {s.at(0), s.at(1), s.at(2), s.at(3), s.at(4), s.at(5)}};
}

int number_of_tile(const std::string& word, const std::string& range) {
    int number = -1;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (status != std::errc() || end != word.data() + word.size() || number < 0)
        fail("--tiles {}: \"{}\" is no number of a tile; give all, 7, 0-15, or 3,8-11", range, word);
    return number;
}

// From the first to the last of each; none of "all".
std::vector<std::pair<int, int>> ranges_in(const std::string& range) {
    std::vector<std::pair<int, int>> ranges;
    for (std::size_t at = 0; range != "all" && at <= range.size();) {
        const std::size_t end = std::min(range.find(',', at), range.size());
        const std::string words = range.substr(at, end - at);
        const std::size_t dash = words.find('-');
        const int first = number_of_tile(words.substr(0, dash), range);
        const int last = dash == std::string::npos ? first : number_of_tile(words.substr(dash + 1), range);
        if (last < first) fail("--tiles {}: {} comes after {}; give {}-{}", range, first, last, last, first);
        ranges.emplace_back(first, last);
        at = end + 1;
    }
    return ranges;
}

}  // namespace

Region FitTiles::region(int number) const {
    const int x0 = number % columns() * side, y0 = number / columns() * side;
    return {x0, y0, std::min(x0 + side, width), std::min(y0 + side, height)};
}

FitTiles tiles_of(const PlanFile& plan) { return {plan.width(), plan.height(), plan.tile_pixels()}; }

void require_tile_numbers(const std::string& range) { (void)ranges_in(range); }

std::vector<int> tiles_named(const std::string& range, int count) {
    std::vector<bool> named(static_cast<std::size_t>(count), range == "all");
    for (const auto& [first, last] : ranges_in(range)) {
        if (last >= count)
            fail("--tiles {}: there is no tile {}; the plan has 0 to {}", range, last, count - 1);
        for (int i = first; i <= last; ++i) named[static_cast<std::size_t>(i)] = true;
    }
    std::vector<int> numbers;
    for (int i = 0; i < count; ++i)
        if (named[static_cast<std::size_t>(i)]) numbers.push_back(i);
    return numbers;
}

std::filesystem::path folder_of_tiles(const std::filesystem::path& plan) {
    return std::filesystem::path(plan).replace_extension(".tiles");
}

FittedTiles::FittedTiles(std::filesystem::path folder, const PlanFile& plan)
    : folder_(std::move(folder)), grid_(tiles_of(plan)), plan_(plan.sha256()) {}

std::filesystem::path FittedTiles::file_of(int number) const {
    return folder_ / fmt::format("{}_{}.fitted", number % grid_.columns(), number / grid_.columns());
}

bool FittedTiles::has(int number) const {
    if (!std::filesystem::exists(file_of(number))) return false;
    try {
        const BlockFile blocks(file_of(number));
        return blocks.of().value("plan", "") == plan_ && blocks.of().value("tile", -1) == number;
    } catch (const Error&) {
        return false;
    }
}

std::vector<int> FittedTiles::missing(const std::vector<int>& numbers, const Progress& progress) const {
    std::vector<int> result;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        report(progress, "tiles that are there",
               static_cast<double>(i) / static_cast<double>(numbers.size()));
        if (!has(numbers[i])) result.push_back(numbers[i]);
    }
    return result;
}

void FittedTiles::write(int number, const RefinedPixels& pixels, const PassCounts& counts) const {
    const Region tile = grid_.region(number);
    const glm::ivec2 corner = in_painting(pixels.surface, 0, 0);
    const Region part{tile.x0 - corner.x, tile.y0 - corner.y, tile.x1 - corner.x, tile.y1 - corner.y};
    RefinedPixels own;
    each_map(pixels, own, [&](const char*, const auto& map, auto& mine) { mine = cut(map, part); });
    const LightRows lights = lights_in(pixels.lights, part);
    BlocksToWrite blocks;
    each_map(own, own, [&](const char* name, const auto& map, const auto&) {
        if (!map.empty()) blocks.add(name, map.pixels());
    });
    blocks.add("lights.counts", std::span(lights.counts));
    blocks.add("lights", std::span(lights.lights));
    blocks.add("rms_residuals", std::span(counts.rms_residuals));
    make_folder(folder_);
    AtomicFile file(file_of(number));
    json of = json_of(counts);
    of["plan"] = plan_;
    of["tile"] = number;
    blocks.write(of, file);
    file.commit();
}

void FittedTiles::put(int number, RefinedPixels& whole) const {
    const BlockFile blocks(file_of(number));
    const Region tile = grid_.region(number);
    RefinedPixels own;
    each_map(whole, own, [&](const std::string& name, auto& map, auto& mine) {
        using Map = std::decay_t<decltype(map)>;
        if (!blocks.has(name)) return;
        if (map.empty()) map = Map(grid_.width, grid_.height);
        mine = Map(tile.width(), tile.height());
        blocks.copy(name, mine.pixels());
        for (int y = 0; y < tile.height(); ++y)
            std::ranges::copy(mine.row(y), map.row(tile.y0 + y).begin() + tile.x0);
    });
    const auto counts = blocks.get<std::uint32_t>("lights.counts");
    const auto lights = blocks.get<SeenLight>("lights");
    std::size_t at = 0;
    for (std::size_t y = 0; y < counts.size(); ++y) {
        whole.lights.add(tile.y0 + static_cast<int>(y), std::span(lights).subspan(at, counts[y]), tile.x0);
        at += counts[y];
    }
    PassCounts passed = counts_from(blocks.of());
    passed.rms_residuals = blocks.get<float>("rms_residuals");
    whole.counts.push_back(std::move(passed));
}

RefinedPixels FittedTiles::all(int photographs, const Progress& progress) const {
    const std::vector<int> lost = missing(tiles_named("all", grid_.count()), progress);
    if (!lost.empty())
        fail(
            "{}: {} of {} tiles are missing, damaged or of another plan: {}{}; fit --tiles all makes them, "
            "and "
            "leaves the others as they are",
            folder_.string(), lost.size(), grid_.count(),
            fmt::join(std::span(lost).first(std::min<std::size_t>(lost.size(), 8)), ", "),
            lost.size() > 8 ? ", …" : "");
    RefinedPixels whole;
    whole.surface = Surface(grid_.width, grid_.height);
    whole.errors = FitErrors(grid_.width, grid_.height);
    whole.lights = LightVisibility(grid_.width, grid_.height, photographs);
    for (int i = 0; i < grid_.count(); ++i) {
        report(progress, "tiles together", static_cast<double>(i) / grid_.count());
        put(i, whole);
    }
    return whole;
}

}  // namespace tangi
