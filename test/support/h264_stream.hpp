#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

struct H264Stream
{
  int keyframe_every = 10;
  bool full_range = false;
  bool half_chroma_only_across = false;  // 4:2:2, which cameras do not give

  /// Compresses pictures of encoding yu12, as a camera does: one packet for each. Empty if FFmpeg has no libx264 here.
  std::vector<cv::Mat> encode(const std::vector<cv::Mat>& pictures) const;
};

}  // namespace robot_vision
