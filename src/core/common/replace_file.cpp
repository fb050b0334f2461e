#include "robot_vision/common/replace_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace robot_vision
{
namespace
{

using Status = struct stat;

[[noreturn]] void fail(const std::string& path, int error)
{
  throw std::system_error(error, std::generic_category(), path + " cannot be written");
}

[[noreturn]] void refuse(const std::string& path, const std::string& reason)
{
  throw std::runtime_error(path + " cannot be written: " + reason);
}

/// The status of the file at the end of all symbolic links, or nothing if there is none yet.
std::optional<Status> statusOf(const std::string& path)
{
  Status status;
  if (stat(path.c_str(), &status) == 0)
  {
    if (!S_ISREG(status.st_mode)) refuse(path, "it is no file");
    return status;
  }
  if (errno != ENOENT) fail(path, errno);
  if (lstat(path.c_str(), &status) == 0) refuse(path, "it is a symbolic link that leads nowhere");
  return std::nullopt;
}

/// A part of a file name that no other file has. A process id would not do: an earlier process with the same id may
/// have left a file.
std::string randomName()
{
  std::random_device random;
  std::ostringstream name;
  name << std::hex << random() << random();
  return name.str();
}

/// Gives a file the mode and, as far as the process may, the owner of the old one: only root may give files to others.
bool copyOwnership(int file, const Status& old)
{
  Status status;
  if (fstat(file, &status) != 0) return false;
  if ((status.st_uid != old.st_uid || status.st_gid != old.st_gid) && fchown(file, old.st_uid, old.st_gid) != 0 &&
      fchown(file, static_cast<uid_t>(-1), old.st_gid) != 0 && errno != EPERM)
    return false;
  return fchmod(file, old.st_mode & 07777) == 0;
}

bool writeAll(int file, const std::string& text)
{
  for (std::size_t done = 0; done < text.size();)
  {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count < 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

void replaceFile(const std::string& link, const std::string& text)
{
  const std::optional<Status> old = statusOf(link);
  std::error_code error_of_path;
  // Without symbolic links, so that the file is replaced and not a link to it.
  const std::string path = old ? std::filesystem::canonical(link, error_of_path).string() : link;
  if (error_of_path) fail(link, error_of_path.value());
  // The temporary file is in the same folder, because a rename is atomic only within a file system.
  const std::string temporary = path + "." + randomName() + ".tmp";
  // A file that replaces another is private until it has the other's mode.
  const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, old ? 0600 : 0666);
  if (file == -1) fail(path, errno);
  const bool written = (!old || copyOwnership(file, *old)) && writeAll(file, text) && fsync(file) == 0;
  int error = errno;
  close(file);
  if (written && rename(temporary.c_str(), path.c_str()) == 0) return;
  if (written) error = errno;
  unlink(temporary.c_str());
  fail(path, error);
}

}  // namespace robot_vision
