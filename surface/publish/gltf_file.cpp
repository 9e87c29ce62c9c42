#include "surface/publish/gltf_file.h"

#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>

#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "surface/report/png_encode.h"

namespace tangi {

namespace {

using nlohmann::json;

constexpr float kDielectric = 0.04f;  // [1] reflectance at right angles of glTF's, which ks is a multiple of
constexpr int kFloats = 5126, kIndices = 5125, kVertices = 34962, kElements = 34963;
constexpr int kLinear = 9729, kMipmaps = 9987, kClamp = 33071;

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// The document, and the bytes that it refers to.
class Document {
public:
    Document() {
        root_ = {{"asset", {{"version", "2.0"}, {"generator", program_name()}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}},
                 {"samplers",
                  {{{"magFilter", kLinear}, {"minFilter", kMipmaps}, {"wrapS", kClamp}, {"wrapT", kClamp}}}}};
    }
    json& root() { return root_; }

    int view(std::string_view bytes, int target = 0) {
        json& views = root_["bufferViews"];
        json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
        if (target) view["target"] = target;
        views.push_back(view);
        bytes_.append(bytes);
        bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
        return static_cast<int>(views.size()) - 1;
    }

    int accessor(const std::string& type, int component, std::string_view bytes, std::size_t count,
                 int target, const json& bounds = json::object()) {
        json accessor = {{"bufferView", view(bytes, target)},
                         {"componentType", component},
                         {"count", count},
                         {"type", type}};
        accessor.update(bounds);
        root_["accessors"].push_back(accessor);
        return static_cast<int>(root_["accessors"].size()) - 1;
    }

    // Numbers as they are, or colours, which glTF takes for sRGB where the texture is a colour's.
    json texture(const Image<Rgb>& picture) {
        const int image = view(png_bytes(picture));
        root_["images"].push_back({{"bufferView", image}, {"mimeType", "image/png"}});
        root_["textures"].push_back({{"sampler", 0}, {"source", root_["images"].size() - 1}});
        return {{"index", root_["textures"].size() - 1}};
    }

    std::string glb() {
        root_["buffers"] = {{{"byteLength", bytes_.size()}}};
        std::string text = json_line(root_);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string file = "glTF";
        const auto number = [&](std::size_t value) {
            const auto four = static_cast<std::uint32_t>(value);
            file.append(reinterpret_cast<const char*>(&four), 4);
        };
        number(2);
        number(12 + 8 + text.size() + 8 + bytes_.size());
        number(text.size());
        file.append("JSON").append(text);
        number(bytes_.size());
        return file.append("BIN\0", 4).append(bytes_);
    }

private:
    json root_;
    std::string bytes_;
};

template <class Make>
Image<Rgb> picture_of(const Surface& surface, Make&& make) {
    Image<Rgb> picture(surface.width(), surface.height());
    for (std::size_t i = 0; i < picture.size(); ++i) picture.pixels()[i] = glm::clamp(make(i), 0.0f, 1.0f);
    return picture;
}

// alpha across the tangent, and along it.
std::pair<float, float> alphas(const Surface& s, std::size_t i) {
    const float alpha = s.roughness.pixels()[i];
    if (s.lobe_axes.empty()) return {alpha, alpha};
    const float across = std::max(s.lobe_axes.pixels()[i].roughness_v, 1e-4f);
    return {across, alpha * alpha / across};
}

json anisotropy_of(const Surface& s, Document& document) {
    const Image<Rgb> picture = picture_of(s, [&](std::size_t i) {
        const auto [across, along] = alphas(s, i);
        const float strength =
            across < 1 ? std::sqrt(std::clamp((along - across) / (1 - across), 0.0f, 1.0f)) : 0;
        const float phi = s.lobe_axes.pixels()[i].tangent;
        return Rgb(0.5f + 0.5f * std::cos(phi), 0.5f + 0.5f * std::sin(phi), strength);
    });
    return {{"anisotropyStrength", 1.0}, {"anisotropyTexture", document.texture(picture)}};
}

json material_of(const Surface& s, bool has_relief, Document& document) {
    const Transfer srgb{Transfer::Kind::srgb};
    float most = 1e-4f;
    for (const float ks : s.specular.pixels()) most = std::max(most, ks);
    const auto specular = [&](std::size_t i) {
        const Rgb colour = s.specular_colour.empty() ? Rgb(1) : s.specular_colour.pixels()[i];
        return srgb.encode(glm::clamp(colour * (s.specular.pixels()[i] / most), 0.0f, 1.0f));
    };
    json material = {
        {"name", "painting"},
        {"pbrMetallicRoughness",
         {{"baseColorTexture", document.texture(picture_of(s,
                                                           [&](std::size_t i) {
                                                               return srgb.encode(glm::clamp(
                                                                   s.diffuse.pixels()[i], 0.0f, 1.0f));
                                                           }))},
          {"metallicFactor", 0},
          {"metallicRoughnessTexture",
           document.texture(
               picture_of(s, [&](std::size_t i) { return Rgb(0, std::sqrt(alphas(s, i).first), 0); }))}}},
        {"extensions",
         {{"KHR_materials_specular",
           {{"specularColorFactor", std::vector<float>(3, most / kDielectric)},
            {"specularColorTexture", document.texture(picture_of(s, specular))}}}}}};
    if (!s.lobe_axes.empty()) material["extensions"]["KHR_materials_anisotropy"] = anisotropy_of(s, document);
    if (!has_relief)
        material["normalTexture"] = document.texture(
            picture_of(s, [&](std::size_t i) { return (s.normal.pixels()[i] + 1.0f) / 2.0f; }));
    return material;
}

// The corners of the picture, where no relief is asked for.
Mesh plane_of(const Surface& s) {
    const auto x = static_cast<float>(s.width() * s.mm_per_pixel / 2),
               y = static_cast<float>(s.height() * s.mm_per_pixel / 2);
    Mesh mesh;
    mesh.vertices = {{-x, y, 0}, {x, y, 0}, {-x, -y, 0}, {x, -y, 0}};
    mesh.normals = std::vector<Vec3>(4, Vec3(0, 0, 1));
    mesh.uv = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
    return mesh;
}

json primitive_of(Mesh mesh, Document& document) {
    const std::size_t count = mesh.normals.size();  // the relief, without walls and base
    mesh.vertices.resize(count);
    std::erase_if(mesh.triangles, [&](const auto& t) { return std::max({t[0], t[1], t[2]}) >= count; });
    Vec3 least(1e30f), most(-1e30f);
    for (Vec3& vertex : mesh.vertices) {
        vertex /= 1000.0f;  // metres
        least = glm::min(least, vertex), most = glm::max(most, vertex);
    }
    // Along x in the picture, so that normal map and anisotropy have their axes.
    std::vector<glm::vec4> tangents(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3& n = mesh.normals[i];
        tangents[i] = glm::vec4(glm::normalize(Vec3(1, 0, 0) - n * n.x), 1.0f);
    }
    const json bounds = {{"min", {least.x, least.y, least.z}}, {"max", {most.x, most.y, most.z}}};
    return {
        {"attributes",
         {{"POSITION", document.accessor("VEC3", kFloats, bytes_of(mesh.vertices), count, kVertices, bounds)},
          {"NORMAL", document.accessor("VEC3", kFloats, bytes_of(mesh.normals), count, kVertices)},
          {"TANGENT", document.accessor("VEC4", kFloats, bytes_of(tangents), count, kVertices)},
          {"TEXCOORD_0", document.accessor("VEC2", kFloats, bytes_of(mesh.uv), count, kVertices)}}},
        {"indices", document.accessor("SCALAR", kIndices, bytes_of(mesh.triangles), 3 * mesh.triangles.size(),
                                      kElements)},
        {"material", 0}};
}

}  // namespace

void write_gltf(const std::filesystem::path& path, const Surface& surface, const std::optional<Mesh>& mesh) {
    Document document;
    document.root()["materials"] = {material_of(surface, mesh.has_value(), document)};
    document.root()["meshes"] = {
        {{"primitives", {primitive_of(mesh ? *mesh : plane_of(surface), document)}}}};
    json extensions = {"KHR_materials_specular"};
    if (!surface.lobe_axes.empty()) extensions.push_back("KHR_materials_anisotropy");
    document.root()["extensionsUsed"] = extensions;
    write_text_file(path, document.glb());
}

}  // namespace tangi
