#include "robot_vision/tags/pose/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "corner_covariance.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"
#include "template_fit.hpp"

namespace robot_vision
{

namespace
{

using Corners = std::array<cv::Point2d, 4>;

constexpr double kSamples = 320.0;  // about: more tell more than is known of a lens
constexpr double kBeside = 2.5;     // px from an edge, where the picture tells its place

/// A cell that is not of the next one's colour, to the right or below.
struct Edge
{
  cv::Point cell;
  bool is_upright;
};

void requireType(const std::string& name, const cv::Mat& picture)
{
  const std::string expected = "not empty, 1 x 8 bits (CV_8UC1)";
  require(!picture.empty(), name, "empty", expected);
  require(picture.type() == CV_8UC1, name, describePixels(picture.type()), expected);
}

/// Where a pixel would be without the lens.
cv::Point2d straight(const cv::Point2d& pixel, const CameraModel& camera)
{
  const cv::Point2d ray = camera.ray(pixel);
  return {ray.x * camera.K(0, 0), ray.y * camera.K(1, 1)};
}

std::vector<Edge> edgesOf(const cv::Mat& cells)
{
  std::vector<Edge> edges;
  for (int y = 0; y < cells.rows; ++y)
    for (int x = 0; x < cells.cols; ++x)
      for (const bool is_upright : {true, false})
      {
        const cv::Point next = is_upright ? cv::Point(x + 1, y) : cv::Point(x, y + 1);
        if (next.x == cells.cols || next.y == cells.rows) continue;
        const int level = cells.at<uchar>(y, x), next_level = cells.at<uchar>(next);
        const bool are_known = level != kFreeCell && next_level != kFreeCell;
        if (are_known && level != next_level) edges.push_back({{x, y}, is_upright});
      }
  return edges;
}

/// Whether a point, in cells, and all that is so far from it along both sides has known colours.
bool isAmongKnown(const cv::Mat& cells, const cv::Point2d& point, const cv::Point2d& reach)
{
  const int left = cvFloor(point.x - reach.x), right = cvCeil(point.x + reach.x);
  const int top = cvFloor(point.y - reach.y), bottom = cvCeil(point.y + reach.y);
  if (left < 0 || top < 0 || right > cells.cols || bottom > cells.rows) return false;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      if (cells.at<uchar>(y, x) == kFreeCell) return false;
  return true;
}

/// Points about the edges of a pattern, of which the cells have this size (px): as toPattern() counts. Not beside what
/// may have any colour, which is blurred into them.
std::vector<cv::Point2d> pointsNearEdges(const cv::Mat& cells, const cv::Size2d& cell_size)
{
  const std::vector<Edge> edges = edgesOf(cells);
  const auto points_of_edge = std::max(1, cvRound(kSamples / static_cast<double>(edges.size())));
  const cv::Point2d reach(std::min(0.5, kBeside / cell_size.width), std::min(0.5, kBeside / cell_size.height));
  std::vector<cv::Point2d> points;
  // Roberts' R2 sequence: evenly spread with any number of them.
  double along = 0.0, across = 0.0;
  for (const Edge& edge : edges)
    for (int i = 0; i < points_of_edge; ++i)
    {
      along = std::fmod(along + 0.7548776662466927, 1.0);
      across = std::fmod(across + 0.5698402909980532, 1.0);
      const double beside = 2.0 * across - 1.0;
      const cv::Point2d in_cell =
          edge.is_upright ? cv::Point2d(1.0 + beside * reach.x, along) : cv::Point2d(along, 1.0 + beside * reach.y);
      const cv::Point2d point = cv::Point2d(edge.cell) + in_cell;
      if (isAmongKnown(cells, point, reach)) points.push_back(point / cells.cols - cv::Point2d(0.5, 0.5));
    }
  return points;
}

/// The pixels about the edges of a pattern, each once.
std::vector<GreySample> samplesOf(const cv::Mat& gray, const Pattern& pattern, const Corners& corners,
                                  const CameraModel& camera)
{
  const cv::Matx33d H = toPattern(corners, pattern).inv();
  const double side = 2.0 * pattern.widthAtBorder();
  const cv::Size2d cell_size((cv::norm(corners[1] - corners[0]) + cv::norm(corners[2] - corners[3])) / side,
                             (cv::norm(corners[2] - corners[1]) + cv::norm(corners[3] - corners[0])) / side);
  const cv::Rect2d picture(-0.5, -0.5, gray.cols, gray.rows);
  std::vector<std::pair<int, GreySample>> found;  // by the number of the pixel
  for (const cv::Point2d& point : pointsNearEdges(pattern.cells, cell_size))
  {
    const cv::Point2d place = mapped(H, point).point, ray(place.x / camera.K(0, 0), place.y / camera.K(1, 1));
    const Projection seen = camera.projection({ray.x, ray.y, 1.0});
    if (!picture.contains(seen.pixel)) continue;
    const cv::Point pixel(cvRound(seen.pixel.x), cvRound(seen.pixel.y));
    // The lens hardly changes from there to the middle of the pixel.
    const cv::Vec2d rest = seen.jacobian.get_minor<2, 2>(0, 0).solve(
        cv::Vec2d(pixel.x - seen.pixel.x, pixel.y - seen.pixel.y), cv::DECOMP_LU);
    const cv::Point2d middle = place + cv::Point2d(rest[0] * camera.K(0, 0), rest[1] * camera.K(1, 1));
    found.push_back({pixel.y * gray.cols + pixel.x, {middle, static_cast<double>(gray.at<uchar>(pixel))}});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<GreySample> samples;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (i == 0 || found[i].first != found[i - 1].first) samples.push_back(found[i].second);
  return samples;
}

/// With the lens again.
TagCorners throughLens(int id, const FittedPattern& found, const CameraModel& camera)
{
  TagCorners tag{id, {}, {}};
  CornerCovariance bent = CornerCovariance::zeros();
  for (int i = 0; i < 4; ++i)
  {
    const cv::Point2d& place = found.corners[static_cast<std::size_t>(i)];
    const Projection seen = camera.projection({place.x / camera.K(0, 0), place.y / camera.K(1, 1), 1.0});
    tag.corners[static_cast<std::size_t>(i)] = seen.pixel;
    for (const int row : {0, 1})
      for (const int column : {0, 1})
        bent(2 * i + row, 2 * i + column) = seen.jacobian(row, column) / camera.K(column, column);
  }
  const CornerCovariance product = bent * found.covariance * bent.t();
  tag.covariance = 0.5 * (product + product.t());  // where it is hard to solve, it is not as symmetric as it should be
  return tag;
}

}  // namespace

std::optional<TagCorners> measureCorners(const cv::Mat& gray, const cv::Mat& cells, int width_at_border,
                                         const TagCorners& near, const CameraModel& camera)
{
  requireType("gray", gray);
  requireType("cells", cells);
  const int least = width_at_border + 2;  // the rings on both sides of the border
  require(width_at_border > 0 && cells.cols == cells.rows && cells.cols >= least && (cells.cols - least) % 2 == 0,
          "cells", std::to_string(cells.cols) + "x" + std::to_string(cells.rows),
          "those of a tag that is " + std::to_string(width_at_border) + " wide at its border");
  validate(camera);
  const Pattern pattern{cells, (cells.cols - width_at_border) / 2};
  Corners corners;
  std::transform(near.corners.begin(), near.corners.end(), corners.begin(),
                 [&camera](const cv::Point2d& pixel) { return straight(pixel, camera); });
  const auto found = fitPattern(pattern, samplesOf(gray, pattern, corners, camera), corners);
  if (!found) return std::nullopt;
  const TagCorners tag = throughLens(near.id, *found, camera);
  return isCovariance(*tag.covariance) ? std::make_optional(tag) : std::nullopt;
}

}  // namespace robot_vision
