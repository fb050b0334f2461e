#include "core/meshes/mesh_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/meshes/mesh_parts.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

template <class T>
void append(std::string& bytes, const T& value)
{
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// A triangle with a texture of two pixels and a warning.
std::string stream(int last_vertex = 2, int texture = 0, std::uint32_t texture_width = 2)
{
  MeshStreamHeader header = {};
  std::copy(std::begin(kMeshStreamMagic), std::end(kMeshStreamMagic), header.magic);
  header.vertices = 3;
  header.triangles = header.textures = header.is_metric = 1;
  header.warning_bytes = 8;
  std::string bytes;
  append(bytes, header);
  for (int i = 0; i < 3; ++i)
    append(bytes, cv::Vec3f(static_cast<float>(i), 2, 3));
  for (int i = 0; i < 3; ++i)
    append(bytes, cv::Vec3f(0, 0, 1));
  for (int i = 0; i < 3; ++i)
    append(bytes, cv::Vec2f(0.5F, 0.25F));
  for (int i = 0; i < 3; ++i)
    append(bytes, cv::Vec3b(7, 8, 9));
  append(bytes, cv::Vec3i(0, 1, last_vertex));
  append(bytes, texture);
  append(bytes, texture_width);
  append(bytes, std::uint32_t{1});
  append(bytes, cv::Vec<uchar, 6>(1, 2, 3, 4, 5, 6));
  return bytes + "one\ntwo\n";
}

}  // namespace

TEST(MeshStream, isReadAsItWasWritten)
{
  const StreamedMesh streamed = parseMeshStream(stream());
  const Mesh& mesh = streamed.mesh;
  EXPECT_TRUE(streamed.is_metric);
  EXPECT_EQ(streamed.warnings, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(mesh.vertices, (std::vector<cv::Vec3f>{{0, 2, 3}, {1, 2, 3}, {2, 2, 3}}));
  EXPECT_EQ(mesh.normals, std::vector<cv::Vec3f>(3, {0, 0, 1}));
  EXPECT_EQ(mesh.texture_coordinates, std::vector<cv::Vec2f>(3, {0.5F, 0.25F}));
  EXPECT_EQ(mesh.colors, std::vector<cv::Vec3b>(3, {7, 8, 9}));
  EXPECT_EQ(mesh.triangles, (std::vector<cv::Vec3i>{{0, 1, 2}}));
  EXPECT_EQ(mesh.triangle_textures, std::vector<int>{0});
  ASSERT_EQ(mesh.textures.size(), 1U);
  EXPECT_EQ(mesh.textures[0].at<cv::Vec3b>(0, 1), cv::Vec3b(4, 5, 6));
}

TEST(MeshStream, isRefusedWhereverItIsCut)
{
  const std::string whole = stream();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_EQ(refusal<std::runtime_error>([&] { parseMeshStream(whole.substr(0, size)); }),
              "cannot be read: what read_mesh wrote has been cut off")
        << size;
}

TEST(MeshStream, isRefusedForWhatReadMeshDoesNotWrite)
{
  const std::string unknown = "cannot be read: what read_mesh wrote is no mesh";
  for (const std::string& bytes : {stream() + "x", "x" + stream(), stream(3), stream(-1), stream(2, 1), stream(2, -2),
                                   stream(2, 0, 0), stream(2, 0, 5000)})
    EXPECT_EQ(refusal<std::runtime_error>([&] { parseMeshStream(bytes); }), unknown);
  // It has no vertices but those of triangles: more of them are refused before they are read.
  MeshStreamHeader header = {};
  std::copy(std::begin(kMeshStreamMagic), std::end(kMeshStreamMagic), header.magic);
  header.vertices = 3 * kMaxMeshTriangles + 1;
  std::string many;
  append(many, header);
  EXPECT_EQ(refusal<std::runtime_error>([&] { parseMeshStream(many); }), unknown);
}
