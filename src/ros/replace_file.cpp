#include "replace_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

namespace robot_vision
{
namespace
{

[[noreturn]] void fail(const std::string& path, int error)
{
  throw std::system_error(error, std::generic_category(), path + " cannot be written");
}

/// Where a symbolic link leads to, so that the file is replaced and not the link.
std::string target(const std::string& path)
{
  char* resolved = realpath(path.c_str(), nullptr);
  const std::string real = resolved == nullptr ? path : resolved;
  std::free(resolved);
  return real;
}

}  // namespace

void replaceFile(const std::string& link, const std::string& text)
{
  const std::string path = target(link);
  // In the same folder, or the rename could not be atomic.
  const std::string temporary = path + "." + std::to_string(getpid()) + ".tmp";
  const int fd = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd == -1) fail(path, errno);
  struct stat old;
  const bool keep_mode = stat(path.c_str(), &old) == 0;
  const bool written = write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       (!keep_mode || fchmod(fd, old.st_mode & 07777) == 0) && fsync(fd) == 0;
  int error = errno;
  close(fd);
  if (written && rename(temporary.c_str(), path.c_str()) == 0) return;
  if (written) error = errno;
  unlink(temporary.c_str());
  fail(path, error);
}

}  // namespace robot_vision
