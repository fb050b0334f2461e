#pragma once

#include <linux/videodev2.h>

#include <vector>

#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// Reads and writes the value of one control.
class ControlIo
{
public:
  explicit ControlIo(const v4l2_query_ext_ctrl& query);
  ControlIo(const ControlIo&) = delete;
  ControlIo& operator=(const ControlIo&) = delete;

  /// Both return 0 or the errno of the failed call. The value has the driver's type, see control_values.hpp.
  int get(V4l2Device& device, ControlValue& value);
  int set(V4l2Device& device, const ControlValue& value);

private:
  int run(V4l2Device& device, unsigned long request);
  void put(const ControlValue& value);
  ControlValue value() const;

  std::uint32_t type_;
  std::vector<char> text_;  // the memory to which control_ points
  v4l2_ext_control control_{};
};

}  // namespace robot_vision
