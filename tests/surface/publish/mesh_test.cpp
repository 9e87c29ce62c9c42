// mesh_test.cpp: meshes are closed and look outwards, whatever their size.
#include "surface/publish/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>

namespace tangi {
namespace {

Surface waves(int width, int height) {
    Surface surface(width, height);
    surface.mm_per_pixel = 0.5;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            surface.height_mm(x, y) =
                std::sin(0.3f * static_cast<float>(x)) * std::cos(0.2f * static_cast<float>(y));
    return surface;
}

// Each edge as often in one direction as in the other, and never twice in one.
bool is_closed(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& [a, b, c] : mesh.triangles)
        for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++edges[edge];
    for (const auto& [edge, count] : edges)
        if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
    return true;
}

double volume_mm3(const Mesh& mesh) {
    double six_times = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        six_times += glm::dot(glm::dvec3(mesh.vertices[a]),
                              glm::cross(glm::dvec3(mesh.vertices[b]), glm::dvec3(mesh.vertices[c])));
    return six_times / 6;
}

TEST(Meshes, WithABaseAreClosedAndHoldTheVolumeBelowTheRelief) {
    for (const auto& [width, height] : {std::pair(2, 2), std::pair(64, 48), std::pair(3, 200)}) {
        const Surface surface = waves(width, height);
        const Mesh mesh = mesh_of(surface, {.triangles = 1000000, .base_mm = 3});
        EXPECT_EQ(mesh.columns, width);
        EXPECT_EQ(mesh.rows, height);
        EXPECT_TRUE(is_closed(mesh)) << width << " x " << height;
        const double area_mm2 = 0.25 * (width - 1) * (height - 1);
        EXPECT_GT(volume_mm3(mesh), 3 * area_mm2 * 0.999);
        EXPECT_LT(volume_mm3(mesh), (3 + 2) * area_mm2);
    }
}

TEST(Meshes, WithoutABaseAreTheReliefAlone) {
    const Mesh mesh = mesh_of(waves(20, 10), {.triangles = 1000000, .base_mm = 0});
    EXPECT_EQ(mesh.triangles.size(), 2u * 19 * 9);
    EXPECT_EQ(mesh.vertices.size(), 200u);
    EXPECT_FALSE(is_closed(mesh));
    for (const auto& [a, b, c] : mesh.triangles)
        EXPECT_GT(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]).z, 0);
}

TEST(Meshes, HaveNearlyAsManyTrianglesAsTheyMay) {
    const Surface surface = waves(300, 200);
    for (const int most : {500, 5000, 50000}) {
        const Mesh mesh = mesh_of(surface, {.triangles = most, .base_mm = 1});
        EXPECT_LE(mesh.triangles.size(), static_cast<std::size_t>(most));
        EXPECT_GT(mesh.triangles.size(), static_cast<std::size_t>(0.8 * most));
        EXPECT_TRUE(is_closed(mesh));
    }
}

}  // namespace
}  // namespace tangi
