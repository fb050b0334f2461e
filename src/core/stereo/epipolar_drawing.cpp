#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "epipolar_limits.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/overlay.hpp"
#include "robot_vision/stereo/epipolar.hpp"

namespace robot_vision
{
namespace
{

constexpr int kTextX = 8, kTextY = 10;  // px, from the left and from below
constexpr int kDot = 3;                 // px, radius of a point
constexpr double kMinNormal = 1e-12;    // of a line that has no direction
const cv::Scalar kGreen(0, 255, 0), kRed(0, 0, 255), kRow(200, 160, 0);

/// Copies both images beside each other, the lower one filled up with black.
void putBeside(const cv::Mat& left, const cv::Mat& right, cv::Mat& out)
{
  checkPixels(left, "bgr8");
  checkPixels(right, "bgr8");
  out.create(std::max(left.rows, right.rows), left.cols + right.cols, CV_8UC3);
  if (left.rows != right.rows) out.setTo(0);
  left.copyTo(out(cv::Rect({0, 0}, left.size())));
  right.copyTo(out(cv::Rect({left.cols, 0}, right.size())));
}

cv::Mat partOf(cv::Mat& out, const cv::Mat& left, const cv::Mat& right, bool of_right)
{
  return of_right ? out(cv::Rect({left.cols, 0}, right.size())) : out(cv::Rect({0, 0}, left.size()));
}

void drawDot(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& color)
{
  cv::circle(image, {cvRound(at.x), cvRound(at.y)}, kDot, color, 1, cv::LINE_AA);
}

/// Draws what is seen of the line of the points with line . (x, y, 1) = 0.
void drawLine(cv::Mat& image, const cv::Vec3d& line, const cv::Scalar& color)
{
  const double length = std::hypot(line[0], line[1]);
  if (!(length > kMinNormal)) return;
  const cv::Point2d normal(line[0] / length, line[1] / length), middle(image.cols / 2.0, image.rows / 2.0);
  const double distance = normal.dot(middle) + line[2] / length, reach = image.cols + image.rows;
  if (!(std::abs(distance) < reach)) return;  // so that all ends are numbers that OpenCV can draw
  const cv::Point2d nearest = middle - distance * normal, along(-normal.y * reach, normal.x * reach);
  cv::line(image, nearest - along, nearest + along, color, 1, cv::LINE_AA);
}

/// The color of one of `count` things, each of another hue.
cv::Scalar hueOf(int index, int count)
{
  const cv::Mat_<cv::Vec3b> hsv(1, 1, cv::Vec3b(static_cast<uchar>(180 * index / std::max(1, count)), 255, 255));
  cv::Mat_<cv::Vec3b> bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  return {static_cast<double>(bgr(0)[0]), static_cast<double>(bgr(0)[1]), static_cast<double>(bgr(0)[2])};
}

/// The middle one of some numbers, of two the upper one.
double medianOf(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void writeBelow(cv::Mat& out, const std::string& text)
{
  drawText(out, text, {kTextX, out.rows - kTextY});
}

/// "rows differ by 0.3 px, median of 120 matches", or that there are none.
std::string textOf(const char* what, const std::vector<double>& distances)
{
  if (distances.empty()) return "no matches";
  char text[100];
  std::snprintf(text, sizeof(text), "%s by %.2f px, median of %zu matches", what, medianOf(distances),
                distances.size());
  return text;
}

}  // namespace

void drawRectifiedPair(const cv::Mat& left, const cv::Mat& right, const EpipolarParams& params, cv::Mat& out)
{
  validate(params);
  require(left.size() == right.size(), "the right image's size", toText(right.size()),
          toText(left.size()) + " as of the left one");
  putBeside(left, right, out);
  const PairMatches matches = matchPair(left, right, "bgr8", params.epipolar_features);
  const std::vector<double> distances = epipolarDistances(matches, rectifiedFundamental());
  for (int i = 0; i < params.epipolar_lines; ++i)
  {
    const int y = (2 * i + 1) * out.rows / (2 * params.epipolar_lines);
    cv::line(out, {0, y}, {out.cols - 1, y}, kRow);
  }
  cv::Mat parts[] = {partOf(out, left, right, false), partOf(out, left, right, true)};
  for (std::size_t i = 0; i < distances.size(); ++i)
  {
    const cv::Scalar& color = distances[i] <= kMaxEpipolarDistance ? kGreen : kRed;
    drawDot(parts[0], matches.left[i], color);
    drawDot(parts[1], matches.right[i], color);
  }
  writeBelow(out, textOf("rows differ", distances));
}

void drawEpipolarLines(const cv::Mat& left, const cv::Mat& right, const EpipolarParams& params, cv::Mat& out)
{
  validate(params);
  putBeside(left, right, out);
  const PairMatches matches = matchPair(left, right, "bgr8", params.epipolar_features);
  const std::optional<FundamentalMatrix> found = findFundamental(matches);
  if (!found) return writeBelow(out, "no fundamental matrix by " + std::to_string(matches.left.size()) + " matches");
  PairMatches inliers;
  for (std::size_t i = 0; i < matches.left.size(); ++i)
  {
    if (!found->inliers[i]) continue;
    inliers.left.push_back(matches.left[i]);
    inliers.right.push_back(matches.right[i]);
  }
  const int count = std::min(params.epipolar_lines, static_cast<int>(inliers.left.size()));
  cv::Mat of_left = partOf(out, left, right, false), of_right = partOf(out, left, right, true);
  for (int i = 0; i < count; ++i)
  {
    const auto match = inliers.left.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(count);
    const cv::Point2f &from = inliers.left[match], &to = inliers.right[match];
    const cv::Scalar color = hueOf(i, count);
    drawLine(of_left, found->F.t() * cv::Vec3d(to.x, to.y, 1.0), color);
    drawLine(of_right, found->F * cv::Vec3d(from.x, from.y, 1.0), color);
    drawDot(of_left, from, color);
    drawDot(of_right, to, color);
  }
  writeBelow(out, textOf("points are off their lines", epipolarDistances(inliers, found->F)));
}

}  // namespace robot_vision
