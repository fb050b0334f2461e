#pragma once

#include <opencv2/videoio.hpp>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// A video file or a stream's URL, decoded by FFmpeg through OpenCV.
class VideoSource : public FrameSource
{
public:
  explicit VideoSource(const std::string& path);
  ReadResult read(Frame& frame) override;
  void rewind() override;
  double rate() const override { return live_ ? 0.0 : rate_; }
  std::string description() const override;

private:
  void open();
  ReadResult finish() const;

  std::string path_;
  bool url_;
  bool live_;  // has no length: the sender keeps the pace
  double rate_;
  std::int64_t expected_ = 0;  // frames that the container promises; 0: unknown
  std::int64_t played_ = 0;    // frames since the beginning of the video
  double end_s_ = 0.0;         // time in the video at which the last frame ends
  std::int64_t sequence_ = 0;
  cv::VideoCapture capture_;
  bool grabbed_ = false;  // the first frame: FFmpeg opens much that it cannot decode
};

}  // namespace robot_vision
