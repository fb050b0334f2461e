#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/image/fixed_point.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/lanes/lane_detector.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxPosition = 1e5;  // px, that is drawn
constexpr double kShade = 0.3;        // share of the colour between the lines
const cv::Scalar kGreen(0, 255, 0), kOrange(0, 100, 255);

std::vector<cv::Point> drawable(const std::vector<cv::Point2d>& curve)
{
  std::vector<cv::Point> fixed;
  for (const cv::Point2d& at : curve)
    if (std::abs(at.x) < kMaxPosition && std::abs(at.y) < kMaxPosition)  // NaN is not
      fixed.push_back(fixedPoint(at));
  return fixed;
}

}  // namespace

void drawLane(cv::Mat& bgr, const std::vector<cv::Point2d>& left, const std::vector<cv::Point2d>& right)
{
  checkPixels(bgr, "bgr8");
  const std::vector<std::vector<cv::Point>> lines = {drawable(left), drawable(right)};
  if (lines[0].size() > 1 && lines[1].size() > 1)
  {
    std::vector<cv::Point> between = lines[0];
    between.insert(between.end(), lines[1].rbegin(), lines[1].rend());
    cv::Mat shaded = bgr.clone();
    cv::fillPoly(shaded, std::vector<std::vector<cv::Point>>{between}, kGreen, cv::LINE_8, kFractionBits);
    cv::addWeighted(shaded, kShade, bgr, 1.0 - kShade, 0.0, bgr);
  }
  for (const auto& line : lines)
    if (line.size() > 1) cv::polylines(bgr, line, false, kOrange, 2, cv::LINE_AA, kFractionBits);
}

}  // namespace robot_vision
