#pragma once

namespace robot_vision
{

/// Copies what a message says of an image, all but the pixels and where they are: between sensor_msgs/Image and
/// robot_vision/ShmImage, in either direction.
template <class From, class To>
void copyDescription(const From& from, To& to)
{
  to.header = from.header;
  to.height = from.height;
  to.width = from.width;
  to.encoding = from.encoding;
  to.is_bigendian = from.is_bigendian;
  to.step = from.step;
}

}  // namespace robot_vision
