#pragma once

#include <linux/videodev2.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/camera/v4l2_device.hpp"

namespace robot_vision
{

/// The calls that streaming takes, and their names.
inline const std::vector<std::pair<unsigned long, std::string>> kStreamingCalls = {
    {VIDIOC_REQBUFS, "VIDIOC_REQBUFS"},   {VIDIOC_QUERYBUF, "VIDIOC_QUERYBUF"}, {VIDIOC_QBUF, "VIDIOC_QBUF"},
    {VIDIOC_STREAMON, "VIDIOC_STREAMON"}, {VIDIOC_DQBUF, "VIDIOC_DQBUF"},
};

/// A camera with the formats and faults of a test's choice; plug() opens it. It answers as drivers do, follows no clock
/// and gives a frame whenever one is waited for and a buffer is queued.
struct FakeCamera
{
  struct Size
  {
    unsigned width, height;
    std::vector<double> rates;  // Hz
  };
  struct Format
  {
    std::uint32_t fourcc;
    unsigned bits_per_px;
    std::vector<Size> sizes;
    v4l2_frmsize_stepwise range{};  // all sizes in it, at the rates of the first of `sizes`; max_width 0: none
  };

  struct Control
  {
    std::uint32_t id;
    std::uint32_t type;  // V4L2_CTRL_TYPE_...
    std::string title;   // as the kernel has it: "Exposure, Auto"
    std::int64_t minimum, maximum;
    std::int64_t value;
    std::vector<std::pair<std::int64_t, std::string>> items = {};  // of a menu: number and text, or text of the value
    std::uint32_t flags = 0;
    std::function<bool(const FakeCamera&)> inactive = nullptr;
    std::string text = "";
    std::int64_t default_value = value;
    int query_error = 0;  // the errno with which the driver fails to describe it
  };

  using Picture = std::function<std::vector<unsigned char>(const v4l2_pix_format& format, unsigned number)>;

  // What it is.
  std::string card = "Fake Camera";
  std::string bus = "usb-0000:00:14.0-1";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<Format> formats = {{V4L2_PIX_FMT_YUYV, 16, {{640, 480, {30.0, 15.0}}, {320, 240, {60.0}}}}};
  std::uint32_t field = V4L2_FIELD_NONE;
  bool enumerates = true;         // it says what formats it offers
  unsigned row_padding = 0;       // bytes, of the first plane
  std::vector<Control> controls;  // in the order of their ids
  Picture picture;                // the bytes of a frame; null: all bytes are its number

  // What happens.
  bool plugged = true;
  bool exclusive = false;  // it can be open once only
  bool stalled = false;
  std::chrono::milliseconds frame_time{0};          // that a frame takes
  std::map<unsigned long, std::deque<int>> faults;  // request -> the errnos of its next calls, 0: it works
  unsigned damaged = 0;                             // frames to come that are marked as damaged
  unsigned first_sequence = 0;                      // number of the first frame of a stream
  unsigned lost = 0;                                // frames that are lost before the next
  std::int64_t stamp_ns = 0;                        // of the next frame, on CLOCK_MONOTONIC; 0: now

  // What is seen of it.
  v4l2_pix_format format{};
  v4l2_fract period{};
  bool streaming = false;
  unsigned sequence = 0;
  std::vector<std::uint32_t> controls_set;  // in the order in which they were set
  std::map<unsigned long, int> calls;       // how often each has been asked
  int open_devices = 0;
  int openings = 0;  // until now
  int maps = 0;

  bool hasControl(std::uint32_t id) const;
  Control& control(std::uint32_t id);
  const Control& control(std::uint32_t id) const { return const_cast<FakeCamera*>(this)->control(id); }
  /// Takes it away and puts it back as it came from the shop.
  void replug();

  /// One opening of it.
  std::unique_ptr<V4l2Device> plug(const std::string& path = "/dev/video0");
};

}  // namespace robot_vision
