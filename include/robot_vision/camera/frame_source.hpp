#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <stdexcept>
#include <string>

#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/scene/scene.hpp"

namespace robot_vision
{

class V4l2Device;

/// An error that waiting does not mend, such as a wrong path or a damaged file.
class SourceError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// An error that may go away later, such as a device that is not plugged in or a server that is down.
class SourceUnavailable : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

constexpr double kDefaultRate = 30.0;  // Hz, for a source that has no rate of its own

/// Which images of a frame with two views are to be made.
struct WantedViews
{
  bool first = true;
  bool second = true;
};

/// What one moment looked like: one image, or two of a source with two views.
struct Frame
{
  WantedViews wanted;                       // set before read(); a source with one view makes its image all the same
  cv::Mat image;                            // see encoding.hpp; valid until the source's next read() or its end
  std::string encoding;                     // see encoding.hpp
  EncodedImage second;                      // of a pair the right one, beside color the depth; valid as `image` is
  std::int64_t sequence = 0;                // counts from 0; gaps are lost frames
  std::int64_t monotonic_ns = 0;            // time of capture on CLOCK_MONOTONIC; 0 if the source does not know it
  std::shared_ptr<const SceneTruth> truth;  // the ground truth of a synthetic frame, else null
};

/// The camera that a source's second images are of.
struct SecondCamera
{
  CameraModel model;
  cv::Affine3d pose;  // its optical frame in that of the first camera, m
};

/// What the cameras of a device are built into.
struct Housing
{
  cv::Affine3d first_camera;  // the first camera's optical frame in the housing's frame (x forward, y left, z up), m
};

enum class ReadResult
{
  kFrame,
  kTimeout,  // no data came in time; try again
  kNoImage,  // data came, but no image: the stream's next keyframe is still to come; try again
  kEnd,      // there are no more frames
};

/// A source of frames. It is not thread-safe: only one thread may read.
class FrameSource
{
public:
  virtual ~FrameSource() = default;

  /// Gets the next frame. Its images may come with memory that the source may fill or replace by its own. Waits at most
  /// about 0.1 s, or for data by a URL as long as FFmpeg does. Throws std::invalid_argument for a damaged frame (the
  /// next may be good), and SourceError or SourceUnavailable if no more frames can come. A device streams from the
  /// first read() until the source is destroyed.
  virtual ReadResult read(Frame& frame) = 0;

  /// Makes the next read() give the first frame again. Devices and live streams, which have no beginning, ignore it.
  virtual void rewind() {}

  /// Frames per second at which the caller has to read; 0 if the source is live, so that read() waits for the next
  /// frame.
  virtual double rate() const = 0;

  /// Takes another rate to be read at (Hz), and goes on where it is. Returns false if it cannot: most sources have
  /// their own rate, and a device takes it when it is opened.
  virtual bool setRate(double /*rate*/) { return false; }

  /// Seconds from one frame of a live source to the next; 0 if unknown.
  virtual double period() const { return 0.0; }

  /// False if read() never fills the memory that it is given, because the images lie in memory of the source.
  virtual bool fillsMemory() const { return true; }

  /// The open device from which the frames come, or null if they do not come from a device.
  virtual std::shared_ptr<V4l2Device> device() const { return nullptr; }

  /// A description for a log line, such as "YUYV 640x480 at 30 Hz from /dev/video0".
  virtual std::string description() const = 0;

  /// Says how the source differs from what was asked for; empty if it does not.
  virtual std::string warning() const { return {}; }

  /// The geometry of the camera if the source knows it, else null.
  virtual const CameraModel* cameraModel() const { return nullptr; }

  /// The camera of the second images; null if there are none, or if the source does not know it.
  virtual const SecondCamera* secondCamera() const { return nullptr; }

  /// Their housing, if the geometry of the cameras is only that of their make, so that a calibration is better; else
  /// null.
  virtual const Housing* housing() const { return nullptr; }
};

}  // namespace robot_vision
