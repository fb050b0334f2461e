#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "robot_vision/stereo/stereo_camera.hpp"

namespace robot_vision
{

/// Makes the rectified images of one camera of a pair: without distortion, and with what both cameras see in the same
/// rows. The maps of cv::initUndistortRectifyMap, or of cv::fisheye for its lenses, are made once, in fixed point.
class Rectifier
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit Rectifier(const RectifiedCamera& camera);
  ~Rectifier();
  Rectifier(Rectifier&& other) noexcept;
  Rectifier& operator=(Rectifier&& other) noexcept;

  const RectifiedCamera& camera() const;

  /// Converts an image to `wanted`, bgr8 or mono8 (see encoding.hpp), and writes what cv::remap makes of it with
  /// cv::INTER_LINEAR into `out`, which is reused if it fits. Black is what the camera does not see. `image` is not
  /// modified. Throws std::invalid_argument if it is not of `encoding`, or not of the camera's size.
  void apply(const cv::Mat& image, const std::string& encoding, const std::string& wanted, cv::Mat& out);

  /// CV_8UC1 of the rectified image's size: 255 where the camera sees something, else 0. Beyond what the lens shows it
  /// is 0, too, where the maps lead back into the image.
  const cv::Mat& seen() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The rectifiers of a pair, which are made anew only when the calibration is another one.
class StereoRectifier
{
public:
  /// Sets the calibration. Throws std::invalid_argument as validate() does; then all stays as it is.
  void setCamera(const StereoCamera& pair);

  // Only to be called after setCamera().
  Rectifier& left() { return *left_; }
  Rectifier& right() { return *right_; }
  const StereoGeometry& geometry() const { return geometry_; }

private:
  std::optional<Rectifier> left_;
  std::optional<Rectifier> right_;
  StereoGeometry geometry_;
};

}  // namespace robot_vision
