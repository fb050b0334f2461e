#include "v4l2_source.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "control_io.hpp"
#include "robot_vision/common/monotonic.hpp"
#include "v4l2_formats.hpp"
#include "v4l2_image.hpp"

namespace robot_vision
{
namespace
{

constexpr int kPollTimeoutMs = 100;
constexpr unsigned kBufferCount = 5;  // the reader's, three that wait, and the one to be filled

/// The time of capture on the monotonic clock. It is the driver's time stamp, or the time of arrival if the driver uses
/// another clock. It is never later than the arrival: some drivers deliver a frame before the time in its stamp.
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

/// Whether frames before this one were lost, if its number was to be `expected`. The driver's counter wraps, and a busy
/// driver may use a number twice.
bool isAfterLoss(const v4l2_buffer& filled, std::uint32_t expected)
{
  return static_cast<std::int32_t>(filled.sequence - expected) > 0;
}

}  // namespace

V4l2Source::V4l2Source(std::shared_ptr<V4l2Device> device, const CaptureParams& params, const std::string& warning)
  : device_(std::move(device)), warning_(warning)
{
  requireCapture();
  mode_ = negotiateFormat(*device_, params);
  if (!mode_.warning.empty()) warning_ += (warning_.empty() ? "" : "; ") + device_->path() + ": " + mode_.warning;
  if (mode_.format->fourcc == V4L2_PIX_FMT_H264) decoder_ = makeH264Decoder();
}

V4l2Source::~V4l2Source()
{
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (streaming_) device_->tryCall(VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_)
    device_->unmap(buffer.start, buffer.length);
}

void V4l2Source::requireCapture()
{
  const std::uint32_t capabilities = queryCapability(*device_).capabilities;
  if ((capabilities & V4L2_CAP_VIDEO_CAPTURE) == 0 || (capabilities & V4L2_CAP_STREAMING) == 0)
    throw SourceUnavailable(device_->path() + ": not a device that streams video (it lacks the capability " +
                            "VIDEO_CAPTURE or STREAMING)");
}

void V4l2Source::start()
{
  mapBuffers();
  for (unsigned i = 0; i < buffers_.size(); ++i)
    queue(i);
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_->call(VIDIOC_STREAMON, &type, "VIDIOC_STREAMON");
  streaming_ = true;
  first_sequence_ = -1;
  behind_ = false;
}

void V4l2Source::mapBuffers()
{
  v4l2_requestbuffers request{};
  request.count = kBufferCount;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  device_->call(VIDIOC_REQBUFS, &request, "VIDIOC_REQBUFS");
  if (request.count == 0) device_->fail("VIDIOC_REQBUFS", ENOMEM);
  for (unsigned i = 0; i < request.count; ++i)
  {
    v4l2_buffer buffer = captureBuffer(i);
    device_->call(VIDIOC_QUERYBUF, &buffer, "VIDIOC_QUERYBUF");
    buffers_.push_back({device_->map(buffer.length, buffer.m.offset), buffer.length});
  }
}

void V4l2Source::queue(unsigned index)
{
  v4l2_buffer buffer = captureBuffer(index);
  device_->call(VIDIOC_QBUF, &buffer, "VIDIOC_QBUF");
}

ReadResult V4l2Source::read(Frame& frame)
{
  if (!streaming_) start();
  behind_ = behind_ || !canFill();
  giveBack();
  if (!device_->waitReadable(0))
  {
    behind_ = false;
    if (!device_->waitReadable(kPollTimeoutMs)) return ReadResult::kTimeout;
  }
  v4l2_buffer filled;
  if (!dequeueNewest(filled)) return ReadResult::kTimeout;
  if (!take(filled, frame)) return ReadResult::kNoImage;
  if (first_sequence_ < 0) first_sequence_ = filled.sequence;
  frame.encoding = mode_.format->encoding;
  frame.sequence = static_cast<std::uint32_t>(filled.sequence - first_sequence_);  // the driver's counter wraps
  frame.monotonic_ns = monotonicStamp(filled);
  return ReadResult::kFrame;
}

/// Whether the driver has a buffer for the next frame. If not, the frame is lost, and not all drivers number those.
bool V4l2Source::canFill()
{
  for (unsigned i = 0; i < buffers_.size(); ++i)
  {
    v4l2_buffer buffer = captureBuffer(i);
    const bool known = device_->tryCall(VIDIOC_QUERYBUF, &buffer) == 0;
    if (!known || (static_cast<int>(i) != held_ && (buffer.flags & V4L2_BUF_FLAG_DONE) == 0)) return true;
  }
  return false;
}

/// Gives the buffer of the last frame back to the driver.
void V4l2Source::giveBack()
{
  if (held_ < 0) return;
  const int index = held_;
  held_ = -1;
  queue(static_cast<unsigned>(index));
}

/// Takes the oldest filled buffer from the driver; returns false if there is none after all.
bool V4l2Source::dequeue(v4l2_buffer& filled)
{
  filled = captureBuffer();
  const int error = device_->tryCall(VIDIOC_DQBUF, &filled);
  if (error == EAGAIN) return false;
  if (error != 0) device_->fail("VIDIOC_DQBUF", error);
  if (filled.index >= buffers_.size()) device_->fail("VIDIOC_DQBUF", ERANGE);
  filled.bytesused = static_cast<std::uint32_t>(std::min<std::size_t>(filled.bytesused, buffers_[filled.index].length));
  held_ = static_cast<int>(filled.index);
  return true;
}

/// Takes the oldest filled buffer, so that a short delay loses no frame, but the newest one while the reader is slower
/// than the camera: frames are lost then in any case, and the oldest would always be as old as the queue is long. A
/// decoder needs all frames.
bool V4l2Source::dequeueNewest(v4l2_buffer& filled)
{
  if (!dequeue(filled)) return false;
  if (first_sequence_ >= 0 && isAfterLoss(filled, next_sequence_)) behind_ = true;
  for (std::size_t i = 1; behind_ && !decoder_ && i < buffers_.size() && device_->waitReadable(0); ++i)
  {
    if ((filled.flags & V4L2_BUF_FLAG_ERROR) != 0) break;  // damage is told
    giveBack();
    if (!dequeue(filled)) return false;
  }
  next_sequence_ = filled.sequence + 1;
  return true;
}

/// Makes the frame's image from a filled buffer; returns false if the decoder has no image yet.
bool V4l2Source::take(const v4l2_buffer& filled, Frame& frame)
{
  if (const std::string damage = damageText(filled, mode_); !damage.empty()) refuse(filled, " " + damage);
  frame.image = imageIn(buffers_[filled.index].start, filled.bytesused, mode_, own_image_);
  if (!decoder_) return true;
  if (isAfterLoss(filled, next_decoded_)) decoder_->restart();
  next_decoded_ = filled.sequence + 1;
  try
  {
    if (decoder_->decode(frame.image, own_image_))
    {
      frame.image = own_image_;
      return true;
    }
  }
  catch (const std::invalid_argument& e)
  {
    refuse(filled, std::string(": ") + e.what());
  }
  return false;
}

/// Throws for a damaged frame. Its number is taken out of the sequence, so that it does not count as lost as well.
/// Frames skipped while waiting for a keyframe do count as lost.
void V4l2Source::refuse(const v4l2_buffer& filled, const std::string& reason)
{
  if (first_sequence_ >= 0) ++first_sequence_;
  throw std::invalid_argument(device_->path() + ": frame " + std::to_string(filled.sequence) + reason);
}

/// The exposure time is a lower limit, whatever rate the driver tells.
double V4l2Source::period() const
{
  return std::max(mode_.rate > 0.0 ? 1.0 / mode_.rate : 0.0, exposureTime(*device_));
}

std::string V4l2Source::description() const
{
  const std::string rate = mode_.rate > 0.0 ? " at " + rateText(mode_.rate) + " Hz" : "";
  return describe(mode_) + rate + " from " + device_->path();
}

}  // namespace robot_vision
