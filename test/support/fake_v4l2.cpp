#include "fake_v4l2.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "core/camera/v4l2_formats.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/common/monotonic.hpp"

namespace robot_vision
{
namespace
{

template <class Text>
void write(Text& field, const std::string& text)
{
  std::strncpy(reinterpret_cast<char*>(field), text.c_str(), sizeof(field) - 1);
}

class FakeDevice : public V4l2Device
{
public:
  FakeDevice(const std::string& path, FakeCamera& camera) : V4l2Device(path), camera_(camera)
  {
    ++camera_.open_devices;
    ++camera_.openings;
    set(camera_.formats.front(), camera_.formats.front().sizes.front());
  }

  ~FakeDevice() override
  {
    --camera_.open_devices;
    camera_.streaming = false;
  }

  int tryCall(unsigned long request, void* argument) override
  {
    ++camera_.calls[request];
    if (!camera_.plugged) return ENODEV;
    std::deque<int>& faults = camera_.faults[request];
    if (!faults.empty())
    {
      const int error = faults.front();
      faults.pop_front();
      if (error != 0) return error;
    }
    return answer(request, argument);
  }

  bool waitReadable(int milliseconds) override
  {
    if (!camera_.plugged) return true;  // for a lost device poll() returns POLLERR | POLLHUP
    if (milliseconds == 0) return hasFrame() && camera_.waiting > 0;
    const auto wait = std::chrono::milliseconds(milliseconds);
    const auto until_frame = hasFrame() ? next_frame_ - Clock::now() : Clock::duration(wait);
    if (until_frame > Clock::duration::zero())
      std::this_thread::sleep_for(std::min<Clock::duration>(wait, until_frame));
    return hasFrame() && until_frame < wait;
  }

  void* map(std::size_t length, std::uint32_t offset) override
  {
    if (!camera_.plugged) fail("mmap", ENODEV);
    if (offset >= buffers_.size() || length > buffers_[offset].size()) fail("mmap", EINVAL);
    ++camera_.maps;
    return buffers_[offset].data();
  }

  void unmap(void*, std::size_t) override { --camera_.maps; }

private:
  using Clock = std::chrono::steady_clock;

  bool hasFrame() const { return camera_.streaming && !camera_.stalled && !queued_.empty(); }

  int answer(unsigned long request, void* argument)
  {
    switch (request)
    {
      case VIDIOC_QUERYCAP:
        return capability(*static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT:
        return describe(*static_cast<v4l2_fmtdesc*>(argument));
      case VIDIOC_ENUM_FRAMESIZES:
        return size(*static_cast<v4l2_frmsizeenum*>(argument));
      case VIDIOC_ENUM_FRAMEINTERVALS:
        return interval(*static_cast<v4l2_frmivalenum*>(argument));
      case VIDIOC_G_FMT:
        static_cast<v4l2_format*>(argument)->fmt.pix = camera_.format;
        return 0;
      case VIDIOC_S_FMT:
        return setFormat(static_cast<v4l2_format*>(argument)->fmt.pix);
      case VIDIOC_G_PARM:
        return parameters(*static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_S_PARM:
        return setParameters(*static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_REQBUFS:
        return requestBuffers(*static_cast<v4l2_requestbuffers*>(argument));
      case VIDIOC_QUERYBUF:
        return queryBuffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_QBUF:
        return queueBuffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_DQBUF:
        return dequeueBuffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
      case VIDIOC_STREAMOFF:
        camera_.streaming = request == VIDIOC_STREAMON;
        next_frame_ = Clock::now() + camera_.frame_time;
        return 0;
      case VIDIOC_QUERY_EXT_CTRL:
        return queryControl(*static_cast<v4l2_query_ext_ctrl*>(argument));
      case VIDIOC_QUERYMENU:
        return queryItem(*static_cast<v4l2_querymenu*>(argument));
      case VIDIOC_G_EXT_CTRLS:
        return getControl(*static_cast<v4l2_ext_controls*>(argument)->controls);
      case VIDIOC_S_EXT_CTRLS:
        return setControl(*static_cast<v4l2_ext_controls*>(argument)->controls);
      default:
        return ENOTTY;
    }
  }

  int capability(v4l2_capability& answer) const
  {
    write(answer.driver, "fake");
    write(answer.card, camera_.card);
    write(answer.bus_info, camera_.bus);
    answer.capabilities = camera_.capabilities | V4L2_CAP_DEVICE_CAPS;
    answer.device_caps = camera_.capabilities;
    return 0;
  }

  int describe(v4l2_fmtdesc& answer) const
  {
    if (!camera_.enumerates) return ENOTTY;
    if (answer.index >= camera_.formats.size()) return EINVAL;
    answer.pixelformat = camera_.formats[answer.index].fourcc;
    return 0;
  }

  const FakeCamera::Format* find(std::uint32_t fourcc) const
  {
    const auto same = [fourcc](const FakeCamera::Format& format) { return format.fourcc == fourcc; };
    const auto found = std::find_if(camera_.formats.begin(), camera_.formats.end(), same);
    return found == camera_.formats.end() ? nullptr : &*found;
  }

  int size(v4l2_frmsizeenum& answer) const
  {
    const FakeCamera::Format* format = find(answer.pixel_format);
    if (format == nullptr || !camera_.enumerates) return EINVAL;
    if (format->range.max_width > 0)
    {
      answer.type = V4L2_FRMSIZE_TYPE_STEPWISE;
      answer.stepwise = format->range;
      return answer.index == 0 ? 0 : EINVAL;
    }
    if (answer.index >= format->sizes.size()) return EINVAL;
    answer.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    answer.discrete = {format->sizes[answer.index].width, format->sizes[answer.index].height};
    return 0;
  }

  int interval(v4l2_frmivalenum& answer) const
  {
    const FakeCamera::Format* format = find(answer.pixel_format);
    if (format == nullptr || !camera_.enumerates) return EINVAL;
    for (const FakeCamera::Size& size : format->sizes)
    {
      if (size.width != answer.width || size.height != answer.height || answer.index >= size.rates.size()) continue;
      answer.type = V4L2_FRMIVAL_TYPE_DISCRETE;
      answer.discrete = periodOf(size.rates[answer.index]);
      return 0;
    }
    return EINVAL;
  }

  /// Changes a format that the driver does not have: to the nearest size, and to the present pixel format.
  int setFormat(v4l2_pix_format& asked)
  {
    if (!buffers_.empty()) return EBUSY;
    const FakeCamera::Format* format = find(asked.pixelformat);
    if (format == nullptr) format = find(camera_.format.pixelformat);
    const auto distance = [&asked](const FakeCamera::Size& size)
    {
      return std::abs(static_cast<int>(size.width) - static_cast<int>(asked.width)) +
             std::abs(static_cast<int>(size.height) - static_cast<int>(asked.height));
    };
    const auto nearer = [&distance](const FakeCamera::Size& a, const FakeCamera::Size& b)
    { return distance(a) < distance(b); };
    FakeCamera::Size size = *std::min_element(format->sizes.begin(), format->sizes.end(), nearer);
    if (format->range.max_width > 0)
    {
      const v4l2_frmsize_stepwise& range = format->range;
      size.width = std::clamp(asked.width / range.step_width * range.step_width, range.min_width, range.max_width);
      size.height =
          std::clamp(asked.height / range.step_height * range.step_height, range.min_height, range.max_height);
    }
    set(*format, size);
    asked = camera_.format;
    return 0;
  }

  void set(const FakeCamera::Format& format, const FakeCamera::Size& size)
  {
    camera_.format = {};
    camera_.format.width = size.width;
    camera_.format.height = size.height;
    camera_.format.pixelformat = format.fourcc;
    camera_.format.field = camera_.field;
    const bool planar = format.bits_per_px == 12;
    camera_.format.bytesperline = size.width * (planar ? 8 : format.bits_per_px) / 8 + camera_.row_padding;
    camera_.format.sizeimage = camera_.format.bytesperline * size.height * (planar ? 3 : 2) / 2;
    camera_.period = periodOf(size.rates.front());
    rates_ = size.rates;
  }

  int parameters(v4l2_streamparm& answer) const
  {
    answer.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    answer.parm.capture.timeperframe = camera_.period;
    return 0;
  }

  int setParameters(v4l2_streamparm& asked)
  {
    const v4l2_fract& period = asked.parm.capture.timeperframe;
    const double rate = static_cast<double>(period.denominator) / period.numerator;
    const auto nearer = [rate](double a, double b) { return std::abs(a - rate) < std::abs(b - rate); };
    camera_.period = periodOf(*std::min_element(rates_.begin(), rates_.end(), nearer));
    return parameters(asked);
  }

  int requestBuffers(v4l2_requestbuffers& asked)
  {
    buffers_.assign(asked.count, std::vector<unsigned char>(camera_.format.sizeimage));
    queued_.clear();
    camera_.sequence = camera_.first_sequence;
    return 0;
  }

  int queryBuffer(v4l2_buffer& answer)
  {
    if (answer.index >= buffers_.size()) return EINVAL;
    answer.length = camera_.format.sizeimage;
    answer.m.offset = answer.index;
    const auto queued = std::find(queued_.begin(), queued_.end(), answer.index);
    if (queued != queued_.end())
      answer.flags = queued - queued_.begin() < camera_.waiting ? V4L2_BUF_FLAG_DONE : V4L2_BUF_FLAG_QUEUED;
    return 0;
  }

  int queueBuffer(const v4l2_buffer& buffer)
  {
    if (buffer.index >= buffers_.size()) return EINVAL;
    queued_.push_back(buffer.index);
    return 0;
  }

  int dequeueBuffer(v4l2_buffer& answer)
  {
    if (!hasFrame()) return EAGAIN;
    camera_.sequence += camera_.lost;
    camera_.lost = 0;
    if (camera_.waiting > 0) --camera_.waiting;
    next_frame_ = Clock::now() + camera_.frame_time;
    answer.index = queued_.front();
    queued_.pop_front();
    answer.sequence = camera_.sequence++;
    answer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    if (camera_.damaged > 0)
    {
      --camera_.damaged;
      answer.flags |= V4L2_BUF_FLAG_ERROR;
    }
    const std::int64_t stamp_ns = camera_.stamp_ns != 0 ? camera_.stamp_ns : monotonicNow();
    answer.timestamp = {stamp_ns / 1000000000LL, stamp_ns % 1000000000LL / 1000};
    answer.bytesused = fill(buffers_[answer.index], answer.sequence);
    return 0;
  }

  std::uint32_t fill(std::vector<unsigned char>& buffer, unsigned number) const
  {
    if (!camera_.frame_bytes)
    {
      std::fill(buffer.begin(), buffer.end(), static_cast<unsigned char>(number));
      return static_cast<std::uint32_t>(buffer.size());
    }
    const std::vector<unsigned char> bytes = camera_.frame_bytes(camera_.format, number);
    const std::size_t size = std::min(bytes.size(), buffer.size());
    std::copy_n(bytes.begin(), size, buffer.begin());
    return static_cast<std::uint32_t>(size);
  }

  int queryControl(v4l2_query_ext_ctrl& answer) const
  {
    const bool next = (answer.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    const std::uint32_t id = answer.id & V4L2_CTRL_ID_MASK;
    for (const FakeCamera::Control& control : camera_.controls)
    {
      if (next ? control.id <= id : control.id != id) continue;
      if (control.query_error != 0) return control.query_error;
      return tell(control, answer);
    }
    return next && camera_.repeats_controls ? tell(camera_.controls.front(), answer) : EINVAL;
  }

  int tell(const FakeCamera::Control& control, v4l2_query_ext_ctrl& answer) const
  {
    answer = {};
    answer.id = control.id;
    answer.type = control.type;
    write(answer.name, control.title);
    answer.minimum = control.minimum;
    answer.maximum = control.maximum;
    answer.step = 1;
    answer.default_value = control.default_value;
    answer.elem_size = control.type == V4L2_CTRL_TYPE_STRING ? static_cast<std::uint32_t>(control.maximum) + 1 : 4;
    answer.flags = control.flags;
    if (control.inactive && control.inactive(camera_)) answer.flags |= V4L2_CTRL_FLAG_INACTIVE;
    return 0;
  }

  int queryItem(v4l2_querymenu& answer) const
  {
    const FakeCamera::Control& control = camera_.control(answer.id);
    for (const auto& [number, text] : control.items)
    {
      if (number != answer.index) continue;
      if (control.type == V4L2_CTRL_TYPE_MENU)
        std::strncpy(reinterpret_cast<char*>(answer.name), text.c_str(), sizeof(answer.name) - 1);
      else
        answer.value = std::stoll(text);
      return 0;
    }
    return EINVAL;
  }

  int getControl(v4l2_ext_control& answer) const
  {
    if (!camera_.hasControl(answer.id)) return EINVAL;
    const FakeCamera::Control& control = camera_.control(answer.id);
    if ((control.flags & V4L2_CTRL_FLAG_WRITE_ONLY) != 0) return EACCES;
    if (control.type == V4L2_CTRL_TYPE_STRING)
      std::strncpy(answer.string, control.text.c_str(), answer.size);
    else if (control.type == V4L2_CTRL_TYPE_INTEGER64)
      answer.value64 = control.value;
    else
      answer.value = static_cast<std::int32_t>(control.value);
    return 0;
  }

  int setControl(const v4l2_ext_control& asked)
  {
    camera_.controls_set.push_back(asked.id);
    FakeCamera::Control& control = camera_.control(asked.id);
    if ((control.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0) return EACCES;
    if (control.type == V4L2_CTRL_TYPE_STRING)
      control.text = asked.string;
    else
      control.value = control.type == V4L2_CTRL_TYPE_INTEGER64 ? asked.value64 : asked.value;
    return 0;
  }

  FakeCamera& camera_;
  std::vector<double> rates_;  // Hz, those of the present size
  std::vector<std::vector<unsigned char>> buffers_;
  std::deque<unsigned> queued_;
  Clock::time_point next_frame_;
};

}  // namespace

bool FakeCamera::hasControl(std::uint32_t id) const
{
  return std::any_of(controls.begin(), controls.end(), [id](const Control& control) { return control.id == id; });
}

FakeCamera::Control& FakeCamera::control(std::uint32_t id)
{
  return *std::find_if(controls.begin(), controls.end(), [id](const Control& control) { return control.id == id; });
}

void FakeCamera::replug()
{
  plugged = true;
  for (Control& control : controls)
    control.value = control.default_value;
}

std::unique_ptr<V4l2Device> FakeCamera::plug(const std::string& path)
{
  if (!plugged) throw SourceUnavailable(path + ": cannot be opened: No such device");
  if (exclusive && open_devices > 0) throw SourceUnavailable(path + ": cannot be opened: Device or resource busy");
  return std::make_unique<FakeDevice>(path, *this);
}

}  // namespace robot_vision
