#include "robot_vision/image/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "fixed_point.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

const cv::Scalar kYellow(0, 255, 255), kRed(0, 0, 255), kBlack(0, 0, 0);
const int kFont = cv::FONT_HERSHEY_SIMPLEX;
const double kFontScale = 0.5;

/// Whether a position or length in px fits a fixed-point number. NaN does not.
bool isDrawable(double pixels)
{
  return std::abs(pixels) < 1e5;
}

bool isDrawable(const cv::Point2d& point)
{
  return isDrawable(point.x) && isDrawable(point.y);
}

}  // namespace

void maskPicture(const cv::Mat& bgr, const cv::Mat& mask, cv::Mat& out)
{
  checkPixels(bgr, "bgr8");
  checkPixels(mask, "mono8");
  require(mask.size() == bgr.size(), "the mask's size", toText(mask.size()), "the image's, " + toText(bgr.size()));
  out.create(bgr.size(), bgr.type());
  out.setTo(0);
  bgr.copyTo(out, mask);
}

void drawOutline(cv::Mat& bgr, const std::vector<cv::Point>& outline, const std::string& label, const cv::Scalar& color)
{
  checkPixels(bgr, "bgr8");
  if (outline.empty()) return;
  cv::polylines(bgr, outline, true, color, 2);

  const int gap = 5;
  int below = 0;  // px that letters such as g reach below the baseline
  const cv::Size text = cv::getTextSize(label, kFont, kFontScale, 1, &below);
  const cv::Rect box = cv::boundingRect(outline);
  const int above_box = box.y - gap - below;
  const int line = above_box >= text.height ? above_box : box.br().y + gap + text.height;
  const cv::Point at(std::clamp(box.x, 0, std::max(bgr.cols - text.width, 0)),
                     std::clamp(line, std::min(text.height, bgr.rows), std::max(bgr.rows - below, text.height)));
  drawText(bgr, label, at, color);
}

void drawText(cv::Mat& bgr, const std::string& text, const cv::Point& position, const cv::Scalar& color)
{
  checkPixels(bgr, "bgr8");
  if (!isDrawable(cv::Point2d(position))) return;
  cv::putText(bgr, text, position, kFont, kFontScale, kBlack, 3, cv::LINE_AA);  // an outline, legible on any colour
  cv::putText(bgr, text, position, kFont, kFontScale, color, 1, cv::LINE_AA);
}

void drawDot(cv::Mat& bgr, const cv::Point2d& center, double radius, const cv::Scalar& color)
{
  checkPixels(bgr, "bgr8");
  if (!isDrawable(center) || !isDrawable(radius) || radius < 0.0) return;
  cv::circle(bgr, fixedPoint(center), fixedPoint(radius), color, cv::FILLED, cv::LINE_AA, kFractionBits);
}

void drawBall(cv::Mat& bgr, const cv::Point2d& center, double radius, bool predicted)
{
  checkPixels(bgr, "bgr8");
  if (!isDrawable(center) || !isDrawable(radius) || radius < 0.0) return;
  const cv::Point middle = fixedPoint(center);
  if (predicted)
  {
    const int dashes = 12, turn = 360 / dashes;
    const int length = fixedPoint(radius);
    for (int angle = 0; angle < 360; angle += turn)
      cv::ellipse(bgr, middle, {length, length}, 0.0, angle, angle + turn / 2, kYellow, 1, cv::LINE_AA, kFractionBits);
  }
  else
    cv::circle(bgr, middle, fixedPoint(radius), kYellow, 2, cv::LINE_AA, kFractionBits);
  drawDot(bgr, center, predicted ? 2.0 : 4.0, kRed);
}

void drawTrail(cv::Mat& bgr, const std::vector<cv::Point2d>& centers)
{
  checkPixels(bgr, "bgr8");
  const double thinnest = 1.0, thickest = 6.0;  // px
  for (std::size_t i = 1; i < centers.size(); ++i)
  {
    if (!isDrawable(centers[i - 1]) || !isDrawable(centers[i])) continue;
    const double age = static_cast<double>(centers.size() - 1 - i) / static_cast<double>(centers.size());
    cv::line(bgr, fixedPoint(centers[i - 1]), fixedPoint(centers[i]), kRed,
             cvRound(thickest - (thickest - thinnest) * age), cv::LINE_AA, kFractionBits);
  }
}

}  // namespace robot_vision
