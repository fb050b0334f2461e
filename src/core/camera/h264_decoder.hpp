#pragma once

#include <memory>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Decodes an H.264 stream (ITU-T H.264, annex B), a frame at a time and without the delay of decoders that wait for
/// more. Pictures begin with one that needs no others: at the start, and again after every damage.
class H264Decoder
{
public:
  /// Throws SourceError if FFmpeg was built without it.
  H264Decoder();
  ~H264Decoder();

  /// Waits for the next picture that needs no others: frames before were lost.
  void restart();

  /// False if there is no picture yet. `yu12` is of encoding yu12 (see encoding.hpp), the luma from 16 to 235 whatever
  /// the stream's range. Throws std::invalid_argument for a frame that is damaged.
  bool decode(const cv::Mat& bytes, cv::Mat& yu12);

private:
  struct Context;
  void send(const cv::Mat& bytes);
  bool receive(cv::Mat& yu12);

  std::unique_ptr<Context> context_;
  bool waiting_ = true;  // for a picture that needs no others
};

}  // namespace robot_vision
