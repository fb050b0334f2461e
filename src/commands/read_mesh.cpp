// Reads a mesh for robot_vision::readMesh(), which starts this program for it: a hostile file can have a library of
// dozens of formats crash, run in circles or eat memory. It is not for users.

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <assimp/Importer.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>

#include "read_mesh/scene_triangles.hpp"

namespace
{

using namespace robot_vision;

constexpr rlim_t kMemory = rlim_t{2} << 30;  // bytes, besides those of the program itself
constexpr rlim_t kTime = 20;                 // s that it may compute

void limit(int resource, rlim_t value)
{
  const rlimit both = {value, value + 1};  // at the second one the kernel does not say for what it ends the program
  setrlimit(static_cast<decltype(RLIMIT_CPU)>(resource), &both);
}

void limitWork()
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);  // no file can be written
  limit(RLIMIT_CPU, kTime);
#ifndef __SANITIZE_ADDRESS__
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  limit(RLIMIT_AS, pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + kMemory);
#endif
}

[[noreturn]] void endOutOfMemory()
{
  _exit(kMeshOutOfMemory);
}

const aiScene& import(const std::string& path, Assimp::Importer& importer)
{
  // rviz and others, too, leave the axes of Collada files as they are.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(
      path, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_FlipUVs | aiProcess_TransformUVCoords);
  if (scene == nullptr || scene->mRootNode == nullptr) throw std::invalid_argument(importer.GetErrorString());
  return *scene;
}

void write(const void* bytes, std::size_t size)
{
  if (std::fwrite(bytes, 1, size, stdout) != size) throw std::runtime_error("cannot write to the pipe");
}

template <class T>
void write(const std::vector<T>& list)
{
  write(list.data(), list.size() * sizeof(T));
}

void write(const SceneTriangles& scene)
{
  MeshStreamHeader header = {};
  std::memcpy(header.magic, kMeshStreamMagic, sizeof(header.magic));
  header.vertices = scene.vertices.size();
  header.triangles = scene.triangles.size();
  header.textures = scene.textures.size();
  header.warning_bytes = scene.warnings.size();
  header.is_metric = scene.is_metric ? 1 : 0;
  write(&header, sizeof(header));
  write(scene.vertices);
  write(scene.normals);
  write(scene.texture_coordinates);
  write(scene.colors);
  write(scene.triangles);
  write(scene.triangle_textures);
  for (const cv::Mat& texture : scene.textures)
  {
    const std::uint32_t size[2] = {static_cast<std::uint32_t>(texture.cols), static_cast<std::uint32_t>(texture.rows)};
    write(size, sizeof(size));
    write(texture.data, texture.total() * texture.elemSize());
  }
  write(scene.warnings.data(), scene.warnings.size());
  if (std::fflush(stdout) != 0) throw std::runtime_error("cannot write to the pipe");
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc != 2)
  {
    std::fprintf(stderr, "read_mesh is started by robot_vision to read a mesh, with the path of one\n");
    return 2;
  }
  std::set_new_handler(endOutOfMemory);
  limitWork();
  Assimp::Importer importer;
  write(trianglesOf(import(argv[1], importer), argv[1]));
  _exit(0);  // not even what tidies up can fail now
}
catch (const std::bad_alloc&)
{
  return kMeshOutOfMemory;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "%s\n", e.what());
  return kMeshRefused;
}
