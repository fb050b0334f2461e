#include "mesh_stream.hpp"

#include <cstring>
#include <sstream>
#include <stdexcept>

#include "mesh_parts.hpp"
#include "robot_vision/common/printable.hpp"

namespace robot_vision
{
namespace
{

/// Takes one thing after the other from bytes that may end too early.
class Reader
{
public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  void take(void* to, std::size_t size)
  {
    if (size > bytes_.size() - at_) throw std::runtime_error("cannot be read: what read_mesh wrote has been cut off");
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }

  template <class T>
  std::vector<T> list(std::uint64_t count)
  {
    if (count > (bytes_.size() - at_) / sizeof(T))
      throw std::runtime_error("cannot be read: what read_mesh wrote has been cut off");
    std::vector<T> numbers(static_cast<std::size_t>(count));
    take(numbers.data(), numbers.size() * sizeof(T));
    return numbers;
  }

  bool ended() const { return at_ == bytes_.size(); }

private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

void requireKnown(bool ok)
{
  if (!ok) throw std::runtime_error("cannot be read: what read_mesh wrote is no mesh");
}

std::uint64_t bytesOf(const cv::Mat& image)
{
  return image.total() * image.elemSize();
}

cv::Mat takeTexture(Reader& reader)
{
  std::uint32_t size[2] = {};
  reader.take(size, sizeof(size));
  requireKnown(size[0] > 0 && size[1] > 0 && size[0] <= kMaxTextureSide && size[1] <= kMaxTextureSide);
  cv::Mat image(static_cast<int>(size[1]), static_cast<int>(size[0]), CV_8UC3);
  reader.take(image.data, bytesOf(image));
  return image;
}

}  // namespace

StreamedMesh parseMeshStream(const std::string& bytes)
{
  Reader reader(bytes);
  MeshStreamHeader header = {};
  reader.take(&header, sizeof(header));
  requireKnown(std::memcmp(header.magic, kMeshStreamMagic, sizeof(header.magic)) == 0 && header.is_metric <= 1 &&
               header.vertices <= kMaxMeshVertices && header.triangles <= kMaxMeshTriangles &&
               header.textures <= kMaxMeshTextures);
  StreamedMesh streamed;
  streamed.is_metric = header.is_metric == 1;
  Mesh& mesh = streamed.mesh;
  mesh.vertices = reader.list<cv::Vec3f>(header.vertices);
  mesh.normals = reader.list<cv::Vec3f>(header.vertices);
  mesh.texture_coordinates = reader.list<cv::Vec2f>(header.vertices);
  mesh.colors = reader.list<cv::Vec3b>(header.vertices);
  mesh.triangles = reader.list<cv::Vec3i>(header.triangles);
  mesh.triangle_textures = reader.list<int>(header.triangles);
  std::uint64_t texture_bytes = 0;
  for (std::uint64_t i = 0; i < header.textures; ++i)
  {
    mesh.textures.push_back(takeTexture(reader));
    texture_bytes += bytesOf(mesh.textures.back());
    requireKnown(texture_bytes <= kMaxTextureBytes);
  }
  const std::vector<char> warnings = reader.list<char>(header.warning_bytes);
  requireKnown(reader.ended());
  for (const cv::Vec3i& triangle : mesh.triangles)
    for (const int vertex : triangle.val)
      requireKnown(vertex >= 0 && static_cast<std::uint64_t>(vertex) < header.vertices);
  for (const int texture : mesh.triangle_textures)
    requireKnown(texture >= -1 && texture < static_cast<int>(header.textures));
  std::istringstream lines(std::string(warnings.begin(), warnings.end()));
  for (std::string line; std::getline(lines, line);)
    streamed.warnings.push_back(shortened(line));
  return streamed;
}

}  // namespace robot_vision
