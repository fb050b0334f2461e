#pragma once

#include <assimp/scene.h>

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace robot_vision
{

struct SceneTexture
{
  int image = -1;            // index; -1: there is none
  unsigned coordinates = 0;  // which of a mesh's sets of coordinates it has
};

/// The textures of the materials of a scene, which are files beside it or parts of it. One that cannot be read is left
/// out, with a warning.
class SceneTextures
{
public:
  /// `path` is that of the file of the scene.
  SceneTextures(const aiScene& scene, const std::string& path);

  /// That of a material's color.
  SceneTexture of(const aiMaterial& material);

  const std::vector<cv::Mat>& images() const { return images_; }

  /// Lines for the user.
  const std::string& warnings() const { return warnings_; }

private:
  /// A part of the scene, or else the path of a file; neither: there is no such texture.
  using Source = std::pair<const aiTexture*, std::string>;

  Source sourceOf(const std::string& name) const;
  std::string fileOf(const std::string& name) const;
  int add(const std::string& name);
  void warn(const std::string& line);

  const aiScene& scene_;
  std::string folder_;
  std::map<std::string, int> known_;  // the indices of names, -1 of those that cannot be read
  std::map<Source, int> indices_;     // of what has been read: one file may have several names
  std::vector<cv::Mat> images_;
  std::uint64_t bytes_ = 0;  // of all images
  std::string warnings_;
};

}  // namespace robot_vision
