#include "robot_vision/meshes/mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core/affine.hpp>

#include "core/meshes/mesh_parts.hpp"
#include "core/meshes/mesh_surface.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

Mesh tetrahedron()
{
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

/// The refusal of a tetrahedron with a change.
template <class Change>
std::string refusalOf(Change change)
{
  Mesh mesh = tetrahedron();
  change(mesh);
  return refusal([&] { validate(mesh); });
}

/// A cube of eight vertices.
Mesh cube(float side)
{
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? side : 0, i & 2 ? side : 0, i & 4 ? side : 0);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace

TEST(Mesh, isRefusedForWhatNoneCanHave)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusalOf([](Mesh&) {}), "");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.vertices.clear(); }), "number of vertices is 0, must be from 1 to 2^30 - 1");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.triangles.clear(); }), "number of triangles is 0, must be from 1 to 2^30 - 1");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.triangles[1][2] = 4; }), "a vertex of a triangle is 4, must be from 0 to 3");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.triangles[1][2] = -1; }), "a vertex of a triangle is -1, must be from 0 to 3");
  EXPECT_EQ(refusalOf([=](Mesh& m) { m.vertices[2][1] = nan; }), "vertex 2 is nan, must be finite and at most 1000");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.vertices[3][1] = -2e3F; }), "vertex 3 is -2000, must be finite and at most 1000");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.normals.resize(3); }),
            "number of normals is 3, must be 4, as there are vertices, or 0");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.colors.resize(5); }),
            "number of colors is 5, must be 4, as there are vertices, or 0");
  EXPECT_EQ(refusalOf([](Mesh& m) { m.textures.emplace_back(2, 2, CV_8UC1); }),
            "a texture is of another type, must be an 8-bit BGR image");
  EXPECT_EQ(refusalOf(
                [](Mesh& m) {
                  m.triangle_textures = {0, 0, 0, 0};
                }),
            "the texture of a triangle is 0, must be from -1 to -1");
  EXPECT_EQ(refusalOf(
                [](Mesh& m)
                {
                  m.textures.emplace_back(2, 2, CV_8UC3);
                  m.triangle_textures = {-1, 0, -1, -1};
                }),
            "number of texture coordinates is 0, must be that of the vertices where triangles have textures");
}

TEST(MeshExtent, isThatOfTheVerticesInUse)
{
  Mesh mesh = cube(0.2F);
  mesh.vertices.emplace_back(9.0F, 9.0F, 9.0F);  // of no triangle
  const MeshExtent extent = meshExtent(mesh);
  EXPECT_NEAR(cv::norm(extent.center - cv::Vec3d(0.1, 0.1, 0.1)), 0.0, 1e-8);
  EXPECT_NEAR(cv::norm(extent.size - cv::Vec3d(0.2, 0.2, 0.2)), 0.0, 1e-8);
  EXPECT_NEAR(extent.diameter, 0.2 * std::sqrt(3.0), 1e-8);
  EXPECT_NEAR(extent.radius, 0.1 * std::sqrt(3.0), 1e-8);
}

TEST(MeshExtent, hasTheLargestDistanceOfTwoVertices)
{
  for (const std::string& name : sampleMeshNames())
  {
    const Mesh mesh = sampleMesh(name).mesh;
    double largest = 0.0;
    for (const cv::Vec3f& a : mesh.vertices)
      for (const cv::Vec3f& b : mesh.vertices)
        largest = std::max(largest, (a - b).dot(a - b) * 1.0);
    EXPECT_NEAR(meshExtent(mesh).diameter / std::sqrt(largest), 1.0, 1e-6) << name;
  }
}

TEST(MeshSurface, tellsWhichSideIsOutside)
{
  Mesh mesh = cube(1.0F);
  EXPECT_EQ(meshSurface(mesh).open_edges, 0);
  EXPECT_EQ(meshSurface(mesh).outsides, std::vector<std::int8_t>(12, 1));
  for (cv::Vec3i& triangle : mesh.triangles)
    std::swap(triangle[0], triangle[1]);
  EXPECT_EQ(meshSurface(mesh).outsides, std::vector<std::int8_t>(12, -1));
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);  // one is turned: which side is which cannot be told
  EXPECT_EQ(meshSurface(mesh).open_edges, 0);
  EXPECT_EQ(meshSurface(mesh).outsides, std::vector<std::int8_t>(12, 0));
  mesh.triangles.pop_back();
  EXPECT_EQ(meshSurface(mesh).open_edges, 3);
}

TEST(MeshSurface, looksAtEachPartByItself)
{
  Mesh mesh = cube(1.0F);
  const Mesh other = tetrahedron();
  for (const cv::Vec3i& triangle : other.triangles)
    mesh.triangles.push_back(cv::Vec3i(triangle[0], triangle[2], triangle[1]) + cv::Vec3i::all(8));
  for (const cv::Vec3f& vertex : other.vertices)
    mesh.vertices.push_back(vertex + cv::Vec3f(3, 0, 0));
  std::vector<std::int8_t> outsides(12, 1);
  outsides.resize(16, -1);
  EXPECT_EQ(meshSurface(mesh).outsides, outsides);
}

TEST(MeshSurface, takesVerticesAtOnePlaceForOne)
{
  Mesh mesh;
  const Mesh whole = cube(1.0F);
  for (const cv::Vec3i& triangle : whole.triangles)  // three vertices for each triangle, as in STL files
  {
    const auto first = static_cast<int>(mesh.vertices.size());
    for (const int vertex : triangle.val)
      mesh.vertices.push_back(whole.vertices[static_cast<std::size_t>(vertex)]);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  EXPECT_EQ(meshSurface(mesh).open_edges, 0);
  EXPECT_EQ(meshSurface(mesh).outsides, std::vector<std::int8_t>(12, 1));
  EXPECT_EQ(tidy(mesh), 0);
  EXPECT_EQ(mesh.vertices.size(), 8U);
}

TEST(Tidying, dropsWhatHasNoArea)
{
  Mesh mesh = cube(0.1F);
  mesh.triangles.emplace_back(0, 0, 1);
  mesh.vertices.emplace_back(0.05F, 0.0F, 0.0F);
  mesh.triangles.emplace_back(0, 1, 8);
  EXPECT_EQ(tidy(mesh), 2);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.vertices.size(), 8U);
}

TEST(AddedNormals, areSmoothButForSharpEdges)
{
  Mesh mesh = cube(0.1F);
  addNormals(mesh, meshSurface(mesh).places, 40.0);
  tidy(mesh);
  EXPECT_EQ(mesh.vertices.size(), 24U);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const int vertex : mesh.triangles[i].val)
    {
      const auto corner = [&](int k) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[i][k])]; };
      const cv::Vec3f normal = cv::normalize((corner(1) - corner(0)).cross(corner(2) - corner(0)));
      EXPECT_NEAR(cv::norm(mesh.normals[static_cast<std::size_t>(vertex)] - normal), 0.0, 1e-6);
    }
  Mesh round = cube(0.1F);
  addNormals(round, meshSurface(round).places, 100.0);
  tidy(round);
  EXPECT_EQ(round.vertices.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i)  // outwards along the diagonals
  {
    const cv::Vec3f way = cv::normalize(round.vertices[i] - cv::Vec3f(0.05F, 0.05F, 0.05F));
    EXPECT_NEAR(cv::norm(round.normals[i] - way), 0.0, 1e-6);
  }
}
