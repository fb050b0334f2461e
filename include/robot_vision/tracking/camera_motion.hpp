#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct CameraMotionParams
{
  int width = 320;
  int window = 11;
  int levels = 2;
  int points = 80;
  double tolerance = 1.0;
  int min_points = 12;
  double min_share = 0.5;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("width", &CameraMotionParams::width, Range{64, 2048}, "px",
          "images that are wider are shrunk by a whole number to at most this");
    visit("window", &CameraMotionParams::window, OddRange{5, 51}, "px",
          "side of the window around a point that is followed, in the shrunk image");
    visit("levels", &CameraMotionParams::levels, Range{0, 6}, "", "halvings of the shrunk image, for fast motion");
    visit("points", &CameraMotionParams::points, Range{16, 1000}, "", "that are followed, about, one in each cell");
    visit("tolerance", &CameraMotionParams::tolerance, Range{0.1, 10}, "px",
          "by which a point may miss the motion of all, in the shrunk image");
    visit("min_points", &CameraMotionParams::min_points, Range{4, 1000}, "",
          "that must agree on the motion; fewer do not tell it");
    visit("min_share", &CameraMotionParams::min_share, Range{0.1, 1}, "", "of the points that must agree");
  }
};

/// Tells how the camera's motion has moved the image from one frame to the next, as a similarity: shift, rotation and
/// scale. That is what a camera does that turns, and about what one does that moves before a scene far away.
///
/// The best corner (Shi, Tomasi: Good Features to Track, CVPR 1994) of each cell of a small gray image is followed by
/// pyramidal Lucas-Kanade flow. The similarity that most of these points agree with is found by RANSAC with a fixed
/// seed, so that what moves by itself, if it is less than half of all, has no say. The same frames give the same
/// results. Not thread-safe.
class CameraMotion
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit CameraMotion(const CameraMotionParams& params = CameraMotionParams());
  ~CameraMotion();
  CameraMotion(CameraMotion&&) noexcept;
  CameraMotion& operator=(CameraMotion&&) noexcept;

  /// Takes pixels of the last frame to those of this one: x' = w00 x + w01 y + w02, y' = w10 x + w11 y + w12, in px
  /// with the origin at the image's top left corner, as boxes have them. It is the identity if that is not known().
  ///
  /// `leave_out` are boxes in px of the last frame, of what moves by itself, such as what a BoxTracker returned for it:
  /// no points are taken in them. `image` is not modified. Throws std::invalid_argument, and keeps the last frame, if
  /// `image` is not of `encoding` (see encoding.hpp), and for a box with numbers that are not finite.
  cv::Matx23d update(const cv::Mat& image, const std::string& encoding, const std::vector<cv::Rect2d>& leave_out = {});

  /// Whether the last update() could tell the motion. Not so of the first frame, one of another size than that before,
  /// and if too few points agree: after a cut, or where there is nothing but blur, darkness or plain walls.
  bool known() const;

  /// How many points agree on the motion that the last update() has told; 0 if it is not known.
  int points() const;

  /// Forgets the last frame.
  void reset();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
