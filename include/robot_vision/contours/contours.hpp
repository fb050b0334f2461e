#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct ContourParams
{
  std::string method = "otsu";
  bool invert = false;
  int blur_size = 5;
  double threshold = 128.0;
  int block_size = 51;
  double offset = 5.0;
  double canny_low = 50.0;
  double canny_high = 150.0;
  std::string mode = "tree";
  std::string approximation = "simple";
  double min_area = 100.0;
  int max_contours = 100;
  double epsilon = 0.02;
  double min_defect = 5.0;
  std::string match_method = "I1";
  double max_distance = 0.1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &ContourParams::method, OneOf{"fixed, otsu, adaptive_mean, adaptive_gaussian or canny"}, "",
          "how the image becomes black and white");
    visit("invert", &ContourParams::invert, Anything{}, "", "exchange black and white, for what is dark");
    visit("blur_size", &ContourParams::blur_size, OddRange{1, 31}, "px", "side of the Gaussian blur before; 1: none");
    visit("threshold", &ContourParams::threshold, Range{0, 255}, "gray levels", "fixed: brighter pixels become white");
    visit("block_size", &ContourParams::block_size, OddRange{3, 999}, "px",
          "adaptive: side of the window whose mean is the threshold");
    visit("offset", &ContourParams::offset, Range{-255, 255}, "gray levels",
          "adaptive: how far the threshold is below this mean");
    visit("canny_low", &ContourParams::canny_low, Range{0, 10000}, "",
          "canny: gradient magnitude above which a pixel prolongs an edge");
    visit("canny_high", &ContourParams::canny_high, Range{0, 10000}, "",
          "canny: gradient magnitude above which a pixel begins an edge");
    visit("mode", &ContourParams::mode, OneOf{"external, list, ccomp or tree"}, "",
          "which contours are taken, and which hierarchy they have");
    visit("approximation", &ContourParams::approximation, OneOf{"none, simple, tc89_l1 or tc89_kcos"}, "",
          "which pixels of a border become points of the contour");
    visit("min_area", &ContourParams::min_area, Range{0, 1e9}, "px^2", "smallest contour; smaller ones are left out");
    visit("max_contours", &ContourParams::max_contours, Range{1, 1000}, "", "how many are taken, the largest");
    visit("epsilon", &ContourParams::epsilon, Range{0, 0.5}, "",
          "approxPolyDP: largest distance of the polygon from the contour, as a share of its length");
    visit("min_defect", &ContourParams::min_defect, Range{0, 10000}, "px", "smallest depth of a convexity defect");
    visit("match_method", &ContourParams::match_method, OneOf{"I1, I2 or I3"}, "",
          "matchShapes: how Hu moments are compared with those of the template");
    visit("max_distance", &ContourParams::max_distance, Range{0, 1000}, "",
          "matchShapes: largest distance at which a contour is a match");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const ContourParams& params);

/// Where the hull of a contour is farthest from it between two points that they share.
struct ContourDefect
{
  cv::Point start;     // px
  cv::Point end;       // px
  cv::Point farthest;  // px, the contour's point that is farthest from the line between the two
  double depth = 0.0;  // px, its distance from that line
};

/// A rectangle or an ellipse that is turned.
struct TurnedShape
{
  cv::Point2d center;   // px
  double length = 0.0;  // px, of the longer side or axis, from end to end
  double width = 0.0;   // px, of the shorter one
  double angle = 0.0;   // rad, from the x axis to the longer one, clockwise as seen; above -pi/2, up to pi/2
};

/// A border of white pixels, and what OpenCV's functions say of it. Pixel centres have integer coordinates; areas and
/// lengths are those of the polygon through the centres of the border's pixels.
struct Contour
{
  std::vector<cv::Point> outline;        // px, closed
  int parent = -1;                       // index of the next one around it that was taken; -1: there is none
  int depth = 0;                         // number of contours around it, those that were left out included
  bool hole = false;                     // it goes around black pixels
  cv::Rect box;                          // px, upright
  cv::Point2d center;                    // px, centroid of what it encloses
  double area = 0.0;                     // px^2, of what it encloses; holes are not taken off
  double length = 0.0;                   // px, arcLength
  bool convex = false;                   // isContourConvex of the outline
  double solidity = 0.0;                 // area relative to that of the hull, 0 to 1
  std::vector<cv::Point> approximation;  // px, closed, by approxPolyDP
  std::vector<cv::Point> hull;           // px, closed
  std::vector<ContourDefect> defects;    // deepest first; none of an outline that crosses itself
  cv::Point2d circle_center;             // px, of the smallest circle around it
  double circle_radius = 0.0;            // px
  TurnedShape rectangle;                 // the smallest around it, minAreaRect
  std::optional<TurnedShape> ellipse;    // fitEllipse, of at least 5 points that are not in line
  cv::Point2d line_point;                // px, of the line by fitLine with least squares
  double line_angle = 0.0;               // rad, its direction, as that of a TurnedShape
  std::array<double, 7> hu = {};         // Hu moments: the same for the same shape in any place, size and turn
  std::string shape;                     // its name, see nameShape()
  std::optional<double> match;           // matchShapes: 0 is the template's shape; infinite: not comparable
  bool matches = false;                  // match is not above max_distance
  double point_distance = 0.0;           // px, pointPolygonTest of the point asked for: > 0 inside
};

/// What a ContourFinder has found in an image.
struct ContourResult
{
  cv::Mat mask;                   // CV_8UC1, 0 and 255: the image in black and white
  std::vector<Contour> contours;  // the largest first
};

/// The name of a shape by its approximation: triangle, square, rectangle, quadrilateral, pentagon, hexagon; of more
/// corners circle, ellipse or polygon; line, of less than 3 corners, and concave, of any number.
///
/// A square and a rectangle fill nine tenths of their smallest rectangle, whose sides are equal to a tenth in a square.
/// A circle fills eight tenths of its smallest circle; an ellipse has the area of the one fitted to it, to a twentieth.
std::string nameShape(const Contour& contour);

/// Finds the contours of an image that is made black and white by cv::threshold, cv::adaptiveThreshold or our
/// EdgeDetector, which equals cv::Canny: cv::findContours, and of the largest ones all that OpenCV measures. Not for
/// two threads at once.
class ContourFinder
{
public:
  /// `template_bgr` (CV_8UC3, any size) shows the shape to compare with: its largest outer contour, found with the same
  /// parameters. Without it, nothing is compared. Throws std::invalid_argument as validate() does, and if the template
  /// has no contour with an area.
  explicit ContourFinder(const ContourParams& params = ContourParams(), const cv::Mat& template_bgr = cv::Mat());
  ContourFinder(ContourFinder&&);
  ContourFinder& operator=(ContourFinder&&);
  ~ContourFinder();

  /// The contours of an image, which is not modified, and how far each is from `point` (px). Throws
  /// std::invalid_argument if `image` is not of `encoding` (see encoding.hpp), and with modes ccomp and tree, whose
  /// search would take many seconds then, if its black and white changes more than a million times along its rows, and
  /// at more than each fourth pixel.
  ContourResult apply(const cv::Mat& image, const std::string& encoding,
                      const std::optional<cv::Point2d>& point = std::nullopt);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
