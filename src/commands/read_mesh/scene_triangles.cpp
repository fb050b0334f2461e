#include "scene_triangles.hpp"

#include <assimp/material.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "scene_textures.hpp"

namespace robot_vision
{
namespace
{

cv::Vec3f toVector(const aiVector3D& v)
{
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

cv::Vec3b toBgr(const aiColor4D& color)
{
  const auto byte = [](float part)
  { return static_cast<uchar>(std::isfinite(part) ? std::clamp(part, 0.0F, 1.0F) * 255.0F + 0.5F : 0.0F); };
  return {byte(color.b), byte(color.g), byte(color.r)};
}

bool endsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() &&
         std::equal(end.rbegin(), end.rend(), text.rbegin(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

bool isGltf(const std::string& path)
{
  return endsWith(path, ".gltf") || endsWith(path, ".glb");
}

/// Returns a color as images have it, of one whose parts grow with the light.
aiColor4D toSrgb(const aiColor4D& linear)
{
  const auto curved = [](float part)
  { return part <= 0.0031308F ? 12.92F * part : 1.055F * std::pow(part, 1.0F / 2.4F) - 0.055F; };
  return {curved(linear.r), curved(linear.g), curved(linear.b), linear.a};
}

/// Puts the meshes of a scene, at the places that its nodes give them, into one list.
class Collector
{
public:
  Collector(const aiScene& scene, const std::string& path)
    : scene_(scene), textures_(scene, path), is_linear_(isGltf(path))
  {
  }

  SceneTriangles collect()
  {
    addNode(*scene_.mRootNode, aiMatrix4x4());
    result_.textures = textures_.images();
    result_.warnings = textures_.warnings();
    return std::move(result_);
  }

private:
  struct Placed
  {
    const aiMesh& mesh;
    const aiMatrix4x4& pose;
    aiMatrix3x3 normal_pose;
    cv::Vec3b color;       // of vertices without one
    unsigned coordinates;  // the set of those of its texture
  };

  void addNode(const aiNode& node, const aiMatrix4x4& parent)
  {
    const aiMatrix4x4 pose = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      if (node.mMeshes[i] < scene_.mNumMeshes) addMesh(*scene_.mMeshes[node.mMeshes[i]], pose);
    for (unsigned i = 0; i < node.mNumChildren; ++i)
      addNode(*node.mChildren[i], pose);
  }

  void addMesh(const aiMesh& mesh, const aiMatrix4x4& pose)
  {
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return;
    count_ += mesh.mNumFaces;
    if (count_ > kMaxMeshTriangles)
      throw std::invalid_argument("it has " + std::to_string(std::max<std::uint64_t>(count_, countAll())) +
                                  " triangles, must have at most " + std::to_string(kMaxMeshTriangles));
    const aiMaterial* material =
        mesh.mMaterialIndex < scene_.mNumMaterials ? scene_.mMaterials[mesh.mMaterialIndex] : nullptr;
    const SceneTexture texture =
        mesh.GetNumUVChannels() > 0 && material != nullptr ? textures_.of(*material) : SceneTexture();
    const unsigned coordinates = mesh.HasTextureCoords(texture.coordinates) ? texture.coordinates : 0;
    const Placed placed = {mesh, pose, aiMatrix3x3(pose).Inverse().Transpose(), colorOf(material), coordinates};
    // What no triangle has is left out: it could be any number of vertices.
    std::vector<int> places(mesh.mNumVertices, -1);
    const auto place_of = [&](unsigned vertex)
    {
      if (places[vertex] < 0) places[vertex] = addVertex(placed, vertex);
      return places[vertex];
    };
    addFaces(mesh, place_of, pose.Determinant() < 0.0F, texture.image);
  }

  std::uint64_t countAll() const
  {
    std::uint64_t count = 0;
    for (unsigned i = 0; i < scene_.mNumMeshes; ++i)
      count += scene_.mMeshes[i]->mNumFaces;
    return count;
  }

  cv::Vec3b colorOf(const aiMaterial* material) const
  {
    aiColor4D diffuse;
    const bool is_given = material != nullptr && material->Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) == aiReturn_SUCCESS;
    return is_given ? shown(diffuse) : toBgr(aiColor4D(0.63F, 0.63F, 0.63F, 1.0F));
  }

  /// The colors of glTF's materials and vertices are linear, and those of other formats as they are shown.
  cv::Vec3b shown(const aiColor4D& color) const { return toBgr(is_linear_ ? toSrgb(color) : color); }

  /// Returns its index.
  int addVertex(const Placed& placed, unsigned i)
  {
    const aiMesh& mesh = placed.mesh;
    result_.vertices.push_back(toVector(placed.pose * mesh.mVertices[i]));
    result_.normals.push_back(mesh.HasNormals() ? toVector(placed.normal_pose * mesh.mNormals[i]) : cv::Vec3f());
    const unsigned set = placed.coordinates;
    const aiVector3D uv = mesh.HasTextureCoords(set) ? mesh.mTextureCoords[set][i] : aiVector3D();
    result_.texture_coordinates.emplace_back(static_cast<float>(uv.x), static_cast<float>(uv.y));
    result_.colors.push_back(mesh.HasVertexColors(0) ? shown(mesh.mColors[0][i]) : placed.color);
    return static_cast<int>(result_.vertices.size()) - 1;
  }

  template <class PlaceOf>
  void addFaces(const aiMesh& mesh, const PlaceOf& place_of, bool mirrored, int texture)
  {
    for (unsigned i = 0; i < mesh.mNumFaces; ++i)
    {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      const unsigned a = face.mIndices[0], b = face.mIndices[mirrored ? 2 : 1], c = face.mIndices[mirrored ? 1 : 2];
      if (std::max({a, b, c}) >= mesh.mNumVertices)
        throw std::invalid_argument("a triangle has a vertex that is not there");
      result_.triangles.emplace_back(place_of(a), place_of(b), place_of(c));
      result_.triangle_textures.push_back(texture);
    }
  }

  const aiScene& scene_;
  SceneTextures textures_;
  const bool is_linear_;
  SceneTriangles result_;
  std::uint64_t count_ = 0;
};

}  // namespace

SceneTriangles trianglesOf(const aiScene& scene, const std::string& path)
{
  SceneTriangles triangles = Collector(scene, path).collect();
  // Collada files say which unit they have, which is applied; glTF has no other one.
  triangles.is_metric = endsWith(path, ".dae") || isGltf(path);
  return triangles;
}

}  // namespace robot_vision
