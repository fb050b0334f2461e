#include "usb_cam_params.hpp"

#include "ros/params/unknown_params.hpp"

namespace robot_vision
{
namespace
{

struct UsbCamParam
{
  const char* name;
  const char* explanation;
};

constexpr UsbCamParam kWithoutEffect[] = {
    {"camera_transport_suffix", "the image is on ~image_raw, which can be remapped"},
    {"color_format", "the stream itself says how its colors are coded"},
    {"full_ffmpeg_log", "a frame that cannot be decoded is an error in the log"},
    {"hardware_decoder", "frames are decoded on the processor"},
    {"start_service_name", "the service is ~start_capture, which can be remapped"},
    {"stop_service_name", "the service is ~stop_capture, which can be remapped"},
};

}  // namespace

void acceptUsbCamParams(const ros::NodeHandle& pnh)
{
  for (const auto& [name, explanation] : kWithoutEffect)
  {
    noteKnownParam(pnh, name);
    if (pnh.hasParam(name)) ROS_INFO("%s has no effect: %s", pnh.resolveName(name).c_str(), explanation);
  }
}

}  // namespace robot_vision
