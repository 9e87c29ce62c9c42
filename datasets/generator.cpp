#include "datasets/generator.h"

#include <algorithm>
#include <array>
#include <vector>

#include "capture/formats/lights_file.h"
#include "datasets/ggx.h"
#include "surface/base/json_text.h"
#include "surface/base/noise.h"
#include "surface/base/parallel.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/painting_file.h"
#include "surface/reflectance/anisotropy.h"
#include "surface/render/relight.h"

namespace tangi {

namespace fs = std::filesystem;
using procedural::hash;
using procedural::normal_pair;
using procedural::Seed;
using procedural::uniform;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

// What the seed of the options is split into.
enum Purpose : std::uint64_t { for_gains = 1, for_held_out, for_directions, for_noise, for_aims };

template <class Enum, std::size_t count>
std::optional<Enum> named(std::string_view name, const std::array<Enum, count>& all) {
    for (const Enum value : all)
        if (name == name_of(value)) return value;
    return std::nullopt;
}

std::string_view extension_of(GeneratorFormat format) {
    switch (format) {
        case GeneratorFormat::jpg:
            return ".jpg";
        case GeneratorFormat::exr:
            return ".exr";
        case GeneratorFormat::tif:
            return ".tif";
        case GeneratorFormat::png16:
        case GeneratorFormat::png8:
            break;
    }
    return ".png";
}

Vec3 direction(double elevation, double azimuth) {
    return {static_cast<float>(std::cos(elevation) * std::cos(azimuth)),
            static_cast<float>(std::cos(elevation) * std::sin(azimuth)),
            static_cast<float>(std::sin(elevation))};
}

// Point i of n on a golden-angle spiral; equal steps of sin(elevation) are equal areas (Archimedes).
Vec3 spiral_direction(int i, int n, double turn, double low, double high) {
    const double sine = std::sin(low) + (std::sin(high) - std::sin(low)) * (i + 0.5) / n;
    const double golden = kPi * (3 - std::sqrt(5.0));
    return direction(std::asin(sine), turn + golden * i);
}

// Rings at equal distances in elevation, about as far apart as the lights in them.
std::vector<Vec3> dome_directions(int n, double low, double high) {
    const double area = 2 * kPi * (std::sin(high) - std::sin(low));
    const int rings =
        std::clamp(static_cast<int>(std::lround((high - low) / std::sqrt(std::max(area, 1e-6) / n))), 1, n);
    std::vector<double> elevation, until;  // of each ring; lights up to and with it, not yet rounded
    double length = 0;
    for (int ring = 0; ring < rings; ++ring) {
        elevation.push_back(rings == 1 ? (low + high) / 2 : low + (high - low) * ring / (rings - 1));
        length += std::max(std::cos(elevation.back()), 0.05);
        until.push_back(length);
    }
    std::vector<Vec3> directions;
    for (int ring = 0; ring < rings; ++ring) {
        const auto r = static_cast<std::size_t>(ring);
        const int begin = static_cast<int>(directions.size());
        const int count = static_cast<int>(std::lround(n * until[r] / length)) - begin;
        for (int i = 0; i < count; ++i)
            directions.push_back(direction(elevation[r], 2 * kPi * (i + 0.5 * (ring % 2)) / count));
    }
    return directions;
}

std::vector<Vec3> directions_to_fit(const GeneratorOptions& o) {
    const double low = o.min_elevation_deg * kDegree, high = o.max_elevation_deg * kDegree;
    if (o.arrangement == Arrangement::dome) return dome_directions(o.lights, low, high);
    std::vector<Vec3> directions;
    for (int i = 0; i < o.lights; ++i) directions.push_back(spiral_direction(i, o.lights, 0, low, high));
    return directions;
}

// The direction turned about a random axis perpendicular to it; both tangent components are normally
// distributed.
Vec3 disturbed(const Vec3& direction, double rms_deg, Seed seed) {
    if (rms_deg <= 0) return direction;
    const Vec3 helper = std::abs(direction.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
    const Vec3 first = glm::normalize(glm::cross(direction, helper)), second = glm::cross(direction, first);
    const auto [a, b] = normal_pair(seed);
    const float scale = static_cast<float>(rms_deg * kDegree / std::numbers::sqrt2);
    const Vec3 offset = scale * (a * first + b * second);
    const float angle = glm::length(offset);
    if (angle <= 0) return direction;
    Vec3 turned = std::cos(angle) * direction + std::sin(angle) / angle * offset;
    turned.z = std::max(turned.z, 0.02f);  // no lights file puts a light behind the picture
    return glm::normalize(turned);
}

// The GGX lobe seen from straight ahead where it is anisotropic, in the frame of
// surface/reflectance/anisotropy.h.
float anisotropic_lobe(float f0, float alpha, const LobeAxes& axes, const Vec3& n, const Vec3& light) {
    const Vec3 v(0, 0, 1), h = glm::normalize(light + v);
    if (!(glm::dot(n, light) > 0)) return 0;
    const auto in_frame = [&](const Vec3& w) {
        WardAngles<float> angles;
        angles.h_n = glm::dot(n, w);
        add_axes(n, w, axes.tangent, angles);
        return Vec3(angles.h_t, angles.h_b, angles.h_n);
    };
    const float across = axes.roughness_v, along = alpha * alpha / across;
    return anisotropic_ggx(along, across, in_frame(light), in_frame(v), in_frame(h)) *
           schlick_fresnel(f0, glm::dot(light, h));
}

// pi f cos(theta), the lobe included.
Rgb reflected(const Surface& s, int x, int y, const Vec3& light, Reflectance reflectance) {
    if (reflectance == Reflectance::ward_bounded)
        return reflected(s, x, y, light, {0, 0, 1}, WardModel::bounded);
    const Vec3& n = s.normal(x, y);
    const float n_l = glm::dot(n, light);
    if (!(n_l > 0)) return Rgb(0);
    if (reflectance == Reflectance::lambert) return s.diffuse(x, y) * n_l;
    const auto lobe = [&](float f0) {
        if (s.lobe_axes.empty()) return ggx_lobe(f0, s.roughness(x, y), n, light, Vec3(0, 0, 1));
        return anisotropic_lobe(f0, s.roughness(x, y), s.lobe_axes(x, y), n, light);
    };
    const float f0 = s.specular(x, y);
    Rgb gloss(0);
    if (s.specular_colour.empty() || s.specular_colour(x, y) == Rgb(1)) {
        gloss = Rgb(lobe(f0));
    } else {
        const Rgb& colour = s.specular_colour(x, y);
        gloss = {lobe(f0 * colour.r), lobe(f0 * colour.g), lobe(f0 * colour.b)};
    }
    return (s.diffuse(x, y) + static_cast<float>(kPi) * gloss) * n_l;
}

Image<Rgb> render(const Surface& s, const Light& light, const GeneratorOptions& o) {
    Image<Rgb> photo(s.width(), s.height());
    const Image<float> visible = o.cast_shadows ? visibility(s, light, o.light_radius_deg) : Image<float>();
    const float white_level = static_cast<float>(o.white_level);
    const Rgb everywhere = Rgb(static_cast<float>(o.ambient)) + static_cast<float>(o.interreflection) *
                                                                    light.gain *
                                                                    std::max(light.direction.z, 0.0f);
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) {
                const Vec3 point = s.point_mm(x, y);
                const Incidence in = incidence(light, point);
                const float part = (visible.empty() ? 1.0f : visible(x, y)) *
                                   static_cast<float>(beam_part(light, point, s.width() * s.mm_per_pixel, o));
                photo(x, y) =
                    white_level * (part * in.irradiance * reflected(s, x, y, in.direction, o.reflectance) +
                                   everywhere * s.diffuse(x, y));
            }
    });
    return photo;
}

void write_mask(const fs::path& path, const Image<unsigned char>& mask) {
    Image<float> map(mask.width(), mask.height());
    for (std::size_t i = 0; i < map.size(); ++i) map.pixels()[i] = mask.pixels()[i] ? 1.0f : 0.0f;
    write_map(path, map, {.bits = 8});
}

}  // namespace

std::string_view name_of(Arrangement arrangement) {
    return arrangement == Arrangement::dome ? "dome" : "spiral";
}

std::string_view name_of(Reflectance reflectance) {
    switch (reflectance) {
        case Reflectance::ggx:
            return "ggx";
        case Reflectance::ward_bounded:
            return "ward_bounded";
        case Reflectance::lambert:
            break;
    }
    return "lambert";
}

std::string_view name_of(GeneratorFormat format) {
    switch (format) {
        case GeneratorFormat::png16:
            return "png16";
        case GeneratorFormat::png8:
            return "png8";
        case GeneratorFormat::jpg:
            return "jpg";
        case GeneratorFormat::exr:
            return "exr";
        case GeneratorFormat::tif:
            break;
    }
    return "tif";
}

std::optional<Arrangement> arrangement_named(std::string_view name) {
    return named(name, std::array{Arrangement::dome, Arrangement::spiral});
}
std::optional<Reflectance> reflectance_named(std::string_view name) {
    return named(name, std::array{Reflectance::ggx, Reflectance::ward_bounded, Reflectance::lambert});
}
std::optional<GeneratorFormat> generator_format_named(std::string_view name) {
    return named(name, std::array{GeneratorFormat::png16, GeneratorFormat::png8, GeneratorFormat::jpg,
                                  GeneratorFormat::exr, GeneratorFormat::tif});
}

void require_valid(const GeneratorOptions& o) {
    validate(o);
    if (o.max_elevation_deg < o.min_elevation_deg)
        fail("generator.max_elevation_deg = {} is below min_elevation_deg = {}", o.max_elevation_deg,
             o.min_elevation_deg);
    if (o.beam_deg > 0 && !o.distance)
        fail("generator.beam_deg = {} needs near lights: give the distance as well", o.beam_deg);
    if (o.gain_max < o.gain_min)
        fail("generator.gain_max = {} is below gain_min = {}", o.gain_max, o.gain_min);
    if (o.format == GeneratorFormat::exr && o.transfer != Transfer{})
        fail("generator.format = exr holds linear light; the transfer curve cannot be {}", o.transfer.name());
}

nlohmann::json to_json(const GeneratorOptions& options) {
    nlohmann::json json = to_json<GeneratorOptions>(options);
    json["arrangement"] = name_of(options.arrangement);
    json["reflectance"] = name_of(options.reflectance);
    json["transfer"] = options.transfer.name();
    json["format"] = name_of(options.format);
    return json;
}

Photography photography_of(const PaintingTruth& truth, const GeneratorOptions& o) {
    require_valid(o);
    Photography photography;  // without a model of gains: they are drawn one by one
    photography.transfer = o.transfer;
    photography.white_level = o.white_level;
    photography.rig.light_radius_deg = static_cast<float>(o.light_radius_deg);
    const auto add = [&](const std::string& stem, int i, const Vec3& l, bool fitted) {
        const std::string name = fmt::format("{}_{:03}{}", stem, i, extension_of(o.format));
        const float width_mm = static_cast<float>(truth.width() * truth.mm_per_pixel);
        Light light = o.distance ? near_light(static_cast<float>(*o.distance) * width_mm * l, name)
                                 : distant_light(l, name);
        const auto index = static_cast<std::uint64_t>(photography.photos.size());
        const double part = uniform(hash(hash(o.seed, for_gains), index));
        light.gain = Rgb(static_cast<float>(o.gain_min * std::pow(o.gain_max / o.gain_min, part)));
        photography.photos.push_back({.light = std::move(light), .fitted = fitted});
    };
    const std::vector<Vec3> directions = directions_to_fit(o);
    for (int i = 0; i < o.lights; ++i) add("img", i, directions[static_cast<std::size_t>(i)], true);
    const double turn = 2 * kPi * uniform(hash(o.seed, for_held_out));
    for (int i = 0; i < o.held_out; ++i)
        add("heldout", i,
            spiral_direction(i, o.held_out, turn, o.min_elevation_deg * kDegree,
                             o.max_elevation_deg * kDegree),
            false);
    return photography;
}

double beam_part(const Light& light, const Vec3& point_mm, double width_mm, const GeneratorOptions& o) {
    if (!(o.beam_deg > 0) || !light.position_mm) return 1;
    Seed seed = hash(o.seed, for_aims);
    for (const char c : light.name) seed = hash(seed, static_cast<std::uint64_t>(c));
    const auto [x, y] = normal_pair(seed);
    const double reach = o.aim_error * width_mm;
    const glm::dvec3 from(*light.position_mm),
        axis = glm::normalize(from - glm::dvec3(x * reach, y * reach, 0));
    const double power = std::log(0.5) / std::log(std::cos(o.beam_deg * kDegree));
    const auto strength = [&](const glm::dvec3& to) {
        return std::pow(std::max(glm::dot(axis, glm::normalize(from - to)), 1e-3), power);
    };
    return strength(glm::dvec3(point_mm)) / strength(glm::dvec3(0));
}

Image<Rgb> render_photo(const PaintingTruth& truth, const Light& light, const GeneratorOptions& options) {
    require_valid(options);
    return render(surface_of(truth), light, options);
}

Image<Rgb> apply_sensor(const Image<Rgb>& linear, const GeneratorOptions& o, int photo) {
    if (!o.sensor_noise) return linear;
    Image<Rgb> result(linear.width(), linear.height());
    const float full_well = static_cast<float>(o.full_well_electrons);
    const float read_variance = static_cast<float>(o.read_noise_electrons * o.read_noise_electrons);
    const double steps = std::exp2(o.adc_bits) - 1;
    const Seed seed = hash(hash(o.seed, for_noise), static_cast<std::uint64_t>(photo));
    const auto sensed = [&](float value, float normal) {
        const float electrons = std::max(value, 0.0f) * full_well;
        const double noisy = (electrons + std::sqrt(electrons + read_variance) * normal) / full_well;
        return static_cast<float>(std::round(std::clamp(noisy, 0.0, 1.0) * steps) / steps);
    };
    parallel_for(0, linear.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < linear.width(); ++x) {
                const Seed h = hash(seed, x, y);
                const auto [red, green] = normal_pair(h);
                const Rgb& value = linear(x, y);
                result(x, y) = {sensed(value.r, red), sensed(value.g, green),
                                sensed(value.b, normal_pair(hash(h, 2)).first)};
            }
    });
    return result;
}

void write_truth(const fs::path& folder, const PaintingTruth& truth, const Photography& photography,
                 const GeneratorOptions& options) {
    make_folder(folder);
    write_map(folder / "height.exr", truth.height_mm);
    write_picture(folder / "normal.exr", truth.normal, Transfer{});
    write_picture(folder / "albedo.exr", truth.diffuse, Transfer{});
    write_map(folder / "specular.exr", truth.specular);
    write_map(folder / "roughness.exr", truth.roughness);
    for (const char* name : {"lobe.exr", "roughness_v.exr", "tangent.exr"})
        fs::remove(folder / name);  // of another stack
    if (!truth.lobe_axes.empty()) {
        const auto [across, tangent] = axes_maps(truth.lobe_axes);
        write_map(folder / "roughness_v.exr", across);
        write_map(folder / "tangent.exr", tangent);
    }
    if (!truth.specular_colour.empty()) write_picture(folder / "lobe.exr", truth.specular_colour, Transfer{});
    write_mask(folder / "loss.png", truth.loss);
    write_mask(folder / "craquelure.png", truth.craquelure);
    write_mask(folder / "varnish.png", truth.varnish);
    write_mask(folder / "retouch.png", truth.retouch);
    for (const auto& [name, mask] : {std::pair("abrasion", &truth.abrasion),
                                     {"flaking", &truth.flaking},
                                     {"stain", &truth.stain},
                                     {"old_fill", &truth.old_fill},
                                     {"overpaint", &truth.overpaint}})
        if (std::any_of(mask->pixels().begin(), mask->pixels().end(), [](unsigned char v) { return v != 0; }))
            write_mask(folder / fmt::format("{}.png", name), *mask);
    write_mask(folder / "valid.png", truth.valid);
    write_text_file(folder / "lights.json", json_lines(to_json(photography), 1));
    const nlohmann::json meta = {{"software", program_name()},
                                 {"width", truth.width()},
                                 {"height", truth.height()},
                                 {"mm_per_pixel", truth.mm_per_pixel},
                                 {"generator", to_json(options)}};
    write_text_file(folder / "meta.json", json_lines(meta, 1));
    fs::remove(folder / "truth.exr");  // of another stack
    if (options.reflectance == Reflectance::ggx) return;
    Surface surface = surface_of(truth);
    if (options.reflectance == Reflectance::lambert)
        surface.specular = Image<float>(truth.width(), truth.height());
    surface.photography = photography;
    surface.provenance = json_line(meta);
    write_painting(folder / "truth.exr", surface);
}

Photography write_stack(const fs::path& folder, const PaintingTruth& truth, const GeneratorOptions& o,
                        const Progress& progress) {
    Photography photography = photography_of(truth, o);
    const fs::path held_out_folder = folder / "heldout";
    make_folder(folder);
    if (o.held_out > 0) make_folder(held_out_folder);
    write_truth(folder / "gt", truth, photography, o);

    const Surface surface = surface_of(truth);
    const PictureStorage storage{.bits = o.format == GeneratorFormat::png8 ? 8 : 16,
                                 .jpeg_quality = o.jpeg_quality};
    std::vector<Light> nominal, held_out;
    int done = 0;
    for (const Photography::Photo& photo : photography.photos) {
        const Light& light = photo.light;
        const Image<Rgb> picture = apply_sensor(render(surface, light, o), o, done);
        write_picture((photo.fitted ? folder : held_out_folder) / light.name, picture, o.transfer, storage);
        Light& listed = (photo.fitted ? nominal : held_out).emplace_back(light);
        if (photo.fitted)
            listed.direction =
                disturbed(light.direction, o.nominal_direction_error_deg,
                          hash(hash(o.seed, for_directions), static_cast<std::uint64_t>(done)));
        report(progress, "photographs", ++done / static_cast<double>(photography.photos.size()));
    }
    if (!held_out.empty()) write_lights_file(held_out_folder / "heldout.lp", held_out);
    write_lights_file(folder / "lights.lp", nominal);
    return photography;
}

}  // namespace tangi
