#pragma once

#include <linux/videodev2.h>

#include <string>
#include <vector>

#include "robot_vision/frame_source.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// A Video4Linux2 capture device, streaming over memory-mapped buffers; frames keep the kernel's time stamp.
/// See https://www.kernel.org/doc/html/latest/userspace-api/media/v4l/capture-example.html for the order of the calls.
class V4l2Source : public FrameSource
{
public:
  /// Opens the device and agrees on a format. Throws SourceUnavailable naming the device and the failed call.
  V4l2Source(const std::string& device, const CaptureParams& params);
  ~V4l2Source() override;

  ReadResult read(Frame& frame) override;
  double rate() const override { return 0.0; }
  std::string description() const override;
  std::string warning() const override { return warning_; }

private:
  struct Buffer
  {
    void* start = nullptr;
    std::size_t length = 0;
  };

  void requireCapture();
  bool askFor(std::uint32_t fourcc, const CaptureParams& params);
  void setFormat(const CaptureParams& params);
  void setRate(double rate);
  void start();
  void mapBuffers();
  void queue(unsigned index);
  std::size_t rowStep() const;
  int rows() const;
  std::string damageOf(const v4l2_buffer& filled) const;
  cv::Mat view(const v4l2_buffer& filled) const;

  V4l2Device device_;
  v4l2_pix_format format_{};
  double rate_ = 0.0;  // Hz, as the driver gave it; 0: it does not say
  std::string warning_;
  bool streaming_ = false;
  std::vector<Buffer> buffers_;
  int held_ = -1;                     // index of the buffer that the last frame points into
  std::int64_t first_sequence_ = -1;  // the driver's number of our frame 0, as if there were no damaged frames
};

}  // namespace robot_vision
