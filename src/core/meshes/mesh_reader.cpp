#include "robot_vision/meshes/mesh_reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "mesh_file_check.hpp"
#include "mesh_parts.hpp"
#include "mesh_process.hpp"
#include "mesh_stream.hpp"
#include "mesh_surface.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kTimeout = 90.0;          // s
constexpr double kCrease = 40.0;           // deg
constexpr float kMaxCoordinate = 1000.0F;  // of a texture, that a mesh may have
constexpr float kRepeats = 16.0F;          // of a texture, that are left of more

ProcessResult runReader(const std::string& path)
try
{
  return runProcess(programPath("read_mesh"), {path}, kMaxMeshStream, kTimeout);
}
catch (const std::system_error& e)
{
  throw std::runtime_error(std::string("cannot be read: ") + e.what());
}

/// The output of the program that reads the mesh. Throws, without the path in the text.
std::string outputOf(const std::string& path)
{
  ProcessResult result = runReader(path);
  const std::string limits = " (a mesh of up to 2 million triangles takes less)";
  if (result.timed_out || result.signal == SIGXCPU)
    throw std::runtime_error("cannot be read: it takes too long" + limits);
  if (result.too_long || result.exit_code == kMeshOutOfMemory || result.signal == SIGKILL)
    throw std::runtime_error("cannot be read: it takes too much memory" + limits);
  const std::string words = shortened(result.error.substr(0, result.error.find('\n')));
  // Where this process ignores SIGCHLD nobody learns how that one has ended: what it wrote must do.
  const bool is_unknown = result.exit_code < 0 && result.signal == 0;
  if (result.exit_code == kMeshRefused || (is_unknown && result.output.empty()))
    throw std::invalid_argument(words.empty() ? "it is no mesh" : words);
  if (result.exit_code != 0 && !is_unknown)
    throw std::runtime_error("cannot be read, as it is damaged: the program that reads it has ended with " +
                             (result.signal != 0 ? "signal " + std::to_string(result.signal)
                                                 : "exit code " + std::to_string(result.exit_code)) +
                             (words.empty() ? "" : ", " + words));
  return std::move(result.output);
}

bool isFinite(const cv::Vec3f& v)
{
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// Makes numbers that only change what it looks like into some that can be used. A file `has_look` unless it has only a
/// shape, and normals and a color that somebody had to fill in.
void repairLook(Mesh& mesh, bool has_look)
{
  for (cv::Vec3f& normal : mesh.normals)
    normal = has_look && isFinite(normal) ? cv::normalize(normal) : cv::Vec3f();
  for (cv::Vec2f& uv : mesh.texture_coordinates)
    for (float& number : uv.val)
    {
      if (!std::isfinite(number)) number = 0.0F;
      if (std::abs(number) > kMaxCoordinate) number = std::fmod(number, kRepeats);
    }
  const bool textured =
      std::any_of(mesh.triangle_textures.begin(), mesh.triangle_textures.end(), [](int t) { return t >= 0; });
  if (!textured)
  {
    mesh.texture_coordinates.clear();
    mesh.triangle_textures.clear();
    mesh.textures.clear();
  }
  if (std::any_of(mesh.colors.begin(), mesh.colors.end(), [&](const cv::Vec3b& c) { return c != mesh.colors[0]; }))
    return;
  if (has_look && !mesh.colors.empty()) mesh.color = mesh.colors[0];
  mesh.colors.clear();
}

cv::Vec3d sizeOf(const Mesh& mesh)
{
  cv::Vec3d low = mesh.vertices[0], high = low;
  for (const cv::Vec3f& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis)
    {
      low[axis] = std::min<double>(low[axis], vertex[axis]);
      high[axis] = std::max<double>(high[axis], vertex[axis]);
    }
  return high - low;
}

/// Whether files of a format have more than a shape.
bool hasLook(const std::string& path)
{
  std::string suffix = std::filesystem::path(path).extension();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  return suffix != ".stl";
}

void addWarnings(LoadedMesh& loaded)
{
  if (loaded.dropped > 0)
    loaded.warnings.push_back("triangles without an area were left out: " + std::to_string(loaded.dropped));
  if (!loaded.closed)
    loaded.warnings.push_back("the surface is not closed, so both of its sides are seen: " +
                              std::to_string(loaded.open_edges) + " edges have a triangle at one side only");
}

/// Throws, without the path in the text.
LoadedMesh load(const std::string& path, const std::string& unit, double scale)
{
  checkMeshFile(path);
  StreamedMesh streamed = parseMeshStream(outputOf(path));
  LoadedMesh loaded;
  loaded.warnings = std::move(streamed.warnings);
  Mesh& mesh = loaded.mesh = std::move(streamed.mesh);
  if (mesh.triangles.empty()) throw std::invalid_argument("it has no triangles");
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), isFinite))
    throw std::invalid_argument("it has vertices that are not finite");
  repairLook(mesh, hasLook(path));
  loaded.dropped = tidy(mesh);
  if (mesh.triangles.empty()) throw std::invalid_argument("none of its triangles has an area");
  const MeshUnit found = meshUnit(unit, streamed.is_metric, sizeOf(mesh), scale);
  loaded.unit = found.name;
  loaded.unit_reason = found.reason;
  for (cv::Vec3f& vertex : mesh.vertices)
    vertex *= static_cast<float>(found.metres * scale);
  const MeshSurface surface = meshSurface(mesh);
  loaded.open_edges = surface.open_edges;
  loaded.closed = surface.open_edges == 0;
  turnOutsideOut(mesh, surface.outsides);
  turnNormals(mesh);
  addNormals(mesh, surface.places, kCrease);
  tidy(mesh);
  validate(mesh);
  addWarnings(loaded);
  return loaded;
}

}  // namespace

LoadedMesh readMesh(const std::string& path, const std::string& unit, double scale)
{
  try
  {
    return load(path, unit, scale);
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument(shortened(path) + ": " + e.what());
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(shortened(path) + " " + e.what());
  }
}

}  // namespace robot_vision
