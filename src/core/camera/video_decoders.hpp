#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// Decodes an H.264 stream (ITU-T H.264, annex B) frame by frame, without the delay of decoders that wait for more
/// frames. At the start and after a damaged frame, images begin with the next keyframe.
class H264Decoder
{
public:
  virtual ~H264Decoder() = default;

  /// Waits for the next keyframe. To be called when frames were lost.
  virtual void restart() = 0;

  /// Decodes one frame; returns false if there is no image yet. `yu12` has the encoding yu12 (see encoding.hpp); its
  /// luma is from 16 to 235 whatever the stream's range is. Throws std::invalid_argument for a damaged frame.
  virtual bool decode(const cv::Mat& bytes, cv::Mat& yu12) = 0;
};

/// The following two load their library with the first call, see on_demand.hpp.

/// Throws SourceError if FFmpeg was built without an H.264 decoder.
std::unique_ptr<H264Decoder> makeH264Decoder();

/// A video file, or a stream by its URL, which may leave its reader without data for `timeout` seconds, 5 at least and
/// 30 at most. Throws SourceUnavailable if the stream does not answer, SourceError if the file cannot be read.
std::unique_ptr<FrameSource> openVideo(const std::string& path, double timeout);

}  // namespace robot_vision

extern "C"
{
  // Those of the library "codecs"; the caller owns what they return.
  robot_vision::H264Decoder* robot_vision_make_h264_decoder();
  robot_vision::FrameSource* robot_vision_open_video(const std::string& path, double timeout);
}
