#include "device_access.hpp"

#include <dirent.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>
#include <vector>

namespace robot_vision
{
namespace
{

std::string groupName(gid_t gid)
{
  group entry{};
  group* found = nullptr;
  std::vector<char> memory(16384);
  getgrgid_r(gid, &entry, memory.data(), memory.size(), &found);
  return found == nullptr ? std::to_string(gid) : entry.gr_name;
}

std::string permissionAdvice(const std::string& path)
{
  struct stat info;
  if (stat(path.c_str(), &info) != 0) return "";
  std::array<char, 8> mode{};
  std::snprintf(mode.data(), mode.size(), "%04o", info.st_mode & 07777);
  const std::string group = groupName(info.st_gid);
  std::string text = "; its group is " + group + ", its mode " + mode.data() + ": ";
  if ((info.st_mode & 0060) == 0060) text += "join with `sudo usermod -aG " + group + " $USER` and log in again, or ";
  return text + "write the udev rule SUBSYSTEM==\"video4linux\", GROUP=\"video\", MODE=\"0660\"";
}

/// The names in a folder that are numbers: the processes in /proc, or the file descriptors of one process.
std::vector<std::string> numbersIn(const std::string& folder)
{
  std::vector<std::string> names;
  const std::unique_ptr<DIR, int (*)(DIR*)> open(opendir(folder.c_str()), closedir);
  while (const dirent* entry = open ? readdir(open.get()) : nullptr)
    if (entry->d_name[0] >= '0' && entry->d_name[0] <= '9') names.emplace_back(entry->d_name);
  return names;
}

/// Only the text of the descriptors' links is read: what follows them waits for the network if a file is there.
bool hasOpen(const std::string& process, const std::filesystem::path& device)
{
  const std::string descriptors = "/proc/" + process + "/fd/";
  const std::vector<std::string> numbers = numbersIn(descriptors);
  const auto is_device = [&](const std::string& number)
  {
    std::error_code unknown;
    return std::filesystem::read_symlink(descriptors + number, unknown) == device;
  };
  return std::any_of(numbers.begin(), numbers.end(), is_device);
}

/// Names the other processes that have the file open, as far as this user may see their descriptors.
std::string busyAdvice(const std::string& path)
{
  std::error_code missing;
  const std::filesystem::path device = std::filesystem::canonical(path, missing);
  if (missing) return "";
  const std::string self = std::to_string(getpid());
  std::string holders;
  for (const std::string& process : numbersIn("/proc"))
  {
    if (process == self || !hasOpen(process, device)) continue;
    std::string name;
    std::getline(std::ifstream("/proc/" + process + "/comm"), name);
    holders += (holders.empty() ? "" : ", ") + name + " (process " + process + ")";
  }
  return holders.empty() ? "; `sudo fuser -v " + path + "` tells who holds it" : "; it is open in " + holders;
}

}  // namespace

std::string accessAdvice(const std::string& path, int error)
{
  if (error == EACCES || error == EPERM) return permissionAdvice(path);
  if (error == EBUSY) return busyAdvice(path);
  return "";
}

}  // namespace robot_vision
