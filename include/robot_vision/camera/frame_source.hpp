#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/scene/scene.hpp"

namespace robot_vision
{

class V4l2Device;

/// What a source cannot do now and never will: a wrong path, a damaged file.
class SourceError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// What a source cannot do now but may be able to do later: a device that is not plugged in, a server that is down.
class SourceUnavailable : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

enum class SourceKind
{
  kSynthetic,
  kDevice,
  kUrl,
  kPictures,
  kVideo,
};

constexpr double kDefaultRate = 30.0;  // Hz, of a source with no rate of its own

struct CaptureParams
{
  std::string source;
  std::optional<SourceKind> kind;  // of the source, as sourceKind() told it; none: decided at each opening
  std::string video_device = "/dev/video0";
  int image_width = 640;
  int image_height = 480;
  std::string pixel_format = "yuyv";
  std::string io_method = "mmap";
  double framerate = 0.0;
  double timeout = 3.0;
  std::string scene = "room";
  std::string poster;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("source", &CaptureParams::source, Anything{}, "",
          "synthetic, or a camera, video, URL, image or folder of images; empty: video_device");
    visit("video_device", &CaptureParams::video_device, Anything{}, "",
          "a V4L2 camera: path, card, bus or serial number");
    visit("image_width", &CaptureParams::image_width, Range{16, 8192}, "px",
          "of a device, or of the scene: 64 to 4096; files keep their own size");
    visit("image_height", &CaptureParams::image_height, Range{16, 8192}, "px",
          "of a device, or of the scene: 64 to 4096, a third to three times the width");
    visit("pixel_format", &CaptureParams::pixel_format,
          OneOf{"yuyv, uyvy, nv12, nv21, yu12, bgr24, rgb24, mjpeg, bayer_rggb8, bayer_bggr8, bayer_gbrg8, "
                "bayer_grbg8, h264, grey, y16, y10, yuv or yuvmono10",
                "'"},
          "",
          "asked of a device; what comes nearest is taken, with a warning. yuvmono10: 10 bits that the camera calls "
          "YUYV");
    visit("io_method", &CaptureParams::io_method, OneOf{"mmap, read or userptr", "'"}, "",
          "for usb_cam's launch files; always mmap");
    visit("framerate", &CaptureParams::framerate, Range{0, 1000}, "Hz",
          "frames per second; 0: a video's own rate, 30 for all else");
    visit("timeout", &CaptureParams::timeout, Range{0.1, 3600}, "s",
          "a device or stream that gives no good frame for so long is opened anew; cameras slower than that have "
          "three of their periods or exposures, to 30 s, and a stream has 30 s to its next keyframe");
    visit("scene", &CaptureParams::scene, OneOf{"room or calibration", "'"}, "",
          "what synthetic shows: the room, or a checkerboard in many poses");
    visit("poster", &CaptureParams::poster, Anything{}, "",
          "image file on the wall of the scene; empty or pattern: a pattern; auto: the portrait of python3-skimage "
          "if that is installed, else the pattern");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const CaptureParams& params);

/// The source that is meant, a file without its file://.
std::string sourceName(const CaptureParams& params);

/// What the source is, or would be if it were there: `params.kind`, or else what its name looks like and leads to now.
/// Who keeps it stays with it whatever becomes of the path: a camera's may end in nothing while it is unplugged.
SourceKind sourceKind(const CaptureParams& params);

/// True for a device or URL: what is not there now may be there later.
bool mayComeLater(SourceKind kind);

/// The rate in Hz that `params` ask of a source with no rate of its own.
double wantedRate(const CaptureParams& params);

/// One captured picture.
struct Frame
{
  cv::Mat image;                            // see encoding.hpp; valid until the source's next read() or its end
  std::string encoding;                     // see encoding.hpp
  std::int64_t sequence = 0;                // counts from 0; a gap is lost frames
  std::int64_t monotonic_ns = 0;            // time of capture on CLOCK_MONOTONIC; 0: the source knows none
  std::shared_ptr<const SceneTruth> truth;  // of a synthetic frame, else null
};

enum class ReadResult
{
  kFrame,
  kTimeout,    // nothing came within the wait; try again
  kNoPicture,  // what came makes no picture yet, of a stream whose next keyframe is still to come; try again
  kEnd,        // there is nothing more to come
};

/// Where frames come from. Not thread-safe; one thread reads.
class FrameSource
{
public:
  virtual ~FrameSource() = default;

  /// Takes the next frame. `frame.image` may come with memory that the source is free to fill or to replace by its own.
  /// Waits at most about 0.1 s. Throws std::invalid_argument for a damaged frame (the next may be good), SourceError or
  /// SourceUnavailable when no more frames can come. A device streams from its first read to its end.
  virtual ReadResult read(Frame& frame) = 0;

  /// Makes the next read() give the first frame again; devices and live streams have no beginning and ignore it.
  virtual void rewind() {}

  /// Frames per second that the reader has to keep; 0 if the source is live, and read() waits for the next frame.
  virtual double rate() const = 0;

  /// Seconds from a frame of a live source to the next, as far as it is known; 0: it is not.
  virtual double period() const { return 0.0; }

  /// False if its pictures lie in memory of its own, whatever read() is given.
  virtual bool fillsMemory() const { return true; }

  /// The open device that the frames come from; null: they come from none.
  virtual std::shared_ptr<V4l2Device> device() const { return nullptr; }

  /// What it is, for a log line: "YUYV 640x480 at 30 Hz from /dev/video0".
  virtual std::string description() const = 0;

  /// In what it differs from what was asked for; empty if it does not.
  virtual std::string warning() const { return {}; }

  /// The geometry of the camera if the source knows it, else null.
  virtual const CameraModel* cameraModel() const { return nullptr; }
};

/// Opens the source that `params` name. Throws std::invalid_argument for a parameter out of range, SourceError for a
/// source that is wrong and SourceUnavailable for one that may come; each names the source.
std::unique_ptr<FrameSource> openSource(const CaptureParams& params);

}  // namespace robot_vision
