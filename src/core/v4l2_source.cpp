#include "v4l2_source.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cerrno>

#include "robot_vision/monotonic.hpp"
#include "robot_vision/range.hpp"
#include "v4l2_format.hpp"

namespace robot_vision
{
namespace
{

constexpr int kWaitMs = 100;
constexpr unsigned kBuffers = 4;

/// The driver's time stamp; some count by another clock, and then the arrival is the best that is known. It is also the
/// latest possible: a driver may stamp a frame with the time when it should end, and give it before that.
std::int64_t monotonicStamp(const v4l2_buffer& filled)
{
  const std::int64_t now = monotonicNow();
  if ((filled.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) return now;
  return std::min<std::int64_t>(now, filled.timestamp.tv_sec * 1000000000LL + filled.timestamp.tv_usec * 1000LL);
}

v4l2_buffer captureBuffer(unsigned index = 0)
{
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

V4l2Source::V4l2Source(const std::string& device, const CaptureParams& params) : device_(device)
{
  requireCapture();
  setFormat(params);
  setRate(wantedRate(params));
}

V4l2Source::~V4l2Source()
{
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (streaming_) device_.tryCall(VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_)
    munmap(buffer.start, buffer.length);
}

void V4l2Source::requireCapture()
{
  v4l2_capability capability{};
  device_.call(VIDIOC_QUERYCAP, &capability, "VIDIOC_QUERYCAP");
  const bool own = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t can = own ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0)
    throw SourceUnavailable(device_.path() + ": not a device that streams video (it lacks the capability " +
                            "VIDEO_CAPTURE or STREAMING)");
}

/// True if the driver's answer is a format that we take. It answers with what it can do, which need not be what it was
/// asked for, not even in the pixel format.
bool V4l2Source::askFor(std::uint32_t fourcc, const CaptureParams& params)
{
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(params.image_width);
  format.fmt.pix.height = static_cast<std::uint32_t>(params.image_height);
  format.fmt.pix.pixelformat = fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const int error = device_.tryCall(VIDIOC_S_FMT, &format);
  if (error != 0 && error != EINVAL) device_.fail("VIDIOC_S_FMT", error);
  format_ = format.fmt.pix;
  return error == 0 && findV4l2Format(format_.pixelformat) != nullptr;
}

void V4l2Source::setFormat(const CaptureParams& params)
{
  const std::uint32_t wanted = findV4l2Format(params.pixel_format)->fourcc;
  bool agreed = askFor(wanted, params);
  const v4l2_pix_format first_answer = format_;
  for (auto other = kV4l2Formats.begin(); !agreed && other != kV4l2Formats.end(); ++other)
    agreed = askFor(other->fourcc, params);
  const auto describe = [](const v4l2_pix_format& format)
  { return describeFormat(format.pixelformat, format.width, format.height); };
  if (!agreed)
    throw SourceUnavailable(device_.path() + ": gives " + describe(first_answer) +
                            ", and none of YUYV, UYVY, NV12, GREY and MJPG");

  const std::string asked = describeFormat(wanted, params.image_width, params.image_height);
  if (asked != describe(format_))
    warning_ = device_.path() + ": asked for " + asked + ", the driver gives " + describe(format_);
  if (format_.field != V4L2_FIELD_NONE && format_.field != V4L2_FIELD_INTERLACED)
    warning_ += (warning_.empty() ? device_.path() + ": " : ", ") + std::string("its pictures are single fields");
}

void V4l2Source::setRate(double rate)
{
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device_.tryCall(VIDIOC_G_PARM, &parameters) != 0) return;  // optional for a driver
  v4l2_fract& period = parameters.parm.capture.timeperframe;
  if ((parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0)
  {
    period.numerator = 1000;
    period.denominator = std::max(1U, static_cast<std::uint32_t>(rate * 1000.0 + 0.5));
    if (device_.tryCall(VIDIOC_S_PARM, &parameters) != 0) device_.tryCall(VIDIOC_G_PARM, &parameters);
  }
  if (period.numerator > 0) rate_ = static_cast<double>(period.denominator) / period.numerator;
}

void V4l2Source::start()
{
  mapBuffers();
  for (unsigned i = 0; i < buffers_.size(); ++i)
    queue(i);
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_.call(VIDIOC_STREAMON, &type, "VIDIOC_STREAMON");
  streaming_ = true;
  first_sequence_ = -1;
}

void V4l2Source::mapBuffers()
{
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  device_.call(VIDIOC_REQBUFS, &request, "VIDIOC_REQBUFS");
  for (unsigned i = 0; i < request.count; ++i)
  {
    v4l2_buffer buffer = captureBuffer(i);
    device_.call(VIDIOC_QUERYBUF, &buffer, "VIDIOC_QUERYBUF");
    buffers_.push_back({device_.map(buffer.length, buffer.m.offset), buffer.length});
  }
}

void V4l2Source::queue(unsigned index)
{
  v4l2_buffer buffer = captureBuffer(index);
  device_.call(VIDIOC_QBUF, &buffer, "VIDIOC_QBUF");
}

ReadResult V4l2Source::read(Frame& frame)
{
  if (!streaming_) start();
  if (held_ >= 0)
  {
    const int index = held_;
    held_ = -1;
    queue(static_cast<unsigned>(index));
  }
  if (!device_.waitReadable(kWaitMs)) return ReadResult::kTimeout;

  v4l2_buffer filled = captureBuffer();
  const int error = device_.tryCall(VIDIOC_DQBUF, &filled);
  if (error == EAGAIN) return ReadResult::kTimeout;
  if (error != 0) device_.fail("VIDIOC_DQBUF", error);
  if (filled.index >= buffers_.size()) device_.fail("VIDIOC_DQBUF", ERANGE);
  filled.bytesused = static_cast<std::uint32_t>(std::min<std::size_t>(filled.bytesused, buffers_[filled.index].length));
  held_ = static_cast<int>(filled.index);
  if (first_sequence_ < 0) first_sequence_ = filled.sequence;
  const std::string damage = damageOf(filled);
  if (!damage.empty())
  {
    ++first_sequence_;  // it counts as refused, and must not leave a gap as if it were lost as well
    throw std::invalid_argument(device_.path() + ": frame " + std::to_string(filled.sequence) + " " + damage);
  }
  frame.image = view(filled);
  frame.encoding = findV4l2Format(format_.pixelformat)->encoding;
  frame.sequence = static_cast<std::uint32_t>(filled.sequence - first_sequence_);  // the driver's counter wraps
  frame.monotonic_ns = monotonicStamp(filled);
  return ReadResult::kFrame;
}

std::size_t V4l2Source::rowStep() const
{
  const V4l2Format& format = *findV4l2Format(format_.pixelformat);
  return std::max<std::size_t>(format_.bytesperline, std::size_t{format_.width} * format.row_bytes_per_px);
}

int V4l2Source::rows() const
{
  const int height = static_cast<int>(format_.height);
  return format_.pixelformat == V4L2_PIX_FMT_NV12 ? height * 3 / 2 : height;
}

/// What is wrong with a frame, to follow its name; empty if nothing is.
std::string V4l2Source::damageOf(const v4l2_buffer& filled) const
{
  if ((filled.flags & V4L2_BUF_FLAG_ERROR) != 0) return "is marked as damaged by the driver";
  if (format_.pixelformat == V4L2_PIX_FMT_MJPEG) return "";
  const std::size_t bytes = rowStep() * static_cast<std::size_t>(rows());
  if (filled.bytesused >= bytes) return "";
  return "has " + std::to_string(filled.bytesused) + " bytes instead of " + std::to_string(bytes);
}

cv::Mat V4l2Source::view(const v4l2_buffer& filled) const
{
  void* start = buffers_[filled.index].start;
  const V4l2Format& format = *findV4l2Format(format_.pixelformat);
  if (format.row_bytes_per_px == 0) return {1, static_cast<int>(filled.bytesused), CV_8UC1, start};
  const int type = format.row_bytes_per_px == 2 ? CV_8UC2 : CV_8UC1;
  return {rows(), static_cast<int>(format_.width), type, start, rowStep()};
}

std::string V4l2Source::description() const
{
  return describeFormat(format_.pixelformat, format_.width, format_.height) + " at " + toText(rate_) + " Hz from " +
         device_.path();
}

}  // namespace robot_vision
