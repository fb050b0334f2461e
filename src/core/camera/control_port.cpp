#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_cameras.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

ControlPort::ControlPort(const CaptureParams& params)
  : ControlPort([name = sourceName(params)] { return openV4l2Device(findV4l2Camera(name).path); })
{
}

std::shared_ptr<V4l2Device> ControlPort::device() const
{
  const std::shared_ptr<V4l2Device> streaming = streaming_.lock();
  return streaming ? streaming : open_();
}

}  // namespace robot_vision
