#include "lane_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace robot_vision::lanes
{
namespace
{

/// Mean of red and green, in which white and yellow lines are bright, smoothed.
cv::Mat brightness(const cv::Mat& bgr)
{
  cv::Mat bright;
  cv::transform(bgr, bright, cv::Matx13f(0.0F, 0.5F, 0.5F));
  cv::blur(bright, bright, {3, 3});
  return bright;
}

/// Removes what of a row is longer than a line is wide, or goes on outside of `known`: its middle is not that of a
/// line.
void keepLines(cv::Mat& mask, const cv::Mat& known, int longest)
{
  for (int y = 0; y < mask.rows; ++y)
  {
    auto* row = mask.ptr<std::uint8_t>(y);
    const auto* inside = known.ptr<std::uint8_t>(y);
    for (int begin = 0, end = 0; begin < mask.cols; begin = end + 1)
    {
      for (end = begin; end < mask.cols && row[end];)
        ++end;
      const bool whole = begin > 0 && inside[begin - 1] && end < mask.cols && inside[end];
      if (!whole || end - begin > longest) std::fill(row + begin, row + end, std::uint8_t{0});
    }
  }
}

/// Where a pixel is brighter than those at `distance` px on both sides.
/// `known` is where the camera sees all three, and is written.
cv::Mat ridges(const cv::Mat& view, const cv::Mat& seen, int distance, double contrast, cv::Mat& known)
{
  cv::Mat mask = cv::Mat::zeros(view.size(), CV_8UC1);
  known = mask.clone();
  const int inner = view.cols - 2 * distance;
  if (inner < 1) return mask;
  const cv::Mat bright = brightness(view);
  const auto part = [inner](const cv::Mat& whole, int x) { return whole.colRange(x, x + inner); };
  cv::Mat above_left, above_right, both;
  cv::subtract(part(bright, distance), part(bright, 0), above_left);
  cv::subtract(part(bright, distance), part(bright, 2 * distance), above_right);
  cv::min(above_left, above_right, both);
  part(known, distance) = part(seen, 0) & part(seen, 2 * distance);
  part(mask, distance) = both >= contrast;
  return mask;
}

cv::Mat whiteOrYellow(const cv::Mat& view, const LaneParams& params)
{
  cv::Mat hls, white, yellow;
  cv::cvtColor(view, hls, cv::COLOR_BGR2HLS);
  cv::inRange(hls, cv::Scalar(0, params.white_low, 0), cv::Scalar::all(255), white);
  cv::inRange(hls, cv::Scalar(params.yellow_low, params.yellow_lightness, params.yellow_saturation),
              cv::Scalar(params.yellow_high, 255, 255), yellow);
  return white | yellow;
}

/// What lies between an edge where the brightness rises to the right, and one where it falls again.
cv::Mat betweenEdges(const cv::Mat& view, int line_width, double contrast)
{
  cv::Mat change, begun, ending;
  cv::Sobel(brightness(view), change, CV_16S, 1, 0, 3, /*scale=*/0.25);  // gray levels over 2 px
  const cv::Mat reach = cv::Mat::ones(1, line_width + 1, CV_8UC1);
  cv::dilate(change >= contrast, begun, reach, {line_width, 0});
  cv::dilate(change <= -contrast, ending, reach, {0, 0});
  return begun & ending;
}

}  // namespace

int floorDistance(double resolution, const LaneParams& params)
{
  return static_cast<int>(std::ceil(params.line_width / resolution)) + 1;
}

cv::Mat lineMask(const cv::Mat& view, const cv::Mat& seen, double resolution, const LaneParams& params)
{
  cv::Mat inside;  // without what was smoothed with the black around it
  cv::erode(seen, inside, cv::Mat::ones(5, 5, CV_8UC1), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  const int distance = floorDistance(resolution, params);
  cv::Mat mask, known = inside;
  if (params.method == "ridge")
    mask = ridges(view, inside, distance, params.contrast, known);
  else
    mask = params.method == "color" ? whiteOrYellow(view, params) : betweenEdges(view, distance, params.contrast);
  mask &= known;
  keepLines(mask, known, 2 * distance);
  return mask;
}

}  // namespace robot_vision::lanes
