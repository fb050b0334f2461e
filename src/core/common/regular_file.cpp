#include "robot_vision/common/regular_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace robot_vision
{
namespace
{

constexpr std::size_t kChunk = std::size_t{1} << 20;  // bytes read at a time

[[noreturn]] void fail(const std::string& path)
{
  throw std::system_error(errno, std::generic_category(), path + " cannot be read");
}

void requireRegular(const std::string& path, const struct stat& status)
{
  if (!S_ISREG(status.st_mode)) throw std::runtime_error(path + " cannot be read: it is no file");
}

struct Descriptor
{
  ~Descriptor() { close(file); }

  const int file;
};

}  // namespace

std::string readFile(const std::string& path, std::size_t max_size)
{
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0) fail(path);
  requireRegular(path, status);  // before open(), because opening some devices has side effects
  // The path may lead to another file by now. O_NONBLOCK keeps open() from waiting for the other end of a pipe.
  const Descriptor opened{open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  if (opened.file == -1 || fstat(opened.file, &status) != 0) fail(path);
  requireRegular(path, status);
  std::string bytes;
  std::vector<char> chunk(kChunk);
  auto size = static_cast<std::size_t>(status.st_size);
  while (size <= max_size)
  {
    const ssize_t count = read(opened.file, chunk.data(), chunk.size());
    if (count < 0) fail(path);
    if (count == 0) return bytes;
    bytes.append(chunk.data(), static_cast<std::size_t>(count));
    size = std::max(size, bytes.size());
  }
  throw std::runtime_error(path + " cannot be read: it has " + std::to_string(size >> 20) + " MB, must have at most " +
                           std::to_string(max_size >> 20));
}

}  // namespace robot_vision
