#include "v4l2_device.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "device_access.hpp"
#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{
namespace
{

class DeviceFile : public V4l2Device
{
public:
  explicit DeviceFile(const std::string& path)
    : V4l2Device(path), fd_(open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC))
  {
    const int error = errno;
    if (fd_ == -1)
      throw SourceUnavailable(path + ": cannot be opened: " + std::strerror(error) + accessAdvice(path, error));
  }

  ~DeviceFile() override { close(fd_); }

  int tryCall(unsigned long request, void* argument) override
  {
    int result;
    do
      result = ioctl(fd_, request, argument);
    while (result == -1 && errno == EINTR);
    return result == -1 ? errno : 0;
  }

  bool waitReadable(int milliseconds) override
  {
    pollfd waiting = {fd_, POLLIN, 0};
    const int ready = poll(&waiting, 1, milliseconds);
    if (ready == -1 && errno != EINTR) fail("poll", errno);
    return ready > 0;
  }

  void* map(std::size_t length, std::uint32_t offset) override
  {
    void* start = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, offset);
    if (start == MAP_FAILED) fail("mmap", errno);
    return start;
  }

  void unmap(void* start, std::size_t length) override { munmap(start, length); }

private:
  int fd_;
};

}  // namespace

void V4l2Device::call(unsigned long request, void* argument, const char* name)
{
  const int error = tryCall(request, argument);
  if (error != 0) fail(name, error);
}

void V4l2Device::fail(const std::string& what, int error) const
{
  throw SourceUnavailable(path_ + ": " + what + " failed: " + std::strerror(error) + accessAdvice(path_, error));
}

v4l2_capability queryCapability(V4l2Device& device)
{
  v4l2_capability capability{};
  device.call(VIDIOC_QUERYCAP, &capability, "VIDIOC_QUERYCAP");
  if ((capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0) capability.capabilities = capability.device_caps;
  return capability;
}

std::unique_ptr<V4l2Device> openV4l2Device(const std::string& path)
{
  return std::make_unique<DeviceFile>(path);
}

}  // namespace robot_vision
