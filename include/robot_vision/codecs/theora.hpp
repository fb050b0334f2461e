#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"

struct th_enc_ctx;  // of libtheora

namespace robot_vision
{

/// The most pixels of a frame, slightly more than 7680x4320. A stream keeps some five bytes for each of them.
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

/// One of the three headers at the start of a stream, or one frame.
struct TheoraPacket
{
  std::vector<std::uint8_t> data;
  bool begins_stream = false;
  bool ends_stream = false;
  std::int64_t granule_position = 0;
  std::int64_t number = 0;  // counts packets from 0, headers included
};

/// Encodes images as a Theora stream. Luma and chroma use the whole range from 0 to 255, as theora_image_transport has
/// it. The headers are repeated in front of every key frame, so that a reader that joins later or has lost packets can
/// decode from there on. Not thread-safe.
class TheoraEncoder
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TheoraEncoder(const TheoraParams& params = TheoraParams());

  /// Encodes the next image (CV_8UC3, BGR). A size other than the last one begins a new stream.
  /// Throws std::invalid_argument for an image of another type, without pixels or with too many.
  std::vector<TheoraPacket> encode(const cv::Mat& bgr);

  /// Makes the next image a key frame.
  void requestKeyframe() { keyframe_wanted_ = true; }

  /// The headers of the current stream; none before the first image.
  const std::vector<TheoraPacket>& headers() const { return headers_; }

private:
  void begin(cv::Size size);
  void setKeyframeFrequency(int frames);

  TheoraParams params_;
  bool keyframe_wanted_ = false;
  cv::Size size_;  // px, of the images of the stream
  std::unique_ptr<th_enc_ctx, void (*)(th_enc_ctx*)> stream_{nullptr, nullptr};
  std::vector<TheoraPacket> headers_;
};

/// Decodes a Theora stream, from any packet on. Not thread-safe.
class TheoraDecoder
{
public:
  TheoraDecoder();
  ~TheoraDecoder();

  /// Sets how much the edges of blocks are softened: 0 (not at all) to 7, limited to what libtheora supports.
  void setPostProcessing(int level);

  /// Returns whether the packet gave an image (CV_8UC3, BGR): headers do not, nor do frames before the headers and a
  /// key frame have come, or from a lost one, as the numbers tell, to the next key frame. Throws std::invalid_argument
  /// if the packet is damaged or its image too large.
  bool decode(const TheoraPacket& packet, cv::Mat& bgr);

private:
  struct Stream;

  int post_processing_ = 0;
  std::unique_ptr<Stream> stream_;
};

}  // namespace robot_vision
