#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace robot_vision
{

/// An open device file. Failed calls throw SourceUnavailable naming the device, the call and the system's reason.
class V4l2Device
{
public:
  explicit V4l2Device(const std::string& path);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  const std::string& path() const { return path_; }

  /// ioctl() that is repeated when a signal comes; `name` is for the error.
  void call(unsigned long request, void* argument, const char* name);
  /// The same; 0, or the errno that it failed with.
  int tryCall(unsigned long request, void* argument);

  /// False if there is nothing to read within the time.
  bool waitReadable(int milliseconds);

  /// Memory of the driver, to be given back with munmap().
  void* map(std::size_t length, std::uint32_t offset);

  [[noreturn]] void fail(const std::string& what, int error) const;

private:
  std::string path_;
  int fd_;
};

}  // namespace robot_vision
