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

constexpr double kSampleCount = 320.0;    // about; more would determine the corners better than a lens is known
constexpr double kMaxEdgeDistance = 2.5;  // px; pixels farther from an edge tell nothing about its position

/// A cell whose colour differs from that of the next one to the right (is_upright) or below.
struct Edge
{
  cv::Point cell;
  bool is_upright;
};

void requireType(const std::string& name, const cv::Mat& image)
{
  const std::string expected = "not empty, 1 x 8 bits (CV_8UC1)";
  require(!image.empty(), name, "empty", expected);
  require(image.type() == CV_8UC1, name, describePixels(image.type()), expected);
}

/// Where a pixel would be without the distortion of the lens, px from the principal point.
cv::Point2d undistorted(const cv::Point2d& pixel, const CameraModel& camera)
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

/// True if all cells within `reach` of a point, in cells along both axes, have known colours.
bool isSurroundedByKnownCells(const cv::Mat& cells, const cv::Point2d& point, const cv::Point2d& reach)
{
  const int left = cvFloor(point.x - reach.x), right = cvCeil(point.x + reach.x);
  const int top = cvFloor(point.y - reach.y), bottom = cvCeil(point.y + reach.y);
  if (left < 0 || top < 0 || right > cells.cols || bottom > cells.rows) return false;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      if (cells.at<uchar>(y, x) == kFreeCell) return false;
  return true;
}

/// Points near the edges of a template whose cells have this size (px), in the coordinates of toTemplate(). Points near
/// unknown cells are left out, because the colour of those is blurred into them.
std::vector<cv::Point2d> pointsNearEdges(const cv::Mat& cells, const cv::Size2d& cell_size)
{
  const std::vector<Edge> edges = edgesOf(cells);
  const auto points_of_edge = std::max(1, cvRound(kSampleCount / static_cast<double>(edges.size())));
  const cv::Point2d reach(std::min(0.5, kMaxEdgeDistance / cell_size.width),
                          std::min(0.5, kMaxEdgeDistance / cell_size.height));
  std::vector<cv::Point2d> points;
  // Roberts' R2 sequence spreads any number of points evenly.
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
      if (isSurroundedByKnownCells(cells, point, reach)) points.push_back(point / cells.cols - cv::Point2d(0.5, 0.5));
    }
  return points;
}

/// The pixels near the edges of a template, each once.
std::vector<GraySample> samplesOf(const cv::Mat& gray, const TagTemplate& tag_template, const Corners& corners,
                                  const CameraModel& camera)
{
  const cv::Matx33d H = toTemplate(corners, tag_template).inv();
  const double side = 2.0 * tag_template.widthAtBorder();
  const cv::Size2d cell_size((cv::norm(corners[1] - corners[0]) + cv::norm(corners[2] - corners[3])) / side,
                             (cv::norm(corners[2] - corners[1]) + cv::norm(corners[3] - corners[0])) / side);
  const cv::Rect2d image(-0.5, -0.5, gray.cols, gray.rows);
  std::vector<std::pair<int, GraySample>> found;  // by the number of the pixel
  for (const cv::Point2d& point : pointsNearEdges(tag_template.cells, cell_size))
  {
    const cv::Point2d position = mapped(H, point).point, ray(position.x / camera.K(0, 0), position.y / camera.K(1, 1));
    const Projection seen = camera.projection({ray.x, ray.y, 1.0});
    if (!image.contains(seen.pixel)) continue;
    const cv::Point pixel(cvRound(seen.pixel.x), cvRound(seen.pixel.y));
    // From there to the middle of the pixel, the distortion is taken to be linear.
    const cv::Vec2d rest = seen.jacobian.get_minor<2, 2>(0, 0).solve(
        cv::Vec2d(pixel.x - seen.pixel.x, pixel.y - seen.pixel.y), cv::DECOMP_LU);
    const cv::Point2d middle = position + cv::Point2d(rest[0] * camera.K(0, 0), rest[1] * camera.K(1, 1));
    found.push_back({pixel.y * gray.cols + pixel.x, {middle, static_cast<double>(gray.at<uchar>(pixel))}});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<GraySample> samples;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (i == 0 || found[i].first != found[i - 1].first) samples.push_back(found[i].second);
  return samples;
}

/// Puts the corners and their covariance back into the distorted image.
TagCorners distorted(int id, const FittedCorners& found, const CameraModel& camera)
{
  TagCorners tag{id, {}, {}};
  CornerCovariance jacobian = CornerCovariance::zeros();
  for (int i = 0; i < 4; ++i)
  {
    const cv::Point2d& position = found.corners[static_cast<std::size_t>(i)];
    const Projection seen = camera.projection({position.x / camera.K(0, 0), position.y / camera.K(1, 1), 1.0});
    tag.corners[static_cast<std::size_t>(i)] = seen.pixel;
    for (const int row : {0, 1})
      for (const int column : {0, 1})
        jacobian(2 * i + row, 2 * i + column) = seen.jacobian(row, column) / camera.K(column, column);
  }
  const CornerCovariance product = jacobian * found.covariance * jacobian.t();
  tag.covariance = 0.5 * (product + product.t());  // rounding may make it slightly asymmetric
  return tag;
}

}  // namespace

std::optional<TagCorners> measureCorners(const cv::Mat& gray, const cv::Mat& cells, int width_at_border,
                                         const TagCorners& near, const CameraModel& camera)
{
  requireType("gray", gray);
  requireType("cells", cells);
  const int min_cells = width_at_border + 2;  // the border and one ring of cells around it
  require(
      width_at_border > 0 && cells.cols == cells.rows && cells.cols >= min_cells && (cells.cols - min_cells) % 2 == 0,
      "cells", toText(cells.size()),
      "those of a tag that is " + std::to_string(width_at_border) + " wide at its border");
  validate(camera);
  const TagTemplate tag_template{cells, (cells.cols - width_at_border) / 2};
  Corners corners;
  std::transform(near.corners.begin(), near.corners.end(), corners.begin(),
                 [&camera](const cv::Point2d& pixel) { return undistorted(pixel, camera); });
  const auto found = fitTemplate(tag_template, samplesOf(gray, tag_template, corners, camera), corners);
  if (!found) return std::nullopt;
  const TagCorners tag = distorted(near.id, *found, camera);
  return isCovariance(*tag.covariance) ? std::make_optional(tag) : std::nullopt;
}

}  // namespace robot_vision
