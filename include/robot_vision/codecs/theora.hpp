#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// The most that a frame may have, 7680x4320 and a little: a stream keeps some five bytes for each as long as it lasts.
constexpr std::size_t kMaxVideoPixels = std::size_t{1} << 25;

struct TheoraParams
{
  bool constant_quality = true;
  int quality = 31;
  int target_bitrate = 800000;
  int keyframe_frequency = 64;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("constant_quality", &TheoraParams::constant_quality, Anything{}, "",
          "keep to the quality, else to the bit rate");
    visit("quality", &TheoraParams::quality, Range{0, 63}, "", "0 small, 63 good");
    visit("target_bitrate", &TheoraParams::target_bitrate, Range{1, 99200000}, "bit/s", "at 30 Hz");
    visit("keyframe_frequency", &TheoraParams::keyframe_frequency, Range{1, 64}, "frames",
          "at most from one whole image to the next");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const TheoraParams& params);

/// One of the three headers that a stream begins with, or one frame.
struct TheoraPacket
{
  std::vector<std::uint8_t> data;
  bool begins_stream = false;
  bool ends_stream = false;
  std::int64_t granule_position = 0;
  std::int64_t number = 0;  // counts from 0, headers too
};

/// Makes a Theora stream of pictures. Brightness and colours are coded as theora_image_transport codes them, in the
/// whole range of 0 to 255. The headers are repeated in front of every key frame, so that a reader who comes later, or
/// has lost some, sees pictures again from there. Not thread-safe.
class TheoraEncoder
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TheoraEncoder(const TheoraParams& params = TheoraParams());
  ~TheoraEncoder();
  TheoraEncoder(TheoraEncoder&&) noexcept;
  TheoraEncoder& operator=(TheoraEncoder&&) noexcept;

  /// The next picture (CV_8UC3, BGR) as packets; another size than the last begins a new stream.
  /// Throws std::invalid_argument for a picture of another type or with too many pixels.
  std::vector<TheoraPacket> encode(const cv::Mat& bgr);

  /// Makes the next picture a key frame.
  void requestKeyframe() { keyframe_wanted_ = true; }

  /// Of the stream so far; none before the first picture.
  const std::vector<TheoraPacket>& headers() const { return headers_; }

private:
  struct Stream;

  void begin(cv::Size size);
  void setKeyframeFrequency(int frames);

  TheoraParams params_;
  bool keyframe_wanted_ = false;
  std::unique_ptr<Stream> stream_;
  std::vector<TheoraPacket> headers_;
};

/// Reads a Theora stream from wherever it is joined. Not thread-safe.
class TheoraDecoder
{
public:
  TheoraDecoder();
  ~TheoraDecoder();
  TheoraDecoder(TheoraDecoder&&) noexcept;
  TheoraDecoder& operator=(TheoraDecoder&&) noexcept;

  /// How much is done to soften the edges of blocks: 0 (nothing) to 7, as far as the library goes.
  void setPostProcessing(int level);

  /// True if the packet gave a picture (CV_8UC3, BGR); false for headers, and while headers or a key frame are waited
  /// for. Throws std::invalid_argument if it is damaged or its picture too large.
  bool decode(const TheoraPacket& packet, cv::Mat& bgr);

private:
  struct Stream;

  int post_processing_ = 0;
  std::unique_ptr<Stream> stream_;
};

}  // namespace robot_vision
