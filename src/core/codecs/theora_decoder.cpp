#include <theora/theoradec.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "robot_vision/codecs/theora.hpp"
#include "robot_vision/common/range.hpp"
#include "theora_setup.hpp"

namespace robot_vision
{
namespace
{

[[noreturn]] void refuse(std::size_t size, const std::string& reason)
{
  throw std::invalid_argument("Theora packet of " + std::to_string(size) + " bytes " + reason);
}

/// A packet for libtheora, which shares the memory and only reads it.
ogg_packet toOgg(const TheoraPacket& packet)
{
  ogg_packet ogg;
  ogg.packet = const_cast<unsigned char*>(packet.data.data());
  ogg.bytes = static_cast<long>(packet.data.size());
  ogg.b_o_s = packet.begins_stream ? 1 : 0;
  ogg.e_o_s = packet.ends_stream ? 1 : 0;
  ogg.granulepos = packet.granule_position;
  ogg.packetno = packet.number;
  return ogg;
}

bool isSetupHeader(const TheoraPacket& packet)
{
  return !packet.data.empty() && packet.data[0] == 0x82;  // Theora specification, 6.1
}

cv::Mat toMat(const th_img_plane& plane)
{
  return {plane.height, plane.width, CV_8UC1, plane.data, static_cast<std::size_t>(plane.stride)};
}

}  // namespace

struct TheoraDecoder::Stream
{
  Stream()
  {
    th_info_init(&info);
    th_comment_init(&comment);
  }
  ~Stream()
  {
    if (context != nullptr) th_decode_free(context);
    th_setup_free(setup);
    th_comment_clear(&comment);
    th_info_clear(&info);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Returns whether the packet gave an image. After an exception the stream must not be used any more, because
  /// libtheora may have stopped halfway.
  bool decode(const TheoraPacket& packet, int post_processing, cv::Mat& bgr)
  {
    ogg_packet ogg = toOgg(packet);
    if (context == nullptr)
    {
      if (isSetupHeader(packet) && !isTheoraSetup(packet.data)) refuse(packet.data.size(), "is a damaged setup header");
      if (!readHeader(ogg)) return false;
      setPostProcessing(post_processing);
    }
    if (th_packet_isheader(&ogg) == 1) return false;  // repeated headers of which the first was lost
    const bool follows =
        keyframe_seen && static_cast<std::uint64_t>(packet.number) == static_cast<std::uint64_t>(number) + 1;
    number = packet.number;
    keyframe_seen = follows || th_packet_iskeyframe(&ogg) == 1;
    if (!keyframe_seen) return false;
    const int result = th_decode_packetin(context, &ogg, nullptr);
    if (result != 0 && result != TH_DUPFRAME) refuse(packet.data.size(), "is a damaged frame");
    copyImage(bgr);  // a frame without changes gives the last image again
    return true;
  }

  /// Reads a header. Returns true if all headers have been read before, so that the packet is a frame.
  bool readHeader(ogg_packet& packet)
  {
    const int result = th_decode_headerin(&info, &comment, &setup, &packet);
    if (result > 0) return false;
    if (result == TH_ENOTFORMAT) return false;  // a frame, while the headers are still to come
    if (result != 0) refuse(static_cast<std::size_t>(packet.bytes), "is a damaged header");
    if (info.pic_width == 0 || info.pic_height == 0 ||
        static_cast<std::uint64_t>(info.frame_width) * info.frame_height > kMaxVideoPixels)
      refuse(static_cast<std::size_t>(packet.bytes),
             "belongs to images of " + sizeText(info.pic_width, info.pic_height) + " in frames of " +
                 sizeText(info.frame_width, info.frame_height) + ", must be of 1 to " +
                 std::to_string(kMaxVideoPixels) + " pixels");
    context = th_decode_alloc(&info, setup);
    if (context == nullptr) refuse(static_cast<std::size_t>(packet.bytes), "belongs to headers that make no stream");
    return true;
  }

  void setPostProcessing(int level)
  {
    int max_level = 0;
    th_decode_ctl(context, TH_DECCTL_GET_PPLEVEL_MAX, &max_level, sizeof(max_level));
    level = std::min(level, max_level);
    th_decode_ctl(context, TH_DECCTL_SET_PPLEVEL, &level, sizeof(level));
  }

  void copyImage(cv::Mat& bgr)
  {
    th_ycbcr_buffer planes;
    th_decode_ycbcr_out(context, planes);
    const cv::Rect visible(static_cast<int>(info.pic_x), static_cast<int>(info.pic_y), static_cast<int>(info.pic_width),
                           static_cast<int>(info.pic_height));
    std::array<cv::Mat, 3> channels = {toMat(planes[0]), cv::Mat(), cv::Mat()};
    cv::resize(toMat(planes[2]), channels[1], channels[0].size());
    cv::resize(toMat(planes[1]), channels[2], channels[0].size());
    for (cv::Mat& channel : channels)
      channel = channel(visible);
    cv::Mat merged;
    cv::merge(channels.data(), channels.size(), merged);
    cv::cvtColor(merged, bgr, cv::COLOR_YCrCb2BGR);
  }

  th_info info;
  th_comment comment;
  th_setup_info* setup = nullptr;
  th_dec_ctx* context = nullptr;
  bool keyframe_seen = false;  // frames before a key frame, or behind a lost one, are changes of an unknown image
  std::int64_t number = 0;     // of the last frame
};

TheoraDecoder::TheoraDecoder() : stream_(std::make_unique<Stream>())
{
}
TheoraDecoder::~TheoraDecoder() = default;

void TheoraDecoder::setPostProcessing(int level)
{
  post_processing_ = level;
  if (stream_->context != nullptr) stream_->setPostProcessing(level);
}

bool TheoraDecoder::decode(const TheoraPacket& packet, cv::Mat& bgr)
{
  if (packet.begins_stream) stream_ = std::make_unique<Stream>();
  try
  {
    return stream_->decode(packet, post_processing_, bgr);
  }
  catch (...)
  {
    stream_ = std::make_unique<Stream>();
    throw;
  }
}

}  // namespace robot_vision
