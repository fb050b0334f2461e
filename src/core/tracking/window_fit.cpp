#include "window_fit.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "core/image/fixed_point.hpp"
#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr double kHalfPixel = 0.5;  // px: positions are from the centre of the first pixel, OpenCV's from its corner

cv::Point2d centerOfMass(const cv::Mat& back_projection, const cv::Rect& part)
{
  const cv::Moments sums = cv::moments(back_projection(part));
  if (sums.m00 <= 0.0) return {};
  return {part.x + sums.m10 / sums.m00, part.y + sums.m01 / sums.m00};
}

/// Measures the back projection inside of the outline.
void measureInside(const cv::Mat& back_projection, WindowFit& fit)
{
  const std::vector<cv::Point2f> corners(fit.outline.begin(), fit.outline.end());
  const cv::Rect part = cv::boundingRect(corners) & fullRect(back_projection);
  if (part.empty()) return;
  std::vector<cv::Point> polygon;
  for (const cv::Point2d& corner : fit.outline)
    polygon.push_back(fixedPoint(corner - cv::Point2d(part.tl())));
  cv::Mat mask = cv::Mat::zeros(part.size(), CV_8UC1);
  cv::fillConvexPoly(mask, polygon, cv::Scalar::all(255), cv::LINE_8, kFractionBits);
  fit.similarity = cv::mean(back_projection(part), mask)[0] / 255.0;
  fit.center = centerOfMass(back_projection, part);  // the window cuts off the ends of what is tilted
}

/// Shifts the window.
WindowFit shifted(const cv::Mat& back_projection, const cv::Rect& window, const cv::TermCriteria& criteria)
{
  WindowFit fit;
  fit.window = window;
  cv::meanShift(back_projection, fit.window, criteria);
  const double left = fit.window.x - kHalfPixel, top = fit.window.y - kHalfPixel;
  const double right = left + fit.window.width, bottom = top + fit.window.height;
  fit.outline = {{{left, top}, {right, top}, {right, bottom}, {left, bottom}}};
  fit.area = fit.window.area();
  fit.similarity = cv::mean(back_projection(fit.window))[0] / 255.0;
  fit.center = centerOfMass(back_projection, fit.window);
  return fit;
}

/// Shifts, turns and resizes the window.
WindowFit adapted(const cv::Mat& back_projection, const cv::Rect& window, const cv::TermCriteria& criteria)
{
  WindowFit fit;
  fit.window = window;
  const cv::RotatedRect box = cv::CamShift(back_projection, fit.window, criteria);
  // Of an empty window all is 0, and of a line of pixels OpenCV before 4.5 may take the root of a negative number.
  if (!(box.size.width > 0.0F && box.size.height > 0.0F)) return {};
  std::array<cv::Point2f, 4> corners;
  box.points(corners.data());
  std::transform(corners.begin(), corners.end(), fit.outline.begin(),
                 [](const cv::Point2f& corner) { return cv::Point2d(corner) - cv::Point2d(kHalfPixel, kHalfPixel); });
  fit.area = static_cast<double>(box.size.width) * box.size.height;
  fit.direction = (box.angle - 90.0) * CV_PI / 180.0;
  measureInside(back_projection, fit);
  return fit;
}

}  // namespace

std::optional<WindowFit> fitWindow(const cv::Mat& back_projection, const cv::Rect& window,
                                   const WindowTrackerParams& params)
{
  const cv::Rect begin = window & fullRect(back_projection);
  if (begin.empty()) return std::nullopt;  // OpenCV throws for such windows
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, params.max_iterations,
                                  params.epsilon);
  WindowFit fit = params.method == "meanshift" ? shifted(back_projection, begin, criteria)
                                               : adapted(back_projection, begin, criteria);
  fit.window &= fullRect(back_projection);
  const bool is_there = !fit.window.empty() && fit.area >= params.min_area && fit.similarity > 0.0 &&
                        fit.similarity >= params.min_similarity;
  if (!is_there) return std::nullopt;
  return fit;
}

std::optional<cv::Rect> densestWindow(const cv::Mat& back_projection, const cv::Size& size)
{
  const cv::Size window(std::min(size.width, back_projection.cols), std::min(size.height, back_projection.rows));
  cv::Mat means;  // and not sums, which OpenCV makes of integers that overflow in a window of some megapixels
  cv::boxFilter(back_projection, means, CV_32F, window, {0, 0}, /*normalize=*/true, cv::BORDER_CONSTANT);
  const cv::Rect inside(0, 0, means.cols - window.width + 1, means.rows - window.height + 1);
  double max = 0.0;
  cv::Point place;
  cv::minMaxLoc(means(inside), nullptr, &max, nullptr, &place);
  if (max <= 0.0) return std::nullopt;
  return cv::Rect(place, window);
}

}  // namespace robot_vision
