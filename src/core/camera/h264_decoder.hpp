#pragma once

#include <memory>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Decodes an H.264 stream (ITU-T H.264, annex B) frame by frame, without the delay of decoders that wait for more
/// frames. At the start and after a damaged frame, images begin with the next keyframe.
class H264Decoder
{
public:
  /// Throws SourceError if FFmpeg was built without an H.264 decoder.
  H264Decoder();
  ~H264Decoder();

  /// Waits for the next keyframe. To be called when frames were lost.
  void restart();

  /// Decodes one frame; returns false if there is no image yet. `yu12` has the encoding yu12 (see encoding.hpp); its
  /// luma is from 16 to 235 whatever the stream's range is. Throws std::invalid_argument for a damaged frame.
  bool decode(const cv::Mat& bytes, cv::Mat& yu12);

private:
  struct Context;
  void send(const cv::Mat& bytes);
  bool receive(cv::Mat& yu12);

  std::unique_ptr<Context> context_;
  bool waiting_for_keyframe_ = true;
};

}  // namespace robot_vision
