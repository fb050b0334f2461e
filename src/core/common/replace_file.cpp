#include "replace_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
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

/// The status of what is replaced, where symbolic links lead to; empty: there is none.
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

/// Where a symbolic link leads to, so that the file is replaced and not the link.
std::string target(const std::string& path)
{
  char* resolved = realpath(path.c_str(), nullptr);
  if (resolved == nullptr) fail(path, errno);
  const std::string real = resolved;
  std::free(resolved);
  return real;
}

/// Part of a name that no file has; a number of the process may be in one that it left.
std::string randomName()
{
  std::random_device random;
  std::ostringstream name;
  name << std::hex << random() << random();
  return name.str();
}

/// Gives a file mode and owner of another; only root may give files to others.
bool takeOver(int file, const Status& old)
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
  const std::string path = old ? target(link) : link;
  // In the same folder, or the rename could not be atomic.
  const std::string temporary = path + "." + randomName() + ".tmp";
  // What is private stays so from the beginning.
  const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, old ? 0600 : 0666);
  if (file == -1) fail(path, errno);
  const bool written = (!old || takeOver(file, *old)) && writeAll(file, text) && fsync(file) == 0;
  int error = errno;
  close(file);
  if (written && rename(temporary.c_str(), path.c_str()) == 0) return;
  if (written) error = errno;
  unlink(temporary.c_str());
  fail(path, error);
}

}  // namespace robot_vision
