#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "robot_vision/common/printable.hpp"

namespace robot_vision
{

/// The largest number of answers to an enumerating ioctl, so that no faulty driver makes a loop endless.
constexpr std::uint32_t kMaxEntries = 1000;

/// An open Video4Linux2 device. Failed calls throw SourceUnavailable that names the device, the call and the system's
/// error text. This is an interface so that tests can use cameras that the machine does not have.
class V4l2Device
{
public:
  explicit V4l2Device(const std::string& path) : path_(path) {}
  virtual ~V4l2Device() = default;
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  const std::string& path() const { return path_; }

  /// Calls ioctl(), again if a signal interrupts it. Returns 0 or the errno of the failed call.
  virtual int tryCall(unsigned long request, void* argument) = 0;

  /// Waits for data; returns false if there is nothing to read within the time.
  virtual bool waitReadable(int milliseconds) = 0;

  /// Maps memory of the driver, which unmap() releases.
  virtual void* map(std::size_t length, std::uint32_t offset) = 0;
  virtual void unmap(void* start, std::size_t length) = 0;

  /// Like tryCall(), but throws if the call fails; `name` is the call's name for the error message.
  void call(unsigned long request, void* argument, const char* name);

  [[noreturn]] void fail(const std::string& what, int error) const;

private:
  std::string path_;
};

/// Describes a device. `capabilities` are those of this device file, not of all files of the device together.
v4l2_capability queryCapability(V4l2Device& device);

/// The text in a field of a driver's answer, which a USB device may have chosen, as shortened() makes it; a text that
/// fills its field has no zero at its end.
template <class Character, std::size_t size>
std::string textOf(const Character (&field)[size])
{
  const auto* begin = reinterpret_cast<const char*>(field);
  return shortened({begin, std::find(begin, begin + size, '\0')});
}

std::unique_ptr<V4l2Device> openV4l2Device(const std::string& path);

}  // namespace robot_vision
