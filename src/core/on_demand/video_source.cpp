#include "video_source.hpp"

#include <algorithm>
#include <memory>

#include "core/camera/video_decoders.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kShortestTimeout = 5.0;  // s, of a stream
constexpr double kLongestTimeout = 30.0;  // s
constexpr int kOrientationAuto = 49;      // cv::CAP_PROP_ORIENTATION_AUTO; versions of OpenCV without it turn no frames

/// The path, without the user and the password that a URL may have, for what is logged and published.
std::string withoutLogin(const std::string& path)
{
  const std::size_t scheme = path.find("://");
  if (scheme == std::string::npos) return path;
  const std::size_t begin = scheme + 3;
  const std::size_t at = path.substr(0, path.find_first_of("/?#", begin)).rfind('@');
  return at == std::string::npos || at < begin ? path : path.substr(0, begin) + path.substr(at + 1);
}

/// How many frames a video may be too short before it counts as truncated. The container's number of frames may be
/// rounded from the duration, and its rate may be the mean of a varying one.
std::int64_t tolerance(std::int64_t expected)
{
  return std::max<std::int64_t>(2, expected / 50);
}

}  // namespace

VideoSource::VideoSource(const std::string& path, double timeout)
  : path_(path), shown_(withoutLogin(path)), url_(path.find("://") != std::string::npos), timeout_(timeout)
{
  open();
  rate_ = capture_.get(cv::CAP_PROP_FPS);
  expected_ = std::max<std::int64_t>(0, static_cast<std::int64_t>(capture_.get(cv::CAP_PROP_FRAME_COUNT)));
  live_ = url_ && expected_ == 0;
  if (live_)
    frames_ = std::make_unique<LiveFrames>([this] { return grab(); },
                                           [this](cv::Mat& image) { return capture_.retrieve(image); });
  if (!(rate_ > 0.0 && rate_ <= 1000.0)) rate_ = kDefaultRate;  // the container states no usable rate
}

void VideoSource::open()
{
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 6)
  // A server that does not answer delays the node's shutdown for so long, and FFmpeg's own timeouts are half a minute.
  // It takes a few seconds of a stream to know what it is.
  const int limit = static_cast<int>(std::clamp(timeout_, kShortestTimeout, kLongestTimeout) * 1e3);
  const std::vector<int> limits = {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, limit, cv::CAP_PROP_READ_TIMEOUT_MSEC, limit};
  const bool opened = capture_.open(path_, cv::CAP_FFMPEG, url_ ? limits : std::vector<int>{});
#else
  const bool opened = capture_.open(path_, cv::CAP_FFMPEG);
#endif
  capture_.set(kOrientationAuto, 0.0);  // keeps the pixels as the sensor had them, as the calibration does
  grabbed_ = opened && capture_.grab();
  if (grabbed_) return;
  if (url_) throw SourceUnavailable(shown_ + ": the stream cannot be opened");
  throw SourceError(shown_ + ": not an image or video that FFmpeg can read, or truncated");
}

ReadResult VideoSource::read(Frame& frame)
{
  if (live_) return readLive(frame);
  if (!grab()) return endOrThrow();
  if (!capture_.retrieve(frame.image)) throw std::invalid_argument(shown_ + ": a frame cannot be decoded");
  frame.encoding = "bgr8";
  frame.sequence = sequence_++;
  ++played_;
  end_s_ = capture_.get(cv::CAP_PROP_POS_MSEC) / 1e3 + 1.0 / rate_;
  return ReadResult::kFrame;
}

ReadResult VideoSource::readLive(Frame& frame)
{
  try
  {
    if (!frames_->take(frame)) return endOrThrow();
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument(shown_ + ": " + e.what());
  }
  frame.encoding = "bgr8";
  return ReadResult::kFrame;
}

ReadResult VideoSource::endOrThrow() const
{
  if (live_) throw SourceUnavailable(shown_ + ": the stream has ended");
  const std::int64_t missing = expected_ - played_;
  const double missing_s = static_cast<double>(expected_) / rate_ - end_s_;
  if (missing <= tolerance(expected_) || missing_s * rate_ <= static_cast<double>(tolerance(expected_)))
    return ReadResult::kEnd;
  const std::string part = std::to_string(played_) + " of " + std::to_string(expected_) + " frames";
  if (url_) throw SourceUnavailable(shown_ + ": the stream broke off after " + part);
  throw SourceError(shown_ + ": truncated or damaged, only " + part + " could be decoded");
}

void VideoSource::rewind()
{
  if (live_) return;
  open();  // the file is opened again, because seeking to frame 0 is not exact in every container
  played_ = 0;
}

std::string VideoSource::description() const
{
  return (live_ ? "stream " : "video at " + toText(rate_) + " Hz from ") + shown_;
}

}  // namespace robot_vision

robot_vision::FrameSource* robot_vision_open_video(const std::string& path, double timeout)
{
  return std::make_unique<robot_vision::VideoSource>(path, timeout).release();
}
