#include "v4l2_cameras.hpp"

#include <linux/videodev2.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>

#include "core/common/starts_with.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

constexpr int kMatchLevels = 3;  // of how well a name matches a camera

std::string readLine(const fs::path& path)
{
  std::string line;
  std::ifstream file(path);
  std::getline(file, line);
  return shortened(line.substr(0, line.find_last_not_of(" \t\r") + 1));  // a device may have chosen it
}

std::vector<fs::path> entriesOf(const fs::path& folder)
{
  std::error_code error;  // a missing folder has no entries
  std::vector<fs::path> entries;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    entries.push_back(entry->path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// The number N of a file videoN; -1 for other files.
int numberOf(const fs::path& path)
{
  const std::string name = path.filename().string();
  const bool numbered = name.size() > 5 && name.size() < 12 && startsWith(name, "video") &&
                        std::all_of(name.begin() + 5, name.end(), [](unsigned char c) { return std::isdigit(c); });
  return numbered ? std::stoi(name.substr(5)) : -1;
}

std::vector<fs::path> videoNodes(const V4l2System& system)
{
  std::vector<fs::path> nodes = entriesOf(system.devices);
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(), [](const fs::path& path) { return numberOf(path) < 0; }),
              nodes.end());
  std::sort(nodes.begin(), nodes.end(), [](const fs::path& a, const fs::path& b) { return numberOf(a) < numberOf(b); });
  return nodes;
}

/// The serial number of the USB device to which the camera belongs. The search ends there, because the host controller
/// above it has a serial number, too.
std::string serialOf(const fs::path& device)
{
  std::error_code error;
  for (fs::path folder = fs::canonical(device, error); !error && folder.has_relative_path();
       folder = folder.parent_path())
    if (fs::exists(folder / "idVendor", error)) return readLine(folder / "serial");
  return {};
}

/// Adds the symbolic links in a folder, which udev's rules may place anywhere in /dev. The kernel's names in /dev/char
/// tell nothing, and /dev/shm may hold anything.
void addLinks(const fs::path& folder, int depth, std::vector<fs::path>& links)
{
  std::error_code error;
  for (const fs::path& entry : entriesOf(folder))
  {
    const fs::file_type type = fs::symlink_status(entry, error).type();
    if (type == fs::file_type::symlink) links.push_back(entry);
    const bool ignored = entry.filename() == "char" || entry.filename() == "shm";
    if (type == fs::file_type::directory && depth > 0 && !ignored) addLinks(entry, depth - 1, links);
  }
}

std::vector<fs::path> linksBelow(const fs::path& folder)
{
  constexpr int kMaxFolderDepth = 2;  // folders, such as v4l/by-id
  std::vector<fs::path> links;
  addLinks(folder, kMaxFolderDepth, links);
  return links;
}

std::vector<std::string> linksTo(const fs::path& node, const std::vector<fs::path>& links)
{
  std::vector<std::string> found;
  for (const fs::path& link : links)
    if (isSameFile(link.string(), node.string())) found.push_back(link.string());
  return found;
}

/// Describes the camera of a device file; empty if the device does not capture images.
std::optional<V4l2Camera> cameraAt(const fs::path& node, const std::vector<fs::path>& links, const V4l2System& system)
{
  const fs::path class_entry = fs::path(system.classes) / node.filename();
  V4l2Camera camera;
  camera.path = node.string();
  camera.card = readLine(class_entry / "name");
  camera.serial = serialOf(class_entry / "device");
  camera.links = linksTo(node, links);
  try
  {
    const v4l2_capability capability = queryCapability(*system.open(camera.path));
    if ((capability.capabilities & V4L2_CAP_VIDEO_CAPTURE) == 0) return std::nullopt;
    camera.card = textOf(capability.card);
    camera.driver = textOf(capability.driver);
    camera.bus = textOf(capability.bus_info);
  }
  catch (const SourceUnavailable& e)
  {
    camera.problem = e.what();
  }
  return camera;
}

std::string lowered(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// How well a name matches a camera: 0 is best, kMatchLevels means not at all.
int matchLevel(const V4l2Camera& camera, const std::string& name)
{
  const auto is_link = [&name](const std::string& link) { return fs::path(link).filename() == name; };
  if (name == camera.serial || name == camera.bus || std::any_of(camera.links.begin(), camera.links.end(), is_link))
    return 0;
  if (lowered(camera.card) == lowered(name)) return 1;
  return lowered(camera.card).find(lowered(name)) != std::string::npos ? 2 : kMatchLevels;
}

std::string describeAll(const std::vector<V4l2Camera>& cameras)
{
  std::vector<std::string> all;
  for (const V4l2Camera& camera : cameras)
    all.push_back(describe(camera));
  return joined(all);
}

}  // namespace

bool isSameFile(const std::string& a, const std::string& b)
{
  struct stat first;
  struct stat second;
  return stat(a.c_str(), &first) == 0 && stat(b.c_str(), &second) == 0 && first.st_dev == second.st_dev &&
         first.st_ino == second.st_ino;
}

std::vector<V4l2Camera> listV4l2Cameras(const V4l2System& system)
{
  std::vector<V4l2Camera> cameras;
  const std::vector<fs::path> links = linksBelow(system.devices);
  for (const fs::path& node : videoNodes(system))
    if (const std::optional<V4l2Camera> camera = cameraAt(node, links, system)) cameras.push_back(*camera);
  return cameras;
}

FoundCamera findV4l2Camera(const std::string& name, const V4l2System& system)
{
  if (name.find('/') == 0) return {name, ""};
  const std::vector<V4l2Camera> cameras = listV4l2Cameras(system);
  std::vector<V4l2Camera> matching;
  for (int level = 0; level < kMatchLevels && matching.empty(); ++level)
    std::copy_if(cameras.begin(), cameras.end(), std::back_inserter(matching),
                 [&](const V4l2Camera& camera) { return matchLevel(camera, name) == level; });
  if (matching.empty())
    throw SourceUnavailable("'" + name + "' is no camera; there is " +
                            (cameras.empty() ? "none at all" : describeAll(cameras)));
  if (matching.size() == 1) return {matching.front().path, ""};
  return {matching.front().path, "'" + name + "' is the name of " + describeAll(matching) + "; the first is taken"};
}

std::string describe(const V4l2Camera& camera)
{
  std::string text = camera.path + " (" + camera.card;
  if (!camera.bus.empty()) text += ", " + camera.bus;
  if (!camera.serial.empty()) text += ", serial " + camera.serial;
  return text + (camera.problem.empty() ? ")" : "; " + camera.problem + ")");
}

}  // namespace robot_vision
