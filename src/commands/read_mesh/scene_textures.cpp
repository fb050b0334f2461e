#include "scene_textures.hpp"

#include <assimp/material.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/meshes/mesh_stream.hpp"

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

constexpr double kMaxFileSize = 256e6;  // bytes

cv::Mat decoded(const unsigned char* bytes, unsigned size)
{
  return cv::imdecode(cv::Mat(1, static_cast<int>(size), CV_8UC1, const_cast<unsigned char*>(bytes)),
                      cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

/// A texture that is a part of the file: an image file, or pixels.
cv::Mat embedded(const aiTexture& texture)
{
  if (texture.mHeight == 0) return decoded(reinterpret_cast<const unsigned char*>(texture.pcData), texture.mWidth);
  cv::Mat image(static_cast<int>(texture.mHeight), static_cast<int>(texture.mWidth), CV_8UC3);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
    {
      const aiTexel& texel =
          texture.pcData[static_cast<std::size_t>(row) * texture.mWidth + static_cast<std::size_t>(column)];
      image.at<cv::Vec3b>(row, column) = {texel.b, texel.g, texel.r};
    }
  return image;
}

cv::Mat reduced(const cv::Mat& image)
{
  const int side = std::max(image.cols, image.rows), most = static_cast<int>(kMaxTextureSide);
  if (image.empty() || side <= most) return image;
  const double scale = static_cast<double>(most) / side;
  cv::Mat smaller;
  cv::resize(image, smaller, {std::max(cvRound(image.cols * scale), 1), std::max(cvRound(image.rows * scale), 1)}, 0, 0,
             cv::INTER_AREA);
  return smaller;
}

/// Empty if it cannot be read. `source` is a part of the scene, or else the path of a file.
cv::Mat read(const std::pair<const aiTexture*, std::string>& source)
try
{
  const auto& [texture, path] = source;
  return reduced(texture != nullptr ? embedded(*texture)
                                    : cv::imread(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION));
}
catch (const cv::Exception&)
{
  return {};
}

bool isReadable(const fs::path& path)
{
  std::error_code error;
  return fs::is_regular_file(path, error) && static_cast<double>(fs::file_size(path, error)) <= kMaxFileSize && !error;
}

/// What a URI stands for: %20 is a space.
std::string unescaped(const std::string& uri)
{
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i)
  {
    const std::string digits = uri.substr(i + 1 > uri.size() ? uri.size() : i + 1, 2);
    const bool escape =
        uri[i] == '%' && digits.size() == 2 && digits.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
    text += escape ? static_cast<char>(std::stoi(digits, nullptr, 16)) : uri[i];
    if (escape) i += 2;
  }
  return text;
}

}  // namespace

SceneTextures::SceneTextures(const aiScene& scene, const std::string& path)
  : scene_(scene), folder_(fs::path(path).parent_path())
{
}

void SceneTextures::warn(const std::string& line)
{
  if (warnings_.size() + line.size() + 1 <= kMeshWarningBytes) warnings_ += line + "\n";
}

SceneTexture SceneTextures::of(const aiMaterial& material)
{
  aiString name;
  SceneTexture texture;
  const auto has = [&](aiTextureType type)
  { return material.GetTexture(type, 0, &name, nullptr, &texture.coordinates) == AI_SUCCESS; };
  if (!has(aiTextureType_BASE_COLOR) && !has(aiTextureType_DIFFUSE)) return {};
  const auto [known, is_new] = known_.try_emplace(name.C_Str(), -1);
  if (is_new) known->second = add(known->first);
  texture.image = known->second;
  return texture;
}

int SceneTextures::add(const std::string& name)
{
  const Source source = sourceOf(name);
  const auto same = indices_.find(source);
  if (same != indices_.end()) return same->second;
  bool is_too_many = images_.size() >= kMaxMeshTextures;
  const cv::Mat image = is_too_many ? cv::Mat() : read(source);
  const std::uint64_t bytes = image.total() * image.elemSize();
  is_too_many = is_too_many || bytes_ + bytes > kMaxTextureBytes;
  if (is_too_many || image.empty())
  {
    warn("the texture " + name + (is_too_many ? " is one too many" : " cannot be read") +
         ": what has it is of one color");
    return -1;
  }
  bytes_ += bytes;
  images_.push_back(image.isContinuous() ? image : image.clone());
  return indices_[source] = static_cast<int>(images_.size()) - 1;
}

SceneTextures::Source SceneTextures::sourceOf(const std::string& name) const
{
  const aiTexture* texture = scene_.GetEmbeddedTexture(name.c_str());
  return {texture, texture != nullptr ? "" : fileOf(name)};
}

/// Many files name their textures as they were on the machine that made them. So a file of this name beside the mesh
/// will do.
std::string SceneTextures::fileOf(const std::string& name) const
{
  std::string path = unescaped(name);
  std::replace(path.begin(), path.end(), '\\', '/');
  const fs::path beside = fs::path(folder_) / fs::path(path).filename();
  for (const fs::path& candidate : {fs::path(folder_) / name, fs::path(folder_) / path, beside})
    if (isReadable(candidate)) return fs::canonical(candidate).string();
  return "";
}

}  // namespace robot_vision
