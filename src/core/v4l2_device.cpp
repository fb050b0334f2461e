#include "v4l2_device.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "robot_vision/frame_source.hpp"

namespace robot_vision
{

V4l2Device::V4l2Device(const std::string& path) : path_(path), fd_(open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC))
{
  if (fd_ == -1) throw SourceUnavailable(path_ + ": cannot be opened: " + std::strerror(errno));
}

V4l2Device::~V4l2Device()
{
  close(fd_);
}

void V4l2Device::fail(const std::string& what, int error) const
{
  throw SourceUnavailable(path_ + ": " + what + " failed: " + std::strerror(error));
}

int V4l2Device::tryCall(unsigned long request, void* argument)
{
  int result;
  do
    result = ioctl(fd_, request, argument);
  while (result == -1 && errno == EINTR);
  return result == -1 ? errno : 0;
}

void V4l2Device::call(unsigned long request, void* argument, const char* name)
{
  const int error = tryCall(request, argument);
  if (error != 0) fail(name, error);
}

bool V4l2Device::waitReadable(int milliseconds)
{
  pollfd waiting = {fd_, POLLIN, 0};
  const int ready = poll(&waiting, 1, milliseconds);
  if (ready == -1 && errno != EINTR) fail("poll", errno);
  return ready > 0;
}

void* V4l2Device::map(std::size_t length, std::uint32_t offset)
{
  void* start = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, offset);
  if (start == MAP_FAILED) fail("mmap", errno);
  return start;
}

}  // namespace robot_vision
