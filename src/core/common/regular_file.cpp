#include "robot_vision/common/regular_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
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

class OpenFile
{
public:
  explicit OpenFile(const std::string& path) : path_(path)
  {
    if (stat(path.c_str(), &status_) != 0) fail(path);
    if (!S_ISREG(status_.st_mode)) refuse();  // checked before open(), because opening some devices has side effects
    // The path may lead to another file by now. O_NONBLOCK keeps open() from waiting for the other end of a pipe.
    file_ = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file_ == -1) fail(path);
    if (fstat(file_, &status_) == 0 && S_ISREG(status_.st_mode)) return;
    close(file_);
    refuse();
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(file_); }

  std::size_t size() const { return static_cast<std::size_t>(status_.st_size); }

  /// Reads the next bytes into `chunk` and returns how many they are, 0 at the end of the file.
  std::size_t read(std::vector<char>& chunk) const
  {
    const ssize_t count = ::read(file_, chunk.data(), chunk.size());
    if (count < 0) fail(path_);
    return static_cast<std::size_t>(count);
  }

private:
  [[noreturn]] void refuse() const { throw std::runtime_error(path_ + " cannot be read: it is no file"); }

  std::string path_;
  struct stat status_ = {};
  int file_ = -1;
};

}  // namespace

std::string readFile(const std::string& path, std::size_t max_size)
{
  const OpenFile file(path);
  std::string bytes;
  std::vector<char> chunk(kChunk);
  bool complete = false;
  while (!complete && std::max(file.size(), bytes.size()) <= max_size)
  {
    const std::size_t count = file.read(chunk);
    bytes.append(chunk.data(), count);
    complete = count == 0;
  }
  if (complete) return bytes;
  throw std::runtime_error(path + " cannot be read: it has " +
                           std::to_string(std::max(file.size(), bytes.size()) >> 20) + " MB, must have at most " +
                           std::to_string(max_size >> 20));
}

}  // namespace robot_vision
