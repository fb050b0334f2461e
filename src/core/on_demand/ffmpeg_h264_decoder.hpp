#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "core/camera/video_decoders.hpp"

namespace robot_vision
{

/// Decodes with FFmpeg's libavcodec.
class FfmpegH264Decoder : public H264Decoder
{
public:
  FfmpegH264Decoder();
  ~FfmpegH264Decoder() override;
  void restart() override;
  bool decode(const cv::Mat& bytes, cv::Mat& yu12) override;

private:
  struct Context;
  void send(const cv::Mat& bytes);
  bool receive(cv::Mat& yu12);

  std::unique_ptr<Context> context_;
  bool waiting_for_keyframe_ = true;
};

}  // namespace robot_vision
