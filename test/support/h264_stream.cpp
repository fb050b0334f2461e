#include "h264_stream.hpp"

extern "C"
{
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include <memory>
#include <stdexcept>

namespace robot_vision
{
namespace
{

struct Freer
{
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

void check(int error)
{
  if (error < 0) throw std::runtime_error("libx264 failed: " + std::to_string(error));
}

void fill(AVFrame& frame, const cv::Mat& yu12)
{
  check(av_frame_make_writable(&frame));
  const unsigned char* from = yu12.data;
  for (int plane = 0; plane < 3; ++plane)
  {
    const cv::Size size = plane == 0 ? cv::Size(frame.width, frame.height) : cv::Size(frame.width, frame.height) / 2;
    const cv::Mat packed(size, CV_8UC1, const_cast<unsigned char*>(from));
    cv::Mat rows(size, CV_8UC1, frame.data[plane], static_cast<std::size_t>(frame.linesize[plane]));
    packed.copyTo(rows);
    from += size.area();
  }
}

}  // namespace

std::vector<cv::Mat> H264Stream::encode(const std::vector<cv::Mat>& images) const
{
  const AVCodec* encoder = avcodec_find_encoder_by_name("libx264");
  if (encoder == nullptr) return {};
  const std::unique_ptr<AVCodecContext, Freer> codec(avcodec_alloc_context3(encoder));
  codec->width = images.front().cols;
  codec->height = images.front().rows * 2 / 3;
  codec->time_base = {1, 30};
  codec->pix_fmt = chroma_422 ? AV_PIX_FMT_YUV422P : AV_PIX_FMT_YUV420P;
  codec->color_range = full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  codec->gop_size = keyframe_every;
  codec->thread_count = 1;
  codec->log_level_offset = 100;  // keeps its statistics out of the output
  check(av_opt_set(codec->priv_data, "preset", "ultrafast", 0));
  check(av_opt_set(codec->priv_data, "tune", "zerolatency", 0));
  check(av_opt_set(codec->priv_data, "crf", "10", 0));
  check(avcodec_open2(codec.get(), encoder, nullptr));
  const std::unique_ptr<AVFrame, Freer> frame(av_frame_alloc());
  const std::unique_ptr<AVPacket, Freer> packet(av_packet_alloc());
  frame->width = codec->width;
  frame->height = codec->height;
  frame->format = codec->pix_fmt;
  check(av_frame_get_buffer(frame.get(), 0));
  std::vector<cv::Mat> packets;
  for (const cv::Mat& image : images)
  {
    if (!chroma_422) fill(*frame, image);
    frame->pts = static_cast<std::int64_t>(packets.size());
    check(avcodec_send_frame(codec.get(), frame.get()));
    check(avcodec_receive_packet(codec.get(), packet.get()));
    packets.push_back(cv::Mat(1, packet->size, CV_8UC1, packet->data).clone());
    av_packet_unref(packet.get());
  }
  return packets;
}

}  // namespace robot_vision
