#include "contour_measures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

constexpr std::size_t kMinEllipsePoints = 5;
constexpr double kMaxEllipse = 10.0;  // times the diagonal of the box: longer ones are fitted to what is no ellipse
constexpr double kMinFilledRectangle = 0.9;
constexpr double kMinSquareSides = 0.9;  // the shorter one to the longer one
constexpr double kMinFilledCircle = 0.8;
constexpr double kMaxEllipseError = 0.05;  // of the area
constexpr double kDefectUnit = 256.0;      // cv::convexityDefects gives depths in fixed-point numbers

/// An angle in rad as that of a line: above -pi/2, up to pi/2.
double asDirection(double angle)
{
  const double turned = std::remainder(angle, CV_PI);
  return turned <= -CV_PI / 2.0 ? turned + CV_PI : turned;
}

/// OpenCV's versions do not agree on which side of a RotatedRect is its width.
TurnedShape turnedShape(const cv::RotatedRect& rect)
{
  const bool upright = rect.size.height > rect.size.width;
  TurnedShape shape;
  shape.center = rect.center;
  shape.length = std::max(rect.size.width, rect.size.height);
  shape.width = std::min(rect.size.width, rect.size.height);
  shape.angle = asDirection(rect.angle * CV_PI / 180.0 + (upright ? CV_PI / 2.0 : 0.0));
  return shape;
}

std::optional<TurnedShape> fittedEllipse(const std::vector<cv::Point>& outline, const cv::Rect& box)
{
  if (outline.size() < kMinEllipsePoints) return std::nullopt;
  const TurnedShape ellipse = turnedShape(cv::fitEllipse(outline));
  const double numbers = ellipse.center.x + ellipse.center.y + ellipse.length + ellipse.width + ellipse.angle;
  const double longest = kMaxEllipse * std::hypot(box.width, box.height);
  if (!std::isfinite(numbers) || ellipse.width <= 0.0 || ellipse.length > longest) return std::nullopt;
  return ellipse;
}

std::vector<ContourDefect> findDefects(const std::vector<cv::Point>& outline, double min_depth)
{
  std::vector<int> hull;
  cv::convexHull(outline, hull, false, false);
  std::vector<cv::Vec4i> found;
  if (hull.size() < 3 || outline.size() < 4) return {};
  try
  {
    cv::convexityDefects(outline, hull, found);
  }
  catch (const cv::Exception&)  // the outline crosses itself, as that of thin parts may
  {
    return {};
  }
  std::vector<ContourDefect> defects;
  const auto point = [&outline](int index) { return outline[static_cast<std::size_t>(index)]; };
  for (const cv::Vec4i& one : found)
    if (one[3] / kDefectUnit >= min_depth)
      defects.push_back({point(one[0]), point(one[1]), point(one[2]), one[3] / kDefectUnit});
  std::stable_sort(defects.begin(), defects.end(),
                   [](const ContourDefect& a, const ContourDefect& b) { return a.depth > b.depth; });
  return defects;
}

cv::Point2d meanOf(const std::vector<cv::Point>& points)
{
  const cv::Scalar mean = cv::mean(points);
  return {mean[0], mean[1]};
}

/// What encloses the outline, or is fitted to it.
void fitShapes(Contour& contour, const ContourParams& params)
{
  cv::convexHull(contour.outline, contour.hull);
  const double hull_area = cv::contourArea(contour.hull);
  contour.solidity = hull_area > 0.0 ? contour.area / hull_area : 0.0;
  contour.defects = findDefects(contour.outline, params.min_defect);

  // OpenCV takes long to find the circle of many points, and that of the hull is the same.
  cv::Point2f center;
  float radius = 0.0F;
  cv::minEnclosingCircle(contour.hull, center, radius);
  contour.circle_center = center;
  contour.circle_radius = radius;
  contour.rectangle = turnedShape(cv::minAreaRect(contour.outline));
  contour.ellipse = fittedEllipse(contour.outline, contour.box);

  cv::Vec4f line;
  cv::fitLine(contour.outline, line, cv::DIST_L2, 0.0, 0.01, 0.01);
  contour.line_angle = asDirection(std::atan2(line[1], line[0]));
  contour.line_point = {line[2], line[3]};
}

/// The name of a convex shape with four corners.
std::string nameOfFour(const Contour& contour)
{
  const TurnedShape& around = contour.rectangle;
  if (contour.area < kMinFilledRectangle * around.length * around.width) return "quadrilateral";
  return around.width >= kMinSquareSides * around.length ? "square" : "rectangle";
}

/// The name of a convex shape with seven corners or more.
std::string nameOfMany(const Contour& contour)
{
  const double circle = CV_PI * contour.circle_radius * contour.circle_radius;
  if (contour.area >= kMinFilledCircle * circle) return "circle";
  if (!contour.ellipse) return "polygon";
  const double ellipse = CV_PI / 4.0 * contour.ellipse->length * contour.ellipse->width;
  return std::abs(contour.area - ellipse) <= kMaxEllipseError * ellipse ? "ellipse" : "polygon";
}

}  // namespace

Contour measureContour(const std::vector<cv::Point>& outline, const ContourParams& params)
{
  Contour contour;
  contour.outline = outline;
  contour.box = cv::boundingRect(outline);
  contour.length = cv::arcLength(outline, true);
  contour.convex = cv::isContourConvex(outline);
  cv::approxPolyDP(outline, contour.approximation, params.epsilon * contour.length, true);

  contour.area = cv::contourArea(outline);
  const cv::Moments moments = cv::moments(outline);
  cv::HuMoments(moments, contour.hu.data());
  const bool has_area = std::abs(moments.m00) > 0.0;
  contour.center = has_area ? cv::Point2d(moments.m10, moments.m01) / moments.m00 : meanOf(outline);
  fitShapes(contour, params);
  contour.shape = nameShape(contour);
  return contour;
}

std::string nameShape(const Contour& contour)
{
  const std::size_t corners = contour.approximation.size();
  if (corners < 3) return "line";
  if (!cv::isContourConvex(contour.approximation)) return "concave";
  switch (corners)
  {
    case 3:
      return "triangle";
    case 4:
      return nameOfFour(contour);
    case 5:
      return "pentagon";
    case 6:
      return "hexagon";
    default:
      return nameOfMany(contour);
  }
}

}  // namespace robot_vision
