#include "surface/render/relighting_residual.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr const char* kPart = "residual";
constexpr const char* kPartBefore = "faithful";  // in files of version 0.1
constexpr const char* kInVain = "no gain";

std::string channel_of(const char* kind, std::size_t term) { return fmt::format("{}.{:03}", kind, term); }

// Names in the order of their text: brightness.000 …, colour.000.S, colour.000.T, …
std::vector<std::string> channels_of(const RelightingResidual& r) {
    std::vector<std::string> names;
    for (std::size_t t = 0; t < r.brightness.size(); ++t) names.push_back(channel_of("brightness", t));
    for (std::size_t t = 0; t < r.colour.size(); ++t)
        names.push_back(channel_of("colour", t / 2) + (t % 2 ? ".T" : ".S"));
    return names;
}

const Image<float>& map_of(const RelightingResidual& r, std::size_t channel) {
    return channel < r.brightness.size() ? r.brightness[channel] : r.colour[channel - r.brightness.size()];
}

json model_of(const RelightingResidual& r) {
    json directions = json::array();
    for (const Vec3& d : r.directions) directions.push_back({d.x, d.y, d.z});
    return {
        {"kernel", name_of(r.kernel)}, {"reach", r.reach},         {"light_radius_deg", r.light_radius_deg},
        {"reduction", r.reduction},    {"directions", directions}, {"brightness", r.brightness_weights},
        {"colour", r.colour_weights}};
}

// What the attribute says; throws what the JSON reader throws, or runtime_error.
RelightingResidual from_model(const json& model) {
    RelightingResidual r;
    const std::string kernel = model.at("kernel").get<std::string>();
    if (kernel == name_of(RelightingResidual::Kernel::matern)) {
        r.kernel = RelightingResidual::Kernel::matern;
    } else if (kernel != name_of(RelightingResidual::Kernel::gaussian)) {
        throw std::runtime_error("its kernel is '" + kernel + "'");
    }
    r.reach = model.at("reach").get<double>();
    r.light_radius_deg = model.at("light_radius_deg").get<double>();
    if (!(r.reach > 0) || !(r.light_radius_deg >= 0 && r.light_radius_deg <= 45))
        throw std::runtime_error("reach or light_radius_deg is out of range");
    const double reduction = model.value("reduction", 1.0);  // files of version 0.1 know no blocks
    if (!(reduction >= 1 && reduction <= 65535)) throw std::runtime_error("reduction is out of range");
    r.reduction = static_cast<int>(reduction);
    for (const json& d : model.at("directions"))
        r.directions.push_back(Vec3(d.at(0).get<float>(), d.at(1).get<float>(), d.at(2).get<float>()));
    r.brightness_weights = model.at("brightness").get<RelightingResidual::Weights>();
    r.colour_weights = model.at("colour").get<RelightingResidual::Weights>();
    for (const auto* weights : {&r.brightness_weights, &r.colour_weights})
        for (const std::vector<double>& row : *weights)
            if (row.size() != r.directions.size())
                throw std::runtime_error("weights and directions differ in number");
    return r;
}

}  // namespace

double kernel_at(RelightingResidual::Kernel kernel, double reach, double distance) {
    const double d = distance / reach;
    if (kernel == RelightingResidual::Kernel::gaussian) return std::exp(-d * d / 2);
    return (1 + std::sqrt(3.0) * d) * std::exp(-std::sqrt(3.0) * d);
}

std::string name_of(RelightingResidual::Kernel kernel) {
    return kernel == RelightingResidual::Kernel::gaussian ? "gaussian" : "matern";
}

std::vector<double> weights_at(const RelightingResidual& residual, const RelightingResidual::Weights& weights,
                               const Vec3& direction) {
    std::vector<double> kernel, result(weights.size());
    for (const Vec3& photographed : residual.directions)
        kernel.push_back(kernel_at(residual.kernel, residual.reach,
                                   glm::length(glm::dvec3(direction) - glm::dvec3(photographed))));
    for (std::size_t t = 0; t < weights.size(); ++t)
        for (std::size_t i = 0; i < kernel.size(); ++i) result[t] += weights[t][i] * kernel[i];
    return result;
}

glm::mat3 colour_frame(const Rgb& diffuse) {
    const float length = glm::length(diffuse);
    const Vec3 u = length > 1e-6f ? diffuse / length : Vec3(1 / std::sqrt(3.0f));
    // Reflectances are positive, so none points along red less green.
    const Vec3 across(std::sqrt(0.5f), -std::sqrt(0.5f), 0);
    const Vec3 e1 = glm::normalize(across - u * glm::dot(u, across));
    return {u, e1, glm::cross(u, e1)};
}

namespace {

// [per irradiance; along u, e1, e2] Of each block, under a light.
Image<Vec3> residual_under(const RelightingResidual& residual, const Vec3& direction) {
    const auto b = weights_at(residual, residual.brightness_weights, direction);
    const auto c = weights_at(residual, residual.colour_weights, direction);
    const Image<float>& first = residual.brightness.front();
    Image<Vec3> sum(first.width(), first.height(), Vec3(0));
    parallel_for(0, sum.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const auto row = sum.row(y);
            const auto add = [&](const Image<float>& map, double weight, int component) {
                const float w = static_cast<float>(weight);
                const auto values = map.row(y);
                for (std::size_t x = 0; x < row.size(); ++x) row[x][component] += w * values[x];
            };
            for (std::size_t t = 0; t < b.size(); ++t) add(residual.brightness[t], b[t], 0);
            for (std::size_t t = 0; t < c.size(); ++t) {
                add(residual.colour[2 * t], c[t], 1);
                add(residual.colour[2 * t + 1], c[t], 2);
            }
        }
    });
    return sum;
}

// Where a pixel lies between the middles of blocks.
struct Between {
    Between(int pixel, int reduction, int blocks) {
        const float at = (static_cast<float>(pixel) + 0.5f) / static_cast<float>(reduction) - 0.5f;
        before = std::clamp(static_cast<int>(std::floor(at)), 0, blocks - 1);
        after = std::min(before + 1, blocks - 1);
        part = std::clamp(at - static_cast<float>(before), 0.0f, 1.0f);
    }
    int before, after;
    float part;  // of the one after
};

Vec3 value_at(const Image<Vec3>& blocks, const Between& x, const Between& y) {
    const Vec3 above = glm::mix(blocks(x.before, y.before), blocks(x.after, y.before), x.part);
    return glm::mix(above, glm::mix(blocks(x.before, y.after), blocks(x.after, y.after), x.part), y.part);
}

int blocks_of(int pixels, int reduction) { return (pixels + reduction - 1) / reduction; }

}  // namespace

ResidualUnderLights residual_under(const RelightingResidual& residual, std::span<const Light> lights) {
    ResidualUnderLights under;
    if (residual.empty()) return under;
    for (const Light& light : lights) under.push_back(residual_under(residual, light.direction));
    return under;
}

void add_residual(const RelightingResidual& residual, const Surface& dry, std::span<const Light> lights,
                  const Image<float>& bare, Image<Rgb>& picture) {
    add_residual(residual, residual_under(residual, lights), dry, lights, bare, picture);
}

void add_residual(const RelightingResidual& residual, const ResidualUnderLights& under, const Surface& dry,
                  std::span<const Light> lights, const Image<float>& bare, Image<Rgb>& picture) {
    if (residual.empty()) return;
    const Image<float>& first = residual.brightness.front();
    const int k = residual.reduction;
    const PartOfPainting place = dry.part_of.value_or(
        PartOfPainting{0, 0, static_cast<double>(dry.width()), static_cast<double>(dry.height())});
    TP_REQUIRE(picture.region() == dry.height_mm.region() &&
                   first.width() == blocks_of(static_cast<int>(place.width), k) &&
                   first.height() == blocks_of(static_cast<int>(place.height), k) &&
                   under.size() == lights.size() && (bare.empty() || bare.region() == picture.region()),
               "picture, painting and residual have one size");
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Image<Vec3>& blocks = under[i];
        parallel_for(0, picture.height(), 8, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) {
                const Between row(place.top + y, k, blocks.height());
                for (int x = 0; x < picture.width(); ++x) {
                    if (!(dry.confidence(x, y) > 0)) continue;
                    const Incidence in = incidence(lights[i], dry.point_mm(x, y), dry.photography.rig);
                    const Rgb value = colour_frame(dry.diffuse(x, y)) *
                                      value_at(blocks, Between(place.left + x, k, blocks.width()), row);
                    picture(x, y) += (bare.empty() ? 1.0f : bare(x, y)) * in.irradiance * value;
                }
            }
        });
    }
    for (Rgb& value : picture.pixels()) value = glm::max(value, Rgb(0));
}

bool belongs_to(const RelightingResidual& residual, const Surface& dry, const RelightOptions& options) {
    return options.cast_shadows && options.model == WardModel::bounded &&
           static_cast<float>(light_radius_deg(dry, options)) ==
               static_cast<float>(residual.light_radius_deg);
}

std::size_t bytes_of(const RelightingResidual& residual) {
    if (residual.empty()) return 0;
    return (residual.brightness.size() + residual.colour.size()) * residual.brightness.front().size() * 2;
}

PartToWrite part_of(const RelightingResidual& residual) {
    TP_REQUIRE(!residual.empty(), "an empty residual is no part");
    PartToWrite part;
    const Image<float>& first = residual.brightness.front();
    part.info = {kPart, first.width(), first.height(), channels_of(residual), {}};
    part.info.half = true;
    part.info.attributes = {{"model", json_line(model_of(residual))}, {"dry_hash", residual.dry_hash}};
    part.fill = [&residual](int y0, int y1, std::span<float* const> planes) {
        for (std::size_t c = 0; c < planes.size(); ++c)
            for (int y = y0; y < y1; ++y) {
                const auto row = map_of(residual, c).row(y);
                std::copy(row.begin(), row.end(), planes[c] + static_cast<std::size_t>(y - y0) * row.size());
            }
    };
    return part;
}

std::string with_residual_in_vain(const std::string& provenance) {
    json all = json_or_discarded(provenance);
    if (!all.is_object()) all = {{"made_of", provenance}};
    all[kPart] = kInVain;
    return json_line(all);
}

bool residual_in_vain(const std::string& provenance) {
    const json all = json_or_discarded(provenance);
    return all.is_object() &&
           (all.value(kPart, json()) == kInVain || all.value(kPartBefore, json()) == kInVain);
}

namespace {

// What the part says of the model: no maps yet.
RelightingResidual read_model(const std::filesystem::path& path, const PartInfo& part) {
    const auto text = [&](const std::string& name) {
        const auto attribute = part.attributes.find(name);
        if (attribute == part.attributes.end())
            fail("{}: part '{}' has no attribute '{}'; fit again, or relight with --no-residual",
                 path.string(), kPart, name);
        return attribute->second;
    };
    RelightingResidual r;
    try {
        r = from_model(json_or_discarded(text("model")));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        fail("{}: part '{}', attribute 'model': {}; fit again, or relight with --no-residual", path.string(),
             kPart, why_wrong_field(error));
    }
    r.dry_hash = text("dry_hash");
    return r;
}

void require_residual_of(const PaintingHeader& dry, const std::filesystem::path& path, const PartInfo& part,
                         const RelightingResidual& r) {
    if (part.width != blocks_of(dry.width, r.reduction) || part.height != blocks_of(dry.height, r.reduction))
        fail("{}: part '{}' is {} x {}, but the painting is {} x {}, in blocks of {} pixels", path.string(),
             kPart, part.width, part.height, dry.width, dry.height, r.reduction);
    if (r.dry_hash != dry.dry_hash)
        fail("{}: part '{}' belongs to another dry layer (hash {}); fit again, or relight with --no-residual",
             path.string(), kPart, r.dry_hash);
}

// Rows of a map as the file has them.
void take_rows(int y0, int y1, const float* plane, Image<float>& map, const std::filesystem::path& path,
               const std::string& channel) {
    for (int y = y0; y < y1; ++y) {
        const auto row = map.row(y);
        std::copy_n(plane + static_cast<std::size_t>(y - y0) * row.size(), row.size(), row.begin());
        for (std::size_t x = 0; x < row.size(); ++x)
            if (!std::isfinite(row[x]))
                fail(
                    "{}: part '{}', channel '{}' holds {} at pixel ({}, {}); fit again with "
                    "--residual",
                    path.string(), kPart, channel, row[x], x, y);
    }
}

std::optional<PartInfo> residual_part(const std::filesystem::path& path) {
    for (PartInfo& part : painting_parts(path))
        if (part.name == kPart || part.name == kPartBefore) return std::move(part);
    return {};
}

}  // namespace

RelightingResidual read_residual(const std::filesystem::path& path, const Surface& dry,
                                 const Progress& progress) {
    if (!residual_part(path)) return {};
    PaintingHeader header = header_of(dry);
    header.dry_hash = hash_of(dry);
    return read_residual(path, header, progress);
}

RelightingResidual read_residual(const std::filesystem::path& path, const PaintingHeader& dry,
                                 const Progress& progress) {
    const std::optional<PartInfo> found = residual_part(path);
    if (!found) return {};
    RelightingResidual r = read_model(path, *found);
    require_residual_of(dry, path, *found, r);
    r.brightness.resize(r.brightness_weights.size());
    r.colour.resize(2 * r.colour_weights.size());
    if (r.empty() || channels_of(r) != found->channels)
        fail(
            "{}: part '{}' does not have the channels that its model names; fit again, or relight with "
            "--no-residual",
            path.string(), kPart);
    for (auto* maps : {&r.brightness, &r.colour})
        for (Image<float>& map : *maps) map = Image<float>(found->width, found->height);
    read_painting_part(
        path, *found,
        [&](int y0, int y1, std::span<const float* const> planes) {
            for (std::size_t c = 0; c < planes.size(); ++c)
                take_rows(y0, y1, planes[c], const_cast<Image<float>&>(map_of(r, c)), path,
                          found->channels[c]);
        },
        progress);
    return r;
}

}  // namespace tangi
