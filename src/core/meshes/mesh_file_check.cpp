#include "mesh_file_check.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "core/common/starts_with.hpp"
#include "mesh_stream.hpp"

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFileSize = std::uintmax_t{1} << 30;  // bytes
constexpr std::size_t kHeadSize = 65536;                          // bytes, in which PLY says what there is
constexpr std::size_t kStlHeader = 80, kStlTriangle = 50;         // bytes

/// How many triangles a binary STL file has, which is known by its size; 0 of any other file.
std::uint64_t stlTriangles(const std::string& head, std::uintmax_t size)
{
  std::uint32_t count = 0;
  if (head.size() < kStlHeader + sizeof(count)) return 0;
  std::memcpy(&count, head.data() + kStlHeader, sizeof(count));  // little-endian, as all of our machines
  if (size != kStlHeader + sizeof(count) + std::uintmax_t{count} * kStlTriangle) return 0;
  return count;
}

/// How many faces a PLY file says that it has; 0 of any other file.
std::uint64_t plyTriangles(const std::string& head)
{
  if (!startsWith(head, "ply")) return 0;
  const std::size_t end = head.find("end_header");
  // assimp would look for it until its time is over.
  if (end == std::string::npos) throw std::invalid_argument("its header has no end_header");
  std::istringstream lines(head.substr(0, end));
  const std::string element = "element face ";
  for (std::string line; std::getline(lines, line);)
    if (startsWith(line, element)) return std::strtoull(line.c_str() + element.size(), nullptr, 10);
  return 0;
}

}  // namespace

void checkMeshFile(const std::string& path)
{
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw std::runtime_error("cannot be read: " + (error ? error.message() : "there is no such file"));
  if (!fs::is_regular_file(status)) throw std::runtime_error("cannot be read: it is no file");
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  std::string head(kHeadSize, '\0');
  file.read(&head[0], static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  if (error || file.bad() || !file.is_open()) throw std::runtime_error("cannot be read: Permission denied");
  if (head.empty()) throw std::invalid_argument("it is empty");
  std::uint64_t count = stlTriangles(head, size);
  if (count == 0) count = plyTriangles(head);
  if (count > kMaxMeshTriangles)
    throw std::invalid_argument("it has " + std::to_string(count) + " triangles, must have at most " +
                                std::to_string(kMaxMeshTriangles));
  if (size > kMaxFileSize)
    throw std::invalid_argument("it has " + std::to_string(size >> 20) + " MB, must have at most " +
                                std::to_string(kMaxFileSize >> 20));
}

}  // namespace robot_vision
