#include "ffmpeg_h264_decoder.hpp"

extern "C"
{
#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>
}

#include <array>
#include <cstdint>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr int kLogLevelOffset =
    100;  // lowers the level of FFmpeg's messages until none is printed: errors become exceptions

struct Freer
{
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

template <class T>
std::unique_ptr<T, Freer> own(T* object)
{
  if (object == nullptr) throw std::bad_alloc();
  return std::unique_ptr<T, Freer>(object);
}

std::string describe(int error)
{
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

/// A table that maps the full 8-bit range to the limited range of our encodings, 16 to `white`.
cv::Mat fullToLimitedRange(double white)
{
  cv::Mat table(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i)
    table.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  table.convertTo(table, CV_8U, (white - 16.0) / 255.0, 16.0);
  return table;
}

void copyPlane(const AVFrame& frame, int plane, cv::Size size, const cv::Mat& table, std::uint8_t* to)
{
  const cv::Mat from(size, CV_8UC1, frame.data[plane], static_cast<std::size_t>(frame.linesize[plane]));
  cv::Mat packed(size, CV_8UC1, to);
  if (table.empty())
    from.copyTo(packed);
  else
    cv::LUT(from, table, packed);
}

void copyImage(const AVFrame& frame, cv::Mat& yu12)
{
  const bool full_range = frame.format == AV_PIX_FMT_YUVJ420P || frame.color_range == AVCOL_RANGE_JPEG;
  static const cv::Mat luma_table = fullToLimitedRange(235.0);
  static const cv::Mat chroma_table = fullToLimitedRange(240.0);
  const cv::Size size(frame.width, frame.height);
  yu12.create(size.height * 3 / 2, size.width, CV_8UC1);
  std::uint8_t* const chroma = yu12.ptr(size.height);
  copyPlane(frame, 0, size, full_range ? luma_table : cv::Mat(), yu12.data);
  copyPlane(frame, 1, size / 2, full_range ? chroma_table : cv::Mat(), chroma);
  copyPlane(frame, 2, size / 2, full_range ? chroma_table : cv::Mat(), chroma + (size / 2).area());
}

void checkFrame(const AVFrame& frame)
{
  const auto refuse = [](const std::string& reason) { throw std::invalid_argument("H.264 image " + reason); };
  if (frame.format != AV_PIX_FMT_YUV420P && frame.format != AV_PIX_FMT_YUVJ420P)
  {
    const char* name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format));
    refuse("in the pixel format " + std::string(name == nullptr ? "?" : name) + ", expected yuv420p or yuvj420p");
  }
  if (frame.width % 2 != 0 || frame.height % 2 != 0)
    refuse("of " + sizeText(frame.width, frame.height) + ", expected even sizes");
  if (frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0)
    refuse("is damaged, or follows one that was lost");
}

/// True if a NAL unit of the frame is a keyframe (type 5, IDR) or the parameter set that precedes one (type 7, SPS).
bool hasKeyframe(const cv::Mat& bytes)
{
  const std::uint8_t* const end = bytes.data + bytes.total();
  for (const std::uint8_t* p = bytes.data; p + 3 < end; ++p)
  {
    if (p[0] != 0 || p[1] != 0 || p[2] != 1) continue;
    const int type = p[3] & 0x1F;
    if (type == 5 || type == 7) return true;
  }
  return false;
}

}  // namespace

struct FfmpegH264Decoder::Context
{
  std::unique_ptr<AVCodecContext, Freer> codec;
  std::unique_ptr<AVPacket, Freer> packet;
  std::unique_ptr<AVFrame, Freer> frame;
};

FfmpegH264Decoder::FfmpegH264Decoder() : context_(std::make_unique<Context>())
{
  const AVCodec* decoder = avcodec_find_decoder(AV_CODEC_ID_H264);
  if (decoder == nullptr) throw SourceError("FFmpeg's libavcodec has no decoder for H.264 here");
  context_->codec = own(avcodec_alloc_context3(decoder));
  context_->packet = own(av_packet_alloc());
  context_->frame = own(av_frame_alloc());
  AVCodecContext& codec = *context_->codec;
  codec.flags |= AV_CODEC_FLAG_LOW_DELAY;
  // Threads for frames would delay the images by as many frames, and few cameras' streams have the slices for slice
  // threads.
  codec.thread_count = 1;
  codec.max_pixels = std::int64_t{kMaxPixels};
  codec.log_level_offset = kLogLevelOffset;
  const int error = avcodec_open2(&codec, decoder, nullptr);
  if (error != 0) throw SourceError("FFmpeg's decoder for H.264 cannot be opened: " + describe(error));
}

FfmpegH264Decoder::~FfmpegH264Decoder() = default;

void FfmpegH264Decoder::restart()
{
  avcodec_flush_buffers(context_->codec.get());
  waiting_for_keyframe_ = true;
}

bool FfmpegH264Decoder::decode(const cv::Mat& bytes, cv::Mat& yu12)
{
  if (bytes.empty()) throw std::invalid_argument("H.264 frame is empty");
  if (waiting_for_keyframe_ && !hasKeyframe(bytes)) return false;
  waiting_for_keyframe_ = false;
  try
  {
    send(bytes);
    return receive(yu12);
  }
  catch (const std::invalid_argument&)
  {
    restart();
    throw;
  }
}

void FfmpegH264Decoder::send(const cv::Mat& bytes)
{
  AVPacket& packet = *context_->packet;
  int error = av_new_packet(&packet, static_cast<int>(bytes.total()));
  if (error == 0)
  {
    std::memcpy(packet.data, bytes.data, bytes.total());
    error = avcodec_send_packet(context_->codec.get(), &packet);
    av_packet_unref(&packet);
  }
  if (error != 0)
    throw std::invalid_argument("H.264 frame of " + std::to_string(bytes.total()) + " bytes: " + describe(error));
}

bool FfmpegH264Decoder::receive(cv::Mat& yu12)
{
  bool decoded = false;
  int error;
  while ((error = avcodec_receive_frame(context_->codec.get(), context_->frame.get())) == 0)
  {
    checkFrame(*context_->frame);
    copyImage(*context_->frame, yu12);  // the newest image stays if there are several
    decoded = true;
  }
  if (error != AVERROR(EAGAIN)) throw std::invalid_argument("H.264 frame cannot be decoded: " + describe(error));
  return decoded;
}

}  // namespace robot_vision

robot_vision::H264Decoder* robot_vision_make_h264_decoder()
{
  return std::make_unique<robot_vision::FfmpegH264Decoder>().release();
}
