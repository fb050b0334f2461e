#include "package_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

std::string contents(const fs::path& path)
{
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// True for a file of any copy of this package, in its sources or installed.
bool isOfThisPackage(const fs::path& path)
{
  for (fs::path folder = path.parent_path(); folder.has_relative_path(); folder = folder.parent_path())
  {
    const fs::path manifest = folder / "package.xml";
    std::error_code ignored;
    if (fs::is_regular_file(manifest, ignored))
      return contents(manifest).find("<name>robot_vision</name>") != std::string::npos;
  }
  return false;
}

}  // namespace

bool isStartedByRoslaunch()
{
  static const bool is_started = contents("/proc/self/cmdline").find(std::string("\0__log:=", 8)) != std::string::npos;
  return is_started;
}

void requireOwnLaunch(const std::string& path, bool is_started_by_roslaunch)
{
  std::error_code ignored;
  if (is_started_by_roslaunch || !isOfThisPackage(fs::weakly_canonical(path, ignored))) return;
  throw std::runtime_error("~config_file is '" + path +
                           "', a file of the package, to which only what roslaunch starts saves; name another one: "
                           "_config_file:=/absolute/path.yaml");
}

}  // namespace robot_vision
