#include "fit/exchange/import_maps.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/base/words.h"
#include "surface/file/visible_files.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_rows.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr float kLowestZ = 0.05f;      // [1] of a normal: about 3 degrees above the horizon
constexpr float kMirrorAlpha = 1e-3f;  // [1]
constexpr float kUnglossy = 0.3f;      // [1] roughness where no map says, and nothing is specular
// A cliff is where photographs show its shadow (final_height.h), and maps come without any: slopes that are
// no gradient, as of the blocks of a JPEG, would break a flat frame into steps, and edges that lose their
// weight all along such lines leave the equations hardly determined.
constexpr HeightOptions kWithoutPhotographs{.robust_sweeps = 0};

// What comes behind the last '-', '_', '.' or space of a name, in lower case, without "map" at its end.
std::string last_word(const fs::path& path) {
    std::string stem = lower_case(path.stem().string());
    if (stem.ends_with("roughness_v")) return "roughness_v";
    if (const auto at = stem.find_last_of("-_. "); at != std::string::npos) stem = stem.substr(at + 1);
    if (stem.size() > 3 && stem.ends_with("map")) stem.resize(stem.size() - 3);
    return stem;
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::optional<fs::path>* map_named(MapFiles& files, const std::string& word) {
    if (is_one_of(word, {"kd", "diffuse", "albedo", "basecolor", "basecolour"})) return &files.diffuse;
    if (is_one_of(word, {"ks", "specular"})) return &files.specular;
    if (is_one_of(word, {"no", "normal", "normals"})) return &files.normals;
    if (is_one_of(word, {"gl", "gloss"})) return &files.gloss;
    if (is_one_of(word, {"roughness", "alpha"})) return &files.roughness;
    if (word == "lobe") return &files.lobe;
    if (is_one_of(word, {"height", "displacement"})) return &files.height;
    if (word == "roughness_v") return &files.across;
    if (word == "tangent") return &files.tangent;
    if (word == "confidence") return &files.confidence;
    return nullptr;
}

// A map of the surface's size, which the first one decides.
Image<Rgb> read_map(const fs::path& path, Surface& s, const fs::path& first) {
    if (s.height_mm.empty()) {
        constexpr double height_solver = 21;  // [bytes a pixel] height.h
        const PictureContent size = PictureRows(path).content();
        require_memory_of_surface(path, size.width, size.height, sizeof(Rgb) + height_solver,
                                  "making a painting");
    }
    Image<Rgb> map = read_picture(path);
    if (s.height_mm.empty()) s = Surface(map.width(), map.height());
    if (map.width() != s.width() || map.height() != s.height())
        fail("{}: is {} x {} pixels, but {} is {} x {}; maps of one painting have one size", path.string(),
             map.width(), map.height(), first.string(), s.width(), s.height());
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x)
            if (const Rgb& v = map(x, y); !std::isfinite(v.r + v.g + v.b))
                fail("{}: holds a value that is no number, at pixel ({}, {})", path.string(), x, y);
    return map;
}

void take_normals(const Image<Rgb>& map, const fs::path& path, bool y_down, Surface& s,
                  ImportReport& report_) {
    const bool stored_as_is = lower_extension(path) == ".exr";  // floats hold -1..1
    std::vector<float> tilts;
    const std::size_t step = std::max<std::size_t>(map.size() / 100000, 1);
    for (std::size_t i = 0; i < map.size(); ++i) {
        Vec3 n = stored_as_is ? map.pixels()[i] : 2.0f * map.pixels()[i] - 1.0f;
        if (y_down) n.y = -n.y;
        const float length = glm::length(n);
        s.confidence.pixels()[i] = 0;
        if (length < 0.5f) continue;
        n /= length;
        report_.facing_away += !(n.z > 0);
        if (i % step == 0) tilts.push_back(std::acos(std::clamp(n.z, -1.0f, 1.0f)));
        n.z = std::max(n.z, kLowestZ);
        s.normal.pixels()[i] = glm::normalize(n);
        s.confidence.pixels()[i] = 1;
        ++report_.measured;
    }
    report_.median_tilt_deg = median(std::move(tilts)) * 180 / std::numbers::pi;
    if (report_.measured == 0)
        fail("{}: holds no normal: n = 2 c - 1 is shorter than 0.5 everywhere", path.string());
    const auto part = static_cast<double>(report_.facing_away) / static_cast<double>(report_.measured);
    if (part > 0.5)
        fail(
            "{}: {} of its {} normals point away from the viewer (z is not above 0): it is no normal map of "
            "the picture plane, or its z, {}, has the other sign; save it with z towards the viewer",
            path.string(), report_.facing_away, report_.measured,
            stored_as_is ? "the third channel" : "blue");
    if (part > 0)
        report_.warnings.push_back(
            fmt::format("{}: {} of its {} normals ({:.2g} %) point away from the viewer (z is not above 0); "
                        "they are bent up "
                        "to the horizon, and height and gloss are guesses there",
                        path.string(), report_.facing_away, report_.measured, 100 * part));
    if (report_.median_tilt_deg > 45)
        report_.warnings.push_back(fmt::format(
            "{}: half of its normals tilt by more than {:.0f} degrees; is it a normal map of the picture "
            "plane, with z in blue?",
            path.string(), report_.median_tilt_deg));
}

void take_confidence(const Image<Rgb>& map, const fs::path& path, Surface& s, ImportReport& report_) {
    for (std::size_t i = 0; i < map.size(); ++i) {
        float& confidence = s.confidence.pixels()[i];
        if (!(confidence > 0)) continue;
        confidence = std::clamp(map.pixels()[i].r, 0.0f, 1.0f);
        report_.measured -= !(confidence > 0);
    }
    if (report_.measured == 0) fail("{}: is 0 everywhere, so that nothing was measured", path.string());
}

void take_height(const Image<Rgb>& map, const fs::path& path, const ImportOptions& options, Surface& s) {
    const bool is_in_mm = lower_extension(path) == ".exr";
    const double from = is_in_mm ? 0 : options.height_from_mm,
                 range = is_in_mm ? 1 : options.height_range_mm.value_or(1);
    for (std::size_t i = 0; i < map.size(); ++i)
        s.height_mm.pixels()[i] = static_cast<float>(from + range * map.pixels()[i].r);
}

// Says how many pixels have a value that is none of the map's: of another encoding or scale, as a rule.
template <class Value>
void warn_outside_unit(const Image<Rgb>& map, const fs::path& path, const char* what, ImportReport& report_,
                       Value&& value_of) {
    const auto outside = std::count_if(map.pixels().begin(), map.pixels().end(), [&](const Rgb& pixel) {
        return value_of(pixel) < 0 || value_of(pixel) > 1;
    });
    if (outside > 0)
        report_.warnings.push_back(
            fmt::format("{}: {} of its {} pixels ({:.2g} %) are outside 0 to 1, where {} is; is it the right "
                        "map, and linear?",
                        path.string(), outside, map.size(),
                        100.0 * static_cast<double>(outside) / static_cast<double>(map.size()), what));
}

void take_roughness(const MapFiles& files, const ImportOptions& options, const fs::path& first, Surface& s,
                    ImportReport& report_) {
    if (files.roughness) {
        const Image<Rgb> map = read_map(*files.roughness, s, first);
        warn_outside_unit(map, *files.roughness, "alpha", report_, [](const Rgb& value) { return value.r; });
        const auto mirrors = std::count_if(map.pixels().begin(), map.pixels().end(),
                                           [](const Rgb& value) { return value.r < kMirrorAlpha; });
        if (2 * static_cast<std::size_t>(mirrors) > map.size())
            report_.warnings.push_back(fmt::format(
                "{}: {} of its {} pixels are less than {}, and are taken for that: paint whose lobes are a "
                "mirror's; is it the right map?",
                files.roughness->string(), mirrors, map.size(), kMirrorAlpha));
        for (std::size_t i = 0; i < map.size(); ++i)
            s.roughness.pixels()[i] = std::clamp(map.pixels()[i].r, kMirrorAlpha, 1.0f);
        return;
    }
    if (!files.gloss) {
        for (float& roughness : s.roughness.pixels()) roughness = kUnglossy;
        return;
    }
    const Image<Rgb> map = read_map(*files.gloss, s, first);
    const double m = 1 - std::pow(greatest_alpha(options), 0.25),
                 most = 1 - std::pow(least_alpha(options), 0.25);
    for (std::size_t i = 0; i < map.size(); ++i) {
        const double root = 1 - std::clamp(map.pixels()[i].r, 0.0f, 1.0f) * (most - m) - m;
        s.roughness.pixels()[i] = static_cast<float>(root * root * root * root);
    }
}

void take_axes(const MapFiles& files, const fs::path& first, Surface& s) {
    if (!files.across && !files.tangent) return;
    if (!files.across || !files.tangent || !files.roughness)
        fail(
            "{}: roughness, roughness_v and tangent say together how lobes are anisotropic, and {} is "
            "missing; "
            "add it, or take this file away",
            (files.across ? *files.across : *files.tangent).string(),
            !files.across    ? "roughness_v"
            : !files.tangent ? "tangent"
                             : "roughness");
    if (lower_extension(*files.tangent) != ".exr")
        fail(
            "{}: a tangent map holds angles in radians, which pictures of whole numbers from 0 to 1 cannot; "
            "save it as .exr",
            files.tangent->string());
    s.lobe_axes = Image<LobeAxes>(s.width(), s.height());
    const Image<Rgb> across = read_map(*files.across, s, first);
    for (std::size_t i = 0; i < across.size(); ++i)
        s.lobe_axes.pixels()[i].roughness_v = std::clamp(across.pixels()[i].r, 1e-3f, 1.0f);
    const Image<Rgb> tangent = read_map(*files.tangent, s, first);
    for (std::size_t i = 0; i < tangent.size(); ++i) s.lobe_axes.pixels()[i].tangent = tangent.pixels()[i].r;
}

void require_importable(const MapFiles& files, const ImportOptions& options) {
    if (!(least_alpha(options) < greatest_alpha(options)))
        fail("import.alpha_min must be less than import.alpha_max");
    if (!files.diffuse)
        fail("no diffuse map: give a folder with kd, diffuse or albedo in it, or --diffuse FILE");
    if (!files.normals && !files.height)
        fail("{}: comes with neither normals nor height; give --normals FILE or --height FILE",
             files.diffuse->string());
}

void take_diffuse(const Image<Rgb>& map, const ImportOptions& options, Surface& s) {
    const Transfer transfer{options.diffuse_srgb.value_or(false) ? Transfer::Kind::srgb
                                                                 : Transfer::Kind::linear};
    for (std::size_t i = 0; i < map.size(); ++i)
        for (int c = 0; c < 3; ++c)
            s.diffuse.pixels()[i][c] = transfer.decode(std::max(map.pixels()[i][c], 0.0f));
}

// What the options say of the painting as a whole.
void take_description(const ImportOptions& options, Surface& s) {
    s.mm_per_pixel = options.mm_per_pixel.value_or(1);
    s.scale_known = options.mm_per_pixel.has_value() && options.scale_known;
    s.photography = options.photography;
    s.reflectance_model = {.diffuse_roughness = options.diffuse_roughness.value_or(0),
                           .second_lobe_weight = options.second_lobe_weight.value_or(0)};
}

// rho_s and the colours of lobes.
void take_lobe(const MapFiles& files, const fs::path& first, Surface& s, ImportReport& report_) {
    if (files.specular) {
        const Image<Rgb> map = read_map(*files.specular, s, first);
        warn_outside_unit(map, *files.specular, "rho_s", report_, luminance);
        for (std::size_t i = 0; i < map.size(); ++i)
            s.specular.pixels()[i] = std::max(luminance(map.pixels()[i]), 0.0f);
    }
    if (files.lobe) {
        s.specular_colour = read_map(*files.lobe, s, first);
        for (Rgb& colour : s.specular_colour.pixels()) colour = glm::clamp(colour, 0.0f, 1.0f);
    }
}

// From the height.
void derive_normals(Surface& s, ImportReport& report_) {
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    for (float& confidence : s.confidence.pixels()) confidence = 1;
    report_.measured = report_.pixels;
}

// Takes the plane of the support off the height.
void level(Surface& s, ImportReport& report_) {
    const Plane plane = best_plane(s.height_mm, s.confidence);
    subtract(plane, s.height_mm);
    report_.support_tilt_deg =
        std::atan(std::hypot(plane.a, plane.b) / s.mm_per_pixel) * 180 / std::numbers::pi;
}

}  // namespace

double least_alpha(const ImportOptions& options) { return options.alpha_min.value_or(0.01); }
double greatest_alpha(const ImportOptions& options) { return options.alpha_max.value_or(0.5); }

MapFiles find_maps(const fs::path& folder, const MapFiles& named) {
    if (!fs::is_directory(folder)) fail("{}: no such folder", folder.string());
    std::vector<fs::path> paths;
    for (const fs::path& path : visible_files(folder))
        if (is_one_of(lower_extension(path), {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".exr"}))
            paths.push_back(path);
    MapFiles files = named, wanted = named;
    for (const fs::path& path : paths) {
        std::optional<fs::path>* const map = map_named(files, last_word(path));
        if (!map || *map_named(wanted, last_word(path))) continue;
        if (*map)
            fail("{} and {}: both seem to be the same map; name the one to take with a flag",
                 (*map)->string(), path.string());
        *map = path;
    }
    return files;
}

Surface import_maps(const MapFiles& files, const ImportOptions& options, ImportReport& report_,
                    const Progress& progress) {
    validate(options);
    require_importable(files, options);
    const fs::path& first = *files.diffuse;
    Surface s;
    report(progress, "read maps", 0);
    take_diffuse(read_map(first, s, first), options, s);
    take_description(options, s);
    report_.pixels = static_cast<long>(s.height_mm.size());
    report(progress, "read maps", 0.2);
    take_lobe(files, first, s, report_);
    report(progress, "read maps", 0.4);
    take_roughness(files, options, first, s, report_);
    take_axes(files, first, s);
    report(progress, "read maps", 0.6);
    if (files.height) take_height(read_map(*files.height, s, first), *files.height, options, s);
    report(progress, "read maps", 0.8);
    if (files.normals)
        take_normals(read_map(*files.normals, s, first), *files.normals, options.normals_y_down, s, report_);
    else
        derive_normals(s, report_);
    if (files.confidence)
        take_confidence(read_map(*files.confidence, s, first), *files.confidence, s, report_);
    report_.height.converged = true;
    if (!files.height)
        report_.height = integrate_normals({s.normal, s.confidence, s.mm_per_pixel}, s.height_mm,
                                           kWithoutPhotographs, progress);
    if (!options.levelled || !files.height) level(s, report_);
    return s;
}

}  // namespace tangi
