#pragma once

#include <linux/videodev2.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace robot_vision
{

/// To a question with an index that counts up: so that no driver keeps us for ever.
constexpr std::uint32_t kMaxAnswers = 1000;

/// An open Video4Linux2 device. Failed calls throw SourceUnavailable naming the device, the call and the system's
/// reason. An interface, so that tests can plug in cameras that machines do not have.
class V4l2Device
{
public:
  explicit V4l2Device(const std::string& path) : path_(path) {}
  virtual ~V4l2Device() = default;
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  const std::string& path() const { return path_; }

  /// ioctl(), repeated when a signal comes; 0, or the errno that it failed with.
  virtual int tryCall(unsigned long request, void* argument) = 0;

  /// False if there is nothing to read within the time.
  virtual bool waitReadable(int milliseconds) = 0;

  /// Memory of the driver, to be given back with unmap().
  virtual void* map(std::size_t length, std::uint32_t offset) = 0;
  virtual void unmap(void* start, std::size_t length) = 0;

  /// As tryCall(), but throws; `name` is for the error.
  void call(unsigned long request, void* argument, const char* name);

  [[noreturn]] void fail(const std::string& what, int error) const;

private:
  std::string path_;
};

/// What a device is; `capabilities` are those of this node, not of all nodes of the device together.
v4l2_capability queryCapability(V4l2Device& device);

/// Opens a device file.
std::unique_ptr<V4l2Device> openV4l2Device(const std::string& path);

}  // namespace robot_vision
