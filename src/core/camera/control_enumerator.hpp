#pragma once

#include <linux/videodev2.h>

#include <cstdint>

#include "v4l2_device.hpp"

namespace robot_vision
{

/// Enumerates the controls of a device in the order of their ids, including the headings of classes. Controls that the
/// driver fails to describe, which some webcams have, are skipped.
class ControlEnumerator
{
public:
  explicit ControlEnumerator(V4l2Device& device) : device_(device) {}

  /// Fills `query` with the next control; returns false after the last one. Throws SourceUnavailable if the device is
  /// gone.
  bool next(v4l2_query_ext_ctrl& query);

private:
  int ask(std::uint32_t id, v4l2_query_ext_ctrl& query);
  int findUndescribed(v4l2_query_ext_ctrl& query);

  V4l2Device& device_;
  std::uint32_t id_ = 0;  // of the last control
  int failures_ = 0;
};

}  // namespace robot_vision
