#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct HoughParams
{
  std::string method = "lines";
  std::string blur = "gaussian";
  int blur_size = 5;
  double canny_low = 50.0;
  double canny_high = 150.0;
  double rho = 1.0;
  double theta = 1.0;
  int threshold = 100;
  double min_length = 50.0;
  double max_gap = 10.0;
  std::string circle_method = "gradient";
  double dp = 1.0;
  double min_distance = 20.0;
  int accumulator_threshold = 40;
  double perfectness = 0.9;
  int min_radius = 10;
  int max_radius = 100;
  int max_results = 50;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &HoughParams::method, OneOf{"lines, segments or circles"}, "", "what is looked for");
    visit("blur", &HoughParams::blur, OneOf{"none, gaussian or median"}, "",
          "filter of the gray image before its edges are looked for");
    visit("blur_size", &HoughParams::blur_size, OddRange{3, 31}, "px", "side of this filter's window");
    visit("canny_low", &HoughParams::canny_low, Range{0, 10000}, "",
          "lines, segments: gradient magnitude above which a pixel prolongs an edge; for circles it is half of "
          "canny_high");
    visit("canny_high", &HoughParams::canny_high, Range{1, 10000}, "",
          "gradient magnitude above which a pixel begins an edge; gradient_alt: by Scharr, whose magnitudes are about "
          "four times as high");
    visit("rho", &HoughParams::rho, Range{0.25, 100}, "px",
          "lines, segments: step of the distances from the top left pixel");
    visit("theta", &HoughParams::theta, Range{0.05, 45}, "degrees", "lines, segments: step of the directions");
    visit("threshold", &HoughParams::threshold, Range{1, 100000}, "px",
          "lines, segments: edge pixels in line that make a line, its votes");
    visit("min_length", &HoughParams::min_length, Range{0, 100000}, "px", "segments: smallest length");
    visit("max_gap", &HoughParams::max_gap, Range{0, 100000}, "px", "segments: largest gap within one");
    visit("circle_method", &HoughParams::circle_method, OneOf{"gradient or gradient_alt"}, "",
          "circles: HOUGH_GRADIENT or, since OpenCV 4.3, HOUGH_GRADIENT_ALT");
    visit("dp", &HoughParams::dp, Range{1, 10}, "px", "circles: side of the accumulator's cells");
    visit("min_distance", &HoughParams::min_distance, Range{1, 10000}, "px",
          "circles: between their centres, at least");
    visit("accumulator_threshold", &HoughParams::accumulator_threshold, Range{1, 100000}, "px",
          "gradient: edge pixels whose gradients must point to a centre, its votes");
    visit("perfectness", &HoughParams::perfectness, Range{0, 0.99}, "",
          "gradient_alt: squared cosine of the angle by which gradients may miss the centre; nearer to 1: rounder");
    visit("min_radius", &HoughParams::min_radius, Range{0, 10000}, "px", "circles: smallest radius");
    visit("max_radius", &HoughParams::max_radius, Range{0, 10000}, "px",
          "circles: largest radius; 0: that of the image");
    visit("max_results", &HoughParams::max_results, Range{1, 1000}, "",
          "how many are given at most: those with most votes, or the longest segments");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range, also for gradient_alt
/// where OpenCV does not have it.
void validate(const HoughParams& params);

/// A line or a segment of one. Pixel centres have integer coordinates.
struct HoughLine
{
  cv::Point2d begin;   // px, one end: of a line, which has none, where it enters the image
  cv::Point2d end;     // px, the other end
  double rho = 0.0;    // px, x cos(theta) + y sin(theta) of all its points; < 0: the normal points the other way
  double theta = 0.0;  // rad, direction of its normal, from x towards y, 0 to pi
  int votes = 0;       // edge pixels on a line; 0 of segments, which are not voted on as a whole
  double score = 0.0;  // votes, of segments their length, relative to the highest in the image; 0 to 1
};

struct HoughCircle
{
  cv::Point2d center;   // px
  double radius = 0.0;  // px
  int votes = 0;        // edge pixels on it
  double score = 0.0;   // votes relative to the highest in the image, 0 to 1
};

/// What a HoughTransform has found in an image, best first.
struct HoughResult
{
  cv::Mat edges;                     // CV_8UC1, 255 on the edges that vote; empty if they were not asked for
  std::vector<HoughLine> lines;      // or segments
  std::vector<HoughCircle> circles;  // their centres are inside of the image
  bool too_many_edges = false;       // circles were not looked for, see HoughTransform
};

/// Finds lines, segments and circles by their edges: cv::HoughLines, cv::HoughLinesP and cv::HoughCircles behind a blur
/// and our EdgeDetector, which equals cv::Canny. The same image always gives the same result; with gradient_alt if
/// OpenCV works in one thread.
///
/// In an image full of noise cv::HoughCircles takes many seconds. With HOUGH_GRADIENT it is not called for edges that,
/// spread at random over the image, would give each centre three quarters of accumulator_threshold, and with
/// HOUGH_GRADIENT_ALT not for so many that their distances to all centres that min_distance and dp allow are more than
/// 6 billion.
class HoughTransform
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit HoughTransform(const HoughParams& params = HoughParams());
  HoughTransform(HoughTransform&&);
  HoughTransform& operator=(HoughTransform&&);
  ~HoughTransform();

  /// Finds what the parameters say in an image, which is not modified. Without `with_edges` no edges are returned.
  /// Throws std::invalid_argument if `image` is not of `encoding` (see encoding.hpp), if rho and theta are too fine or
  /// too coarse for its size, or theta is too fine for so many edges.
  HoughResult apply(const cv::Mat& image, const std::string& encoding, bool with_edges = true);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
