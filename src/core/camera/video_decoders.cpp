#include "video_decoders.hpp"

#include "robot_vision/common/on_demand.hpp"

namespace robot_vision
{

std::unique_ptr<H264Decoder> makeH264Decoder()
{
  static auto* const make =
      onDemand<decltype(robot_vision_make_h264_decoder)>("codecs", "robot_vision_make_h264_decoder");
  return std::unique_ptr<H264Decoder>(make());
}

std::unique_ptr<FrameSource> openVideo(const std::string& path, double timeout)
{
  static auto* const open = onDemand<decltype(robot_vision_open_video)>("codecs", "robot_vision_open_video");
  return std::unique_ptr<FrameSource>(open(path, timeout));
}

}  // namespace robot_vision
