#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_cameras.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

ControlDevice::ControlDevice(const CaptureParams& params)
  : ControlDevice([name = sourceName(params)] { return openV4l2Device(findV4l2Camera(name).path); })
{
}

std::shared_ptr<V4l2Device> ControlDevice::device() const
{
  const std::shared_ptr<V4l2Device> streaming = streaming_.lock();
  return streaming ? streaming : open_();
}

}  // namespace robot_vision
