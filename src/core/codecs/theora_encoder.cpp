#include <theora/theoraenc.h>

#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "robot_vision/codecs/theora.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBlock = 16;        // px; both sides of a coded frame are multiples of it
constexpr int kGranuleShift = 6;  // bits that count the frames since a key frame: keyframe_frequency is 64 at most
constexpr int kNominalRate = 30;  // Hz; a stream has to name a rate, to which the target bit rate refers

int padded(int side)
{
  return (side + kBlock - 1) / kBlock * kBlock;
}

TheoraPacket toPacket(const ogg_packet& from)
{
  TheoraPacket packet;
  packet.data.assign(from.packet, from.packet + from.bytes);
  packet.begins_stream = from.b_o_s != 0;
  packet.ends_stream = from.e_o_s != 0;
  packet.granule_position = from.granulepos;
  packet.number = from.packetno;
  return packet;
}

th_img_plane toPlane(const cv::Mat& pixels)
{
  return {pixels.cols, pixels.rows, static_cast<int>(pixels.step), pixels.data};
}

}  // namespace

TheoraEncoder::TheoraEncoder(const TheoraParams& params) : params_(params)
{
  validate(params);
}

void TheoraEncoder::setKeyframeFrequency(int frames)
{
  auto frequency = static_cast<ogg_uint32_t>(frames);
  th_encode_ctl(stream_.get(), TH_ENCCTL_SET_KEYFRAME_FREQUENCY_FORCE, &frequency, sizeof(frequency));
}

void TheoraEncoder::begin(cv::Size size)
{
  th_info info;
  th_info_init(&info);
  info.frame_width = static_cast<ogg_uint32_t>(padded(size.width));
  info.frame_height = static_cast<ogg_uint32_t>(padded(size.height));
  info.pic_width = static_cast<ogg_uint32_t>(size.width);
  info.pic_height = static_cast<ogg_uint32_t>(size.height);
  info.fps_numerator = kNominalRate;
  info.fps_denominator = 1;
  info.aspect_numerator = 1;
  info.aspect_denominator = 1;
  info.colorspace = TH_CS_UNSPECIFIED;
  info.pixel_fmt = TH_PF_420;
  info.keyframe_granule_shift = kGranuleShift;
  info.quality = params_.quality;
  info.target_bitrate = params_.constant_quality ? 0 : params_.target_bitrate;
  decltype(stream_) stream(th_encode_alloc(&info), th_encode_free);
  th_info_clear(&info);
  if (!stream) throw std::runtime_error("Theora cannot encode images of " + toText(size));
  stream_ = std::move(stream);
  size_ = size;

  headers_.clear();
  th_comment comment;
  th_comment_init(&comment);
  ogg_packet packet;
  while (th_encode_flushheader(stream_.get(), &comment, &packet) > 0)
    headers_.push_back(toPacket(packet));
  th_comment_clear(&comment);
  setKeyframeFrequency(params_.keyframe_frequency);
}

std::vector<TheoraPacket> TheoraEncoder::encode(const cv::Mat& bgr)
{
  const auto frame_pixels = static_cast<std::size_t>(padded(bgr.rows)) * static_cast<std::size_t>(padded(bgr.cols));
  if (bgr.empty() || bgr.type() != CV_8UC3 || frame_pixels > kMaxVideoPixels)
    throw std::invalid_argument("an image of " + toText(bgr.size()) + " (" + cv::typeToString(bgr.type()) +
                                ") cannot become Theora, must be CV_8UC3 of 1 to " + std::to_string(kMaxVideoPixels) +
                                " pixels");
  if (!stream_ || size_ != bgr.size()) begin(bgr.size());

  cv::Mat frame;
  cv::copyMakeBorder(bgr, frame, 0, padded(bgr.rows) - bgr.rows, 0, padded(bgr.cols) - bgr.cols, cv::BORDER_REPLICATE);
  cv::cvtColor(frame, frame, cv::COLOR_BGR2YCrCb);
  std::vector<cv::Mat> planes;
  cv::split(frame, planes);
  cv::Mat cr;
  cv::Mat cb;
  cv::resize(planes[1], cr, frame.size() / 2, 0, 0, cv::INTER_AREA);
  cv::resize(planes[2], cb, frame.size() / 2, 0, 0, cv::INTER_AREA);
  th_ycbcr_buffer image = {toPlane(planes[0]), toPlane(cb), toPlane(cr)};

  if (keyframe_wanted_) setKeyframeFrequency(1);
  if (th_encode_ycbcr_in(stream_.get(), image) != 0) throw std::runtime_error("Theora cannot encode the image");
  if (keyframe_wanted_) setKeyframeFrequency(params_.keyframe_frequency);
  keyframe_wanted_ = false;

  std::vector<TheoraPacket> packets;
  ogg_packet packet;
  while (th_encode_packetout(stream_.get(), 0, &packet) > 0)
  {
    if (th_packet_iskeyframe(&packet) == 1) packets.insert(packets.end(), headers_.begin(), headers_.end());
    packets.push_back(toPacket(packet));
  }
  return packets;
}

}  // namespace robot_vision
