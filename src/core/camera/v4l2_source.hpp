#pragma once

#include <linux/videodev2.h>

#include <memory>
#include <string>
#include <vector>

#include "robot_vision/camera/open_source.hpp"
#include "v4l2_device.hpp"
#include "v4l2_mode.hpp"
#include "video_decoders.hpp"

namespace robot_vision
{

/// Captures from a Video4Linux2 device through memory-mapped buffers. Frames keep the kernel's time stamp. The order of
/// the calls is that of https://www.kernel.org/doc/html/latest/userspace-api/media/v4l/capture-example.html.
class V4l2Source : public FrameSource
{
public:
  /// Negotiates a format with the device. `warning` is put in front of the text that warning() returns. Throws
  /// SourceUnavailable naming the device and the failed call.
  V4l2Source(std::shared_ptr<V4l2Device> device, const CaptureParams& params, const std::string& warning = "");
  ~V4l2Source() override;

  ReadResult read(Frame& frame) override;
  double rate() const override { return 0.0; }
  double period() const override;
  bool fillsMemory() const override { return false; }
  std::shared_ptr<V4l2Device> device() const override { return device_; }
  std::string description() const override;
  std::string warning() const override { return warning_; }

private:
  struct Buffer
  {
    void* start = nullptr;
    std::size_t length = 0;
  };

  void requireCapture();
  void start();
  void mapBuffers();
  void queue(unsigned index);
  bool canFill();
  void giveBack();
  bool dequeue(v4l2_buffer& filled);
  bool dequeueNewest(v4l2_buffer& filled);
  bool take(const v4l2_buffer& filled, Frame& frame);
  [[noreturn]] void refuse(const v4l2_buffer& filled, const std::string& reason);

  std::shared_ptr<V4l2Device> device_;  // shared with the users of its controls
  V4l2Mode mode_;
  std::string warning_;
  std::unique_ptr<H264Decoder> decoder_;  // null if frames need none
  std::uint32_t next_decoded_ = 0;        // the driver's number of the frame after the last decoded one
  cv::Mat own_image_;                     // the image if it cannot be used in the driver's buffer
  bool streaming_ = false;
  std::vector<Buffer> buffers_;
  int held_ = -1;                     // index of the buffer that the last frame points into
  std::uint32_t next_sequence_ = 0;   // the driver's number of the frame after the last one
  bool behind_ = false;               // whether frames are lost and no read() has had to wait for one since
  std::int64_t first_sequence_ = -1;  // the driver's number of our frame 0 plus the number of refused frames
};

}  // namespace robot_vision
