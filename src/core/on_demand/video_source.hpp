#pragma once

#include <memory>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>

#include "core/camera/live_frames.hpp"
#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// Reads a video file or a stream's URL with FFmpeg through OpenCV. Of a file it gives each frame, of a live stream the
/// next one that arrives.
class VideoSource : public FrameSource
{
public:
  /// As openVideo().
  VideoSource(const std::string& path, double timeout);
  ReadResult read(Frame& frame) override;
  void rewind() override;
  double rate() const override { return live_ ? 0.0 : rate_; }
  std::string description() const override;

private:
  void open();
  bool grab() { return std::exchange(grabbed_, false) || capture_.grab(); }
  ReadResult readLive(Frame& frame);
  ReadResult endOrThrow() const;

  std::string path_;
  std::string shown_;  // without a login
  bool url_;
  double timeout_;  // s
  bool live_;       // a stream without a length, whose sender determines the rate
  double rate_;
  std::int64_t expected_ = 0;  // number of frames that the container states; 0 if unknown
  std::int64_t played_ = 0;    // frames since the beginning of the video
  double end_s_ = 0.0;         // time in the video at which the last frame ends
  std::int64_t sequence_ = 0;
  cv::VideoCapture capture_;
  bool grabbed_ = false;  // the first frame is grabbed on opening, because FFmpeg opens files that it cannot decode
  std::unique_ptr<LiveFrames> frames_;  // of a live stream
};

}  // namespace robot_vision
