#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "freenect_device.hpp"
#include "kinect_depth.hpp"
#include "kinect_frames.hpp"
#include "robot_vision/camera/open_source.hpp"

namespace robot_vision
{

/// The images of a Kinect of the first kind: colors, the infrared image, depths, or colors and depths. USB has room for
/// some 30 ms of them only, so they are taken in by a thread of its own.
class FreenectSource : public FrameSource
{
public:
  /// Opens the Kinect that sourceName() of `params` tells. Throws SourceUnavailable as FreenectDevice does.
  FreenectSource(std::shared_ptr<const FreenectLibrary> library, const CaptureParams& params);
  ~FreenectSource() override;

  ReadResult read(Frame& frame) override;
  double rate() const override { return 0.0; }
  double period() const override;
  std::string description() const override;
  std::string warning() const override { return warning_; }
  const CameraModel* cameraModel() const override;
  const SecondCamera* secondCamera() const override { return gives_.color && gives_.depth ? &depth_ : nullptr; }
  const Housing* housing() const override { return &housing_; }

private:
  /// Which images it is to give.
  struct Gives
  {
    bool color;  // or the infrared image
    bool depth;
  };

  /// The images of the color camera in a mode of libfreenect.
  struct Mode
  {
    freenect_video_format format;
    freenect_resolution resolution;
    cv::Size size;
    const char* encoding;
    int rate;  // Hz
  };

  static Gives givesFor(const CaptureParams& params);
  static Mode modeFor(const CaptureParams& params);

  void onImage(KinectCamera camera, std::uint32_t ticks);
  void run();
  void startWanted();

  std::string name_;
  Gives gives_;
  Mode mode_;
  std::string warning_;
  KinectFrames frames_;
  FreenectDevice device_;  // of the thread while that runs
  KinectOptics optics_;
  KinectDepths depths_;
  CameraModel color_;
  SecondCamera depth_;
  Housing housing_;
  bool color_runs_ = false;
  bool depth_runs_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Loads libfreenect and opens the Kinect that sourceName() of `params` tells. Throws SourceUnavailable if one of both
/// is not there.
std::unique_ptr<FrameSource> openFreenect(const CaptureParams& params);

}  // namespace robot_vision
