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
#include "robot_vision/camera/open_source.hpp"

namespace robot_vision
{

/// Parameters that ask a camera for this format.
inline CaptureParams withFormat(const std::string& pixel_format, int width, int height, double framerate = 0.0)
{
  CaptureParams params;
  params.pixel_format = pixel_format;
  params.image_width = width;
  params.image_height = height;
  params.framerate = framerate;
  return params;
}

/// A fake camera whose formats and faults a test chooses; plug() opens it. It answers as drivers do, but follows no
/// clock: it gives a frame whenever one is waited for and a buffer is queued.
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
    v4l2_frmsize_stepwise range{};  // further sizes, with the rates of the first of `sizes`; none if max_width is 0
  };

  struct Control
  {
    std::uint32_t id;
    std::uint32_t type;  // V4L2_CTRL_TYPE_...
    std::string title;   // the kernel's name, such as "Exposure, Auto"
    std::int64_t minimum, maximum;
    std::int64_t value;
    std::vector<std::pair<std::int64_t, std::string>> items =
        {};  // number and text (or value as text) of a menu's items
    std::uint32_t flags = 0;
    std::function<bool(const FakeCamera&)> inactive = nullptr;
    std::string text = "";
    std::int64_t default_value = value;
    int query_error = 0;  // the errno with which the driver fails to describe it
  };

  using FrameBytes = std::function<std::vector<unsigned char>(const v4l2_pix_format& format, unsigned number)>;

  // The properties of the camera.
  std::string card = "Fake Camera";
  std::string bus = "usb-0000:00:14.0-1";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<Format> formats = {{V4L2_PIX_FMT_YUYV, 16, {{640, 480, {30.0, 15.0}}, {320, 240, {60.0}}}}};
  std::uint32_t field = V4L2_FIELD_NONE;
  bool enumerates = true;         // whether it lists the formats that it offers
  unsigned row_padding = 0;       // bytes, of the first plane
  std::vector<Control> controls;  // in the order of their ids
  FrameBytes frame_bytes;         // makes the bytes of a frame; if null, all bytes are the frame's number

  // Its state and the faults to come.
  bool plugged = true;
  bool exclusive = false;         // it cannot be opened twice at a time
  bool repeats_controls = false;  // it begins again after the last one
  bool stalled = false;
  unsigned waiting = 0;                             // the number of frames that are there before they are waited for
  std::chrono::milliseconds frame_time{0};          // how long a frame takes
  std::map<unsigned long, std::deque<int>> faults;  // request -> the errnos of its next calls, 0 for success
  unsigned damaged = 0;                             // the number of next frames that are marked as damaged
  unsigned first_sequence = 0;                      // number of the first frame of a stream
  unsigned lost = 0;                                // the number of frames that are lost before the next one
  std::int64_t stamp_ns = 0;                        // stamp of the next frame on CLOCK_MONOTONIC; 0 for now

  // What has been done to it.
  v4l2_pix_format format{};
  v4l2_fract period{};
  bool streaming = false;
  unsigned sequence = 0;
  std::vector<std::uint32_t> controls_set;  // in the order in which they were set
  std::map<unsigned long, int> calls;       // request -> how often it was called
  int open_devices = 0;                     // now
  int openings = 0;                         // in total
  int maps = 0;

  bool hasControl(std::uint32_t id) const;
  Control& control(std::uint32_t id);
  const Control& control(std::uint32_t id) const { return const_cast<FakeCamera*>(this)->control(id); }
  /// Unplugs it and plugs it in again, with the default values of its controls.
  void replug();

  /// Opens it.
  std::unique_ptr<V4l2Device> plug(const std::string& path = "/dev/video0");
};

}  // namespace robot_vision
