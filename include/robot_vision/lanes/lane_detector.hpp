#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/lanes/ground_view.hpp"

namespace robot_vision
{

struct LaneParams
{
  std::string method = "ridge";
  double contrast = 20.0;
  double line_width = 0.03;
  int white_low = 190;
  int yellow_low = 15;
  int yellow_high = 35;
  int yellow_saturation = 80;
  int yellow_lightness = 40;
  double lane_width = 0.4;
  double width_tolerance = 0.25;
  int windows = 10;
  double window_width = 0.1;
  int min_rows = 5;
  double tolerance = 0.015;
  double min_length = 0.3;
  double max_curvature = 1.5;
  double min_confidence = 0.3;
  double max_gap = 0.5;
  double smoothing = 0.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &LaneParams::method, OneOf{"ridge, color or gradient"}, "",
          "what may be a line: brighter than the floor on both sides, white or yellow, or between two edges");
    visit("contrast", &LaneParams::contrast, Range{1, 255}, "gray levels",
          "ridge: by which a line is brighter than the floor; gradient: change at its edges over 2 px of the view");
    visit("line_width", &LaneParams::line_width, Above{0, 10}, "m",
          "ridge, gradient: of the widest line that is painted");
    visit("white_low", &LaneParams::white_low, Range{0, 255}, "", "color: lowest lightness of white");
    visit("yellow_low", &LaneParams::yellow_low, Range{0, 180}, "half degrees", "color: lowest hue of yellow");
    visit("yellow_high", &LaneParams::yellow_high, Range{0, 180}, "half degrees",
          "color: highest hue of yellow, yellow_low or more");
    visit("yellow_saturation", &LaneParams::yellow_saturation, Range{0, 255}, "", "color: lowest saturation of yellow");
    visit("yellow_lightness", &LaneParams::yellow_lightness, Range{0, 255}, "",
          "color: lowest lightness of yellow, below which noise has all colors");
    visit("lane_width", &LaneParams::lane_width, Above{0, 100}, "m", "between the middles of both lines");
    visit("width_tolerance", &LaneParams::width_tolerance, Range{0.01, 0.9}, "",
          "share by which the width of a lane may differ from lane_width, everywhere in view");
    visit("windows", &LaneParams::windows, Range{3, 50}, "", "one above the other in which a line is followed");
    visit("window_width", &LaneParams::window_width, Above{0, 10}, "m", "of such a window, and around the last line");
    visit("min_rows", &LaneParams::min_rows, Range{1, 1000}, "px",
          "of a window that have a line in it, or it has none; at most all that it has");
    visit("tolerance", &LaneParams::tolerance, Above{0, 10}, "m",
          "by which the middle of a line may be beside its curve, below half of window_width");
    visit("min_length", &LaneParams::min_length, Above{0, 1000}, "m",
          "shortest piece of a line, gaps included, below far - near");
    visit("max_curvature", &LaneParams::max_curvature, Above{0, 1000}, "1/m", "of a lane, 1 / its smallest radius");
    visit("min_confidence", &LaneParams::min_confidence, Range{0, 1}, "", "of a line that is one");
    visit("max_gap", &LaneParams::max_gap, Range{0, 60}, "s",
          "after which a line is no longer looked for around where it was; 0: at once");
    visit("smoothing", &LaneParams::smoothing, Range{0, 10}, "s", "time constant of the mean over frames; 0: none");
  }
};

/// Throws std::invalid_argument for the first parameter out of range, and for limits in the wrong order.
void validate(const LaneParams& params);

/// One of the two lines of a lane. All is zero or empty if it was not found.
struct LaneLine
{
  bool found = false;
  double confidence = 0.0;              // 0 to 1, see LaneDetector
  std::vector<cv::Point2d> points;      // m, on the floor in the robot's frame, on the fitted curve, the nearest first
  std::vector<cv::Point2d> in_image;    // px, the same points
  std::vector<cv::Point2d> from_above;  // px of the view from above, the same points
};

/// The lane that the robot is in. Its measures are those at the place of its middle that is nearest to the robot's
/// origin. They are never NaN, and zero if no lane was found. A lane needs one line at least: `lane_width` of the
/// parameters, or the width when both were seen last, tells where the other one is.
struct Lane
{
  bool found = false;
  double offset = 0.0;     // m, of the robot from the lane's middle, > 0 to the left of it
  double heading = 0.0;    // rad, of the robot against the lane, > 0 turned to the left
  double curvature = 0.0;  // 1/m, of the lane's middle, > 0 to the left
  double width = 0.0;      // m, between the middles of the lines
  LaneLine left, right;
  std::vector<cv::Point2d> middle;           // m, on the floor in the robot's frame, from the robot on
  std::vector<cv::Point2d> middle_in_image;  // px, the same points; NaN where the camera cannot see them
  cv::Mat view;                              // CV_8UC3, the floor from above
  cv::Mat mask;                              // CV_8UC1, of that view: 255 where a line may be
};

/// Finds the lane of a road in the view of a camera that looks ahead and down.
///
/// The floor is drawn as it looks from above. Pixels that may be of a line are found by the `method`. Lines are begun
/// where histograms of their middles have peaks, and followed upwards by sliding windows, or looked for around
/// where they were in the last frame. RANSAC fits a parabola to each. Of all pairs that are parallel and as wide as a
/// lane the best one is taken. The measures are those of two concentric arcs, fitted to the middles of both lines by
/// least squares.
///
/// The confidence of a line is the product of three shares: of its rows within `tolerance` of its curve, less what
/// would be by chance; of the visible part of the curve between its first and its last row; and three times that of
/// this piece that is painted (at most 1).
///
/// Threads may share one; their calls wait for each other.
class LaneDetector
{
public:
  /// Throws std::invalid_argument as validate() of both does, or if the view from above is too narrow or too short for
  /// the lines.
  explicit LaneDetector(const GroundParams& ground = GroundParams(), const LaneParams& params = LaneParams());
  ~LaneDetector();

  /// The lane in the frame of `time_s` (s, of any clock). `image` is not modified. `camera` is needed if `ground` is
  /// "camera", and not used otherwise. Throws std::invalid_argument if `image` is not an image of `encoding` (see
  /// encoding.hpp), or if the camera is missing, not valid, or of images of another size.
  Lane update(double time_s, const cv::Mat& image, const std::string& encoding, const CameraModel* camera = nullptr);

  /// Forgets where the lane was.
  void reset();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Draws a lane over an image, or over its view from above (CV_8UC3): the lines, and the ground between them if there
/// are both. Positions in px; those that are not finite are left out. Throws std::invalid_argument for other images.
void drawLane(cv::Mat& bgr, const std::vector<cv::Point2d>& left, const std::vector<cv::Point2d>& right);

}  // namespace robot_vision
