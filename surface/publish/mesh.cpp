#include "surface/publish/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace {

struct Grid {
    int columns, rows;
};

int triangles_of(const Grid& grid, bool closed) {
    const int along = grid.columns - 1, down = grid.rows - 1;
    return 2 * along * down + (closed ? 3 * 2 * (along + down) : 0);
}

// As fine as the number allows, with cells that are as square as can be.
Grid grid_of(const Surface& surface, const MeshOptions& options) {
    const int width = surface.width(), height = surface.height();
    const auto of_spacing = [&](double pixels) {
        return Grid{std::max(static_cast<int>((width - 1) / pixels) + 1, 2),
                    std::max(static_cast<int>((height - 1) / pixels) + 1, 2)};
    };
    double fine = 1, coarse = std::max(width, height);
    const bool closed = options.base_mm > 0;
    if (triangles_of(of_spacing(fine), closed) <= options.triangles) return of_spacing(fine);
    for (int i = 0; i < 60; ++i) {
        const double middle = std::sqrt(fine * coarse);
        (triangles_of(of_spacing(middle), closed) <= options.triangles ? coarse : fine) = middle;
    }
    return of_spacing(coarse);
}

// A sum over the pixels nearest to a vertex of the grid, and how many there are.
template <class Value, class Take>
Value mean_around(double x, double y, double step_x, double step_y, const Region& all, Take&& take) {
    const auto range = [](double at, double step, int end) {
        const int first = std::clamp(static_cast<int>(std::ceil(at - step / 2)), 0, end - 1);
        return std::pair(first, std::clamp(static_cast<int>(std::ceil(at + step / 2)), first + 1, end));
    };
    const auto [x0, x1] = range(x, step_x, all.width());
    const auto [y0, y1] = range(y, step_y, all.height());
    Value sum(0);
    for (int row = y0; row < y1; ++row)
        for (int column = x0; column < x1; ++column) sum += take(column, row);
    return sum / static_cast<float>((x1 - x0) * (y1 - y0));
}

// The relief's vertices along its border, counter-clockwise as seen from above.
std::vector<std::uint32_t> border_of(const Grid& grid) {
    std::vector<std::uint32_t> loop;
    const auto id = [&](int column, int row) {
        return static_cast<std::uint32_t>(row * grid.columns + column);
    };
    const int right = grid.columns - 1, bottom = grid.rows - 1;
    for (int i = 0; i < right; ++i) loop.push_back(id(i, bottom));
    for (int j = bottom; j > 0; --j) loop.push_back(id(right, j));
    for (int i = right; i > 0; --i) loop.push_back(id(i, 0));
    for (int j = 0; j < bottom; ++j) loop.push_back(id(0, j));
    return loop;
}

// Walls down from the border, and a fan below, whose outline is convex.
void close(Mesh& mesh, const Grid& grid, double base_mm) {
    const auto lowest = std::ranges::min_element(mesh.vertices, {}, &Vec3::z)->z;
    const auto z = lowest - static_cast<float>(base_mm);
    const std::vector<std::uint32_t> border = border_of(grid);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size()),
               count = static_cast<std::uint32_t>(border.size());
    const Rgb grey(0.5f);
    for (const std::uint32_t top : border) {
        mesh.vertices.push_back({mesh.vertices[top].x, mesh.vertices[top].y, z});
        mesh.colours_srgb.push_back(grey);
    }
    mesh.vertices.push_back({0, 0, z});
    mesh.colours_srgb.push_back(grey);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count, below = first + i, below_next = first + next;
        mesh.triangles.push_back({border[i], below, below_next});
        mesh.triangles.push_back({border[i], below_next, border[next]});
        mesh.triangles.push_back({first + count, below_next, below});
    }
}

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string stl_of(const Mesh& mesh) {
    std::string bytes = program_name() + ", millimetres";
    bytes.resize(80, ' ');
    append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 across =
            glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
        append(bytes, across / std::max(glm::length(across), 1e-30f));
        for (const std::uint32_t v : {a, b, c}) append(bytes, mesh.vertices[v]);
        append(bytes, std::uint16_t{0});
    }
    return bytes;
}

std::string ply_of(const Mesh& mesh) {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment {}, millimetres\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        program_name(), mesh.vertices.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        append(bytes, mesh.vertices[i]);
        for (int c = 0; c < 3; ++c)
            append(bytes, static_cast<std::uint8_t>(std::lround(255 * mesh.colours_srgb[i][c])));
    }
    for (const auto& triangle : mesh.triangles) {
        append(bytes, std::uint8_t{3});
        append(bytes, triangle);
    }
    return bytes;
}

std::string obj_of(const Mesh& mesh) {
    std::string text = fmt::format("# {}, millimetres\n", program_name());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3& v = mesh.vertices[i];
        const Rgb& c = mesh.colours_srgb[i];
        fmt::format_to(std::back_inserter(text), "v {} {} {} {:.4g} {:.4g} {:.4g}\n", v.x, v.y, v.z, c.r, c.g,
                       c.b);
    }
    for (const auto& [a, b, c] : mesh.triangles)
        fmt::format_to(std::back_inserter(text), "f {} {} {}\n", a + 1, b + 1, c + 1);
    return text;
}

}  // namespace

Mesh mesh_of(const Surface& surface, const MeshOptions& options) {
    const Grid grid = grid_of(surface, options);
    const double step_x = (surface.width() - 1.0) / (grid.columns - 1),
                 step_y = (surface.height() - 1.0) / (grid.rows - 1);
    const Region all = surface.height_mm.region();
    const Transfer srgb{Transfer::Kind::srgb};
    Mesh mesh;
    mesh.columns = grid.columns, mesh.rows = grid.rows;
    for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < grid.columns; ++i) {
            const double x = i * step_x, y = j * step_y;
            const auto mean = [&]<class T>(const Image<T>& map) {
                return mean_around<T>(x, y, step_x, step_y, all, [&](int c, int r) { return map(c, r); });
            };
            mesh.vertices.push_back(
                {static_cast<float>((x - (surface.width() - 1) / 2.0) * surface.mm_per_pixel),
                 static_cast<float>(((surface.height() - 1) / 2.0 - y) * surface.mm_per_pixel),
                 mean(surface.height_mm)});
            mesh.normals.push_back(glm::normalize(mean(surface.normal)));
            mesh.uv.push_back({(x + 0.5) / surface.width(), (y + 0.5) / surface.height()});
            mesh.colours_srgb.push_back(glm::clamp(srgb.encode(mean(surface.diffuse)), 0.0f, 1.0f));
        }
    for (int j = 0; j + 1 < grid.rows; ++j)
        for (int i = 0; i + 1 < grid.columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * grid.columns + i), b = a + 1,
                       c = a + static_cast<std::uint32_t>(grid.columns), d = c + 1;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    if (options.base_mm > 0) close(mesh, grid, options.base_mm);
    return mesh;
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
    const std::string extension = lower_extension(path);
    if (extension == ".stl") return write_text_file(path, stl_of(mesh));
    if (extension == ".ply") return write_text_file(path, ply_of(mesh));
    if (extension == ".obj") return write_text_file(path, obj_of(mesh));
    fail("{}: meshes are written as .stl, .ply or .obj", path.string());
}

}  // namespace tangi
