#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/segmentation/regions.hpp"

namespace robot_vision
{

struct MotionParams
{
  std::string method = "first_frame";
  int blur_size = 21;
  double threshold = 25.0;
  int dilate = 2;
  double min_area = 500.0;
  double learning_rate = 0.05;
  double max_changed = 0.5;
  double settle = 1.0;
  bool ignore_light = false;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &MotionParams::method, OneOf{"first_frame, previous_frame, running_average or mog2"}, "",
          "what frames are compared with");
    visit("blur_size", &MotionParams::blur_size, OddRange{1, 99}, "px",
          "side of the Gaussian blur; 1: none; not with mog2");
    visit("threshold", &MotionParams::threshold, Range{0, 255}, "gray levels",
          "difference of the blurred images where something moves; not with mog2");
    visit("dilate", &MotionParams::dilate, Range{0, 50}, "px", "by how much what moves is grown");
    visit("min_area", &MotionParams::min_area, Range{0, 1e9}, "px^2", "smallest thing that moves");
    visit("learning_rate", &MotionParams::learning_rate, Above{0, 1}, "",
          "running_average, mog2: share of the newest frame; at 0.05 what stays is background in 45 frames");
    visit("max_changed", &MotionParams::max_changed, Range{0, 1}, "",
          "share of the image above which it is no motion, but light or the camera");
    visit("settle", &MotionParams::settle, Range{0, 3600}, "s", "such a change becomes the background after this");
    visit("ignore_light", &MotionParams::ignore_light, Anything{}, "",
          "take out what changes in the whole image alike, the median brightness; not with mog2");
  }
};

/// What moves in a frame.
struct Motion
{
  cv::Mat mask;                 // CV_8UC1, 255 where the image has changed
  double changed = 0.0;         // share of the image that has changed, 0 to 1
  bool everywhere = false;      // more than max_changed has: what moves cannot be told, there are no regions
  std::vector<Region> regions;  // of the mask, the 1000 largest at most, the largest first, with outlines within 1 px
};

/// Finds what moves by comparing each frame with a background.
///
/// first_frame: the first one, as courses do; previous_frame: the one before; running_average: the mean of all, newer
/// ones counting more. A pixel has changed if the images, gray and blurred, differ by more than the threshold:
/// cv::cvtColor, cv::GaussianBlur, cv::absdiff, cv::threshold and cv::dilate (3x3, once per px), to the bit, but
/// blurred only near pixels that differ. mog2: a mixture of Gaussians per pixel (cv::BackgroundSubtractorMOG2) of the
/// color image, which is not blurred; shadows do not count as motion.
///
/// When the whole image changes, because a lamp is switched on or the camera is moved, this is reported as such, and
/// what is seen after `settle` seconds of it is the background from then on.
///
/// Threads may share one; their calls wait for each other.
class MotionDetector
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit MotionDetector(const MotionParams& params = MotionParams());
  ~MotionDetector();

  /// Sets the parameters from the next frame on. The background stays, but not for another method: the next frame is
  /// then the background. Throws std::invalid_argument as validate() does, and changes nothing.
  void configure(const MotionParams& params);

  /// The motion in the frame of `time_s` (s, of any clock). Nothing moves in the first frame, in one of another size
  /// or encoding than the last, and, but with first_frame, when time has gone back: each is a new background. `image`
  /// is not modified.
  /// Throws std::invalid_argument if `image` is not an image of `encoding` (see encoding.hpp), or `time_s` not finite.
  Motion update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// Makes the next frame the background.
  void reset();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
