#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/segmentation/regions.hpp"

namespace robot_vision
{

struct MotionParams
{
  std::string method = "first_frame";  // what a frame is compared with, see MotionDetector
  int blur_size = 21;                  // px, side of the Gaussian blur: odd, 1 (none) to 99
  double threshold = 25.0;      // gray levels by which the blurred pictures differ where something moves, 0 to 255
  int dilate = 2;               // px by which what moves is grown, 0 to 50
  double min_area = 500.0;      // px, regions with fewer pixels are left out, 0 to 1e9
  double learning_rate = 0.05;  // running_average, mog2: share of the newest frame, above 0 to 1
  double max_changed = 0.5;     // share of the picture above which it is no motion but light or the camera, 0 to 1
  double settle = 1.0;          // s of that until what is seen is the new background, 0 to 3600
  bool ignore_light = false;    // take the change of the median brightness out first; not with mog2
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const MotionParams& params);

/// What moves in a frame.
struct Motion
{
  cv::Mat mask;                 // CV_8UC1, 255 where the picture has changed
  double changed = 0.0;         // share of the picture that has, 0 to 1
  bool everywhere = false;      // more than max_changed: nothing can be told, there are no regions
  std::vector<Region> regions;  // of the mask, the largest first, their outlines simplified to within 1 px
};

/// Finds what moves by comparing each frame with a background.
///
/// first_frame: the first one, as courses do; previous_frame: the one before; running_average: the mean of all, newer
/// ones counting more. A pixel has changed if the pictures, gray and blurred, differ by more than the threshold:
/// cv::cvtColor, cv::GaussianBlur, cv::absdiff, cv::threshold and cv::dilate (3x3, once per px), to the bit, but
/// blurred only near pixels that differ. mog2: a mixture of Gaussians per pixel (cv::BackgroundSubtractorMOG2) of the
/// colour picture, which is not blurred; shadows do not count.
///
/// When the whole picture changes, because a lamp is switched on or the camera is moved, this is reported as such, and
/// what is seen after `settle` seconds of it is the background from then on.
class MotionDetector
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit MotionDetector(const MotionParams& params = MotionParams());
  ~MotionDetector();
  MotionDetector(MotionDetector&&) noexcept;
  MotionDetector& operator=(MotionDetector&&) noexcept;

  /// The motion in the frame of `time_s` (s, of any clock). Nothing moves in the first frame, in one of another size
  /// or encoding than the last, and when time has gone back: each is a new background. `image` is not modified.
  /// Throws std::invalid_argument if `image` is not a picture of `encoding` (see encoding.hpp).
  Motion update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// The next frame is the background.
  void reset();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
