#include "robot_vision/flow/flow_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinBrightest = 1.0;  // px, speed that is drawn brightest if no pixel is faster
constexpr double kMinArrow = 0.5;      // px, motion that is drawn as an arrow
constexpr double kMaxArrow = 4096.0;   // px, length that OpenCV's fixed-point numbers hold for sure
const cv::Scalar kGreen(0, 255, 0);

void drawArrow(cv::Mat& bgr, const cv::Point& from, const cv::Point2f& motion, double scale)
{
  const double length = std::hypot(motion.x, motion.y);
  if (!std::isfinite(length) || length < kMinArrow)
  {
    bgr.at<cv::Vec3b>(from) = cv::Vec3b(0, 255, 0);
    return;
  }
  const double factor = std::min(scale, kMaxArrow / length);
  const cv::Point tip(cvRound(from.x + factor * motion.x), cvRound(from.y + factor * motion.y));
  cv::arrowedLine(bgr, from, tip, kGreen, 1, cv::LINE_AA, 0, 0.3);
}

}  // namespace

void flowToColors(const cv::Mat& flow, double max_speed, cv::Mat& bgr)
{
  checkPixels(flow, "32FC2", CV_32FC2);
  requireRange("max_speed", max_speed, 0.0, 1000.0);
  std::array<cv::Mat, 2> motion;
  cv::split(flow, motion.data());
  cv::Mat speed, angle;
  cv::cartToPolar(motion[0], motion[1], speed, angle, /*angleInDegrees=*/true);
  double brightest = max_speed;
  if (max_speed == 0.0)
  {
    cv::minMaxLoc(speed, nullptr, &brightest);
    brightest = std::max(brightest, kMinBrightest);
  }
  std::array<cv::Mat, 3> hsv;
  angle.convertTo(hsv[0], CV_8U, 0.5);  // OpenCV's hues are half degrees
  hsv[1] = cv::Mat(flow.size(), CV_8UC1, cv::Scalar(255));
  speed.convertTo(hsv[2], CV_8U, 255.0 / brightest);
  cv::Mat merged;
  cv::merge(hsv.data(), hsv.size(), merged);
  cv::cvtColor(merged, bgr, cv::COLOR_HSV2BGR);
}

void drawFlowArrows(cv::Mat& bgr, const cv::Mat& flow, int spacing, double scale)
{
  checkPixels(bgr, "bgr8");
  checkPixels(flow, "32FC2", CV_32FC2);
  require(flow.size() == bgr.size(), "the flow's size", toText(flow.size()), "the image's, " + toText(bgr.size()));
  requireRange("spacing", spacing, 1, 1e6);
  requireRange("scale", scale, 0.0, 1e6);
  for (int y = spacing / 2; y < flow.rows; y += spacing)
    for (int x = spacing / 2; x < flow.cols; x += spacing)
      drawArrow(bgr, {x, y}, flow.at<cv::Point2f>(y, x), scale);
}

}  // namespace robot_vision
