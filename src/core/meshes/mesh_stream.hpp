#pragma once

#include <cstdint>

// What the program read_mesh writes for readMesh(), on one machine: a header, and behind it, without gaps,
//
//   float vertices[vertices][3]         of triangles, in the unit of the file
//   float normals[vertices][3]          0, 0, 0: there is none
//   float texture_coordinates[vertices][2]
//   uint8 colors[vertices][3]           BGR
//   int32 triangles[triangles][3]
//   int32 triangle_textures[triangles]  -1: none
//   textures, each: uint32 width, uint32 height, uint8 pixels[height][width][3] BGR
//   char warnings[warning_bytes]        lines of UTF-8
namespace robot_vision
{

struct MeshStreamHeader
{
  char magic[8];
  std::uint64_t vertices;
  std::uint64_t triangles;
  std::uint64_t textures;
  std::uint64_t warning_bytes;
  std::uint64_t is_metric;  // 1: the format says that the unit is m
};

constexpr char kMeshStreamMagic[8] = {'r', 'v', 'm', 'e', 's', 'h', '0', '1'};
constexpr std::uint64_t kMaxMeshTriangles = 2000000;
constexpr std::uint64_t kMaxMeshVertices = 3 * kMaxMeshTriangles;  // those of the triangles only
constexpr std::uint64_t kMaxMeshTextures = 64;
constexpr std::uint64_t kMaxTextureBytes = std::uint64_t{256} << 20;  // of all together
constexpr std::uint32_t kMaxTextureSide = 4096;                       // px; larger ones are reduced to it
constexpr std::uint64_t kMeshWarningBytes = 4000;
constexpr std::uint64_t kMaxMeshStream = sizeof(MeshStreamHeader) + kMaxMeshVertices * (8 * sizeof(float) + 3) +
                                         kMaxMeshTriangles * 4 * sizeof(std::int32_t) + kMaxTextureBytes +
                                         kMaxMeshTextures * 2 * sizeof(std::uint32_t) + kMeshWarningBytes;  // bytes

// How the program ends when it has written no mesh.
constexpr int kMeshRefused = 3;  // one line on stderr says why
constexpr int kMeshOutOfMemory = 4;

}  // namespace robot_vision
