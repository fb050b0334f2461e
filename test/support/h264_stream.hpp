#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

struct H264Stream
{
  int keyframe_every = 10;
  bool full_range = false;
  bool chroma_422 = false;  // 4:2:2, which cameras do not give

  /// Compresses images of encoding yu12 as a camera does, to one packet each. Empty if this FFmpeg has no libx264.
  std::vector<cv::Mat> encode(const std::vector<cv::Mat>& images) const;
};

}  // namespace robot_vision
