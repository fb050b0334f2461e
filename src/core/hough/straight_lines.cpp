#include "straight_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxCells = 1 << 25;      // of an accumulator, 4 bytes each
constexpr double kMaxVotes = 1.2e9;        // of an image, some 1.5 ns each, of segments twice that
constexpr double kCachedCells = 2e6;       // of an accumulator; so many more take the same time again for each vote
constexpr double kRoundingError = 0.001;   // px
constexpr double kMinDirection = 1e-9;     // below it a line is parallel to an axis
constexpr double kDegree = CV_PI / 180.0;  // rad

using Ends = std::pair<cv::Point2d, cv::Point2d>;

/// The range of `t` in which start + t * step is from `low` to `high`; it ends before it begins if there is none.
std::pair<double, double> rangeWithin(double start, double step, double low, double high)
{
  const double infinity = std::numeric_limits<double>::infinity();
  if (std::abs(step) >= kMinDirection) return std::minmax((low - start) / step, (high - start) / step);
  return start >= low && start <= high ? std::pair(-infinity, infinity) : std::pair(infinity, -infinity);
}

/// A coordinate within 0 and `high`, to a millionth of a pixel: a level line stays level.
double cleaned(double coordinate, double high)
{
  const double parts = 1e6;
  return std::clamp(std::round(coordinate * parts) / parts, 0.0, high);
}

/// The ends of the part of a line that is inside of an image, or not farther outside of it than `margin`.
std::optional<Ends> clipped(double rho, double theta, const cv::Size& size, double margin)
{
  const cv::Point2d normal(std::cos(theta), std::sin(theta));
  const cv::Point2d along(-normal.y, normal.x), foot = normal * rho;
  const auto across = rangeWithin(foot.x, along.x, -margin, size.width - 1 + margin);
  const auto down = rangeWithin(foot.y, along.y, -margin, size.height - 1 + margin);
  const double first = std::max(across.first, down.first), last = std::min(across.second, down.second);
  if (first > last) return std::nullopt;
  const auto inside = [&size](const cv::Point2d& point)
  { return cv::Point2d(cleaned(point.x, size.width - 1.0), cleaned(point.y, size.height - 1.0)); };
  return Ends(inside(foot + along * first), inside(foot + along * last));
}

void checkSteps(const cv::Mat& edges, const HoughParams& params)
{
  const cv::Size size = edges.size();
  const std::string of_image = " of an image of " + toText(size);
  // With coarser ones rounding may lead OpenCV to cells beside its accumulator.
  require(params.rho <= std::max(std::min(size.width, size.height) / 3.0, 1.0), "rho", params.rho,
          "at most 1, or a third of the smaller side" + of_image);
  const double cells = 2.0 * (size.width + size.height) / params.rho * (180.0 / params.theta);
  require(cells <= kMaxCells, "rho", params.rho,
          "larger, or theta, " + toText(params.theta) + ": the accumulator" + of_image + " would have " +
              toText(cells) + " cells, more than " + toText(kMaxCells));
  const int count = cv::countNonZero(edges);
  const double votes = count * (180.0 / params.theta) * (1.0 + cells / kCachedCells);
  require(votes <= kMaxVotes, "theta", params.theta,
          "larger, or canny_high, " + toText(params.canny_high) + ": the " + std::to_string(count) + " edge pixels" +
              of_image + " would vote for many seconds");
}

double lengthOf(const HoughLine& line)
{
  return cv::norm(line.end - line.begin);
}

HoughLine segmentOf(const cv::Vec4i& ends)
{
  HoughLine segment;
  segment.begin = {static_cast<double>(ends[0]), static_cast<double>(ends[1])};
  segment.end = {static_cast<double>(ends[2]), static_cast<double>(ends[3])};
  const cv::Point2d along = segment.end - segment.begin;
  segment.theta = std::atan2(along.x, -along.y);
  if (segment.theta < 0.0) segment.theta += CV_PI;
  segment.rho = segment.begin.dot({std::cos(segment.theta), std::sin(segment.theta)});
  return segment;
}

}  // namespace

std::vector<HoughLine> findStraightLines(const cv::Mat& edges, const HoughParams& params)
{
  checkSteps(edges, params);
  const double step = params.theta * kDegree;
  std::vector<cv::Vec3f> found;
  cv::HoughLines(edges, found, params.rho, step, params.threshold);
  std::vector<HoughLine> lines;
  for (const cv::Vec3f& one : found)
  {
    if (static_cast<int>(lines.size()) == params.max_results) break;
    HoughLine line;
    line.rho = one[0];
    line.theta = std::round(one[1] / step) * step;  // with more digits than OpenCV's
    // The line of a cell may be beside the image, by no more than the size of the cell.
    std::optional<Ends> ends;
    for (const double margin : {kRoundingError, params.rho + kRoundingError})
      if (!ends) ends = clipped(line.rho, line.theta, edges.size(), margin);
    if (!ends) continue;
    std::tie(line.begin, line.end) = *ends;
    line.votes = cvRound(one[2]);
    line.score = static_cast<double>(one[2]) / found[0][2];
    lines.push_back(line);
  }
  return lines;
}

std::vector<HoughLine> findSegments(const cv::Mat& edges, const HoughParams& params)
{
  checkSteps(edges, params);
  std::vector<cv::Vec4i> found;
  cv::HoughLinesP(edges, found, params.rho, params.theta * kDegree, params.threshold, params.min_length,
                  params.max_gap);
  std::vector<HoughLine> segments;
  for (const cv::Vec4i& ends : found)
    segments.push_back(segmentOf(ends));
  std::stable_sort(segments.begin(), segments.end(),
                   [](const HoughLine& a, const HoughLine& b) { return lengthOf(a) > lengthOf(b); });
  segments.resize(std::min(segments.size(), static_cast<std::size_t>(params.max_results)));
  const double longest = segments.empty() ? 0.0 : lengthOf(segments[0]);
  for (HoughLine& segment : segments)
    segment.score = longest > 0.0 ? lengthOf(segment) / longest : 1.0;
  return segments;
}

}  // namespace robot_vision
