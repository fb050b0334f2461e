#include "blurred_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robot_vision/tags/detection/tag_families.hpp"

namespace robot_vision
{

namespace
{

constexpr int kReach = 4;      // sigmas beyond which nothing is seen
constexpr int kMax = 12;       // cells in a row that are told apart
constexpr int kPerSigma = 64;  // nodes of the table: between them the share is off by 1e-7 at most
constexpr int kNodes = 2 * kReach * kPerSigma + 1;

/// The share of what is seen that lies on one side of a boundary, and its three derivatives by the boundary in sigmas.
using Share = cv::Vec4d;

/// The shares of a row of cells in what is seen at a position.
struct Shares
{
  int first = 0, count = 0;
  std::array<Share, kMax> of;
  Share all;
};

/// The normal distribution at so many sigmas.
struct Normal
{
  double z, share, density;
};

std::array<Normal, kNodes> normalTable()
{
  std::array<Normal, kNodes> table;
  for (int i = 0; i < kNodes; ++i)
  {
    const double z = static_cast<double>(i) / kPerSigma - kReach;
    table[static_cast<std::size_t>(i)] = {z, std::erfc(-z / std::sqrt(2.0)) / 2.0,
                                          std::exp(-z * z / 2.0) / std::sqrt(2.0 * CV_PI)};
  }
  return table;
}

const std::array<Normal, kNodes> kNormal = normalTable();

/// What is seen before a boundary at `z` sigmas: Taylor's series from the nearest node.
Share before(double z)
{
  if (z < -kReach) return {0.0, 0.0, 0.0, 0.0};
  if (z > kReach) return {1.0, 0.0, 0.0, 0.0};
  const Normal& node = kNormal[static_cast<std::size_t>(cvRound((z + kReach) * kPerSigma))];
  const double d = z - node.z;
  const double density = node.density * (1.0 - d * (node.z + d / 2.0 * (1.0 - node.z * node.z)));
  return {node.share + node.density * d * (1.0 - d / 2.0 * node.z), density, -z * density, (z * z - 1.0) * density};
}

Shares sharesAt(double position, double sigma, int width)
{
  Shares shares;
  const double reach = std::min(kReach * sigma, kMax / 2.0 - 1.0), per_cell = 1.0 / sigma;
  shares.first = std::max(0, cvFloor(position - reach));
  const int end = std::min(width, cvFloor(position + reach) + 1);
  const Share begin = before((shares.first - position) * per_cell);
  Share last = begin;
  for (int i = shares.first; i < end; ++i)
  {
    const Share next = before((i + 1 - position) * per_cell);
    shares.of[static_cast<std::size_t>(shares.count++)] = next - last;
    last = next;
  }
  shares.all = last - begin;
  return shares;
}

/// What is seen of an area, from the sums of its cells' products of a column's and a row's share: the distribution of
/// two correlated variables (Pearson's tetrachoric series), and its derivatives but for fourth ones.
BlurredArea areaOf(const cv::Matx44d& m, const cv::Point2d& sigma, double c)
{
  return {m(0, 0) + c * (m(1, 1) + c / 2.0 * (m(2, 2) + c / 3.0 * m(3, 3))),
          {-(m(1, 0) + c * (m(2, 1) + c / 2.0 * m(3, 2))) / sigma.x,
           -(m(0, 1) + c * (m(1, 2) + c / 2.0 * m(2, 3))) / sigma.y},
          {(m(2, 0) + c * (m(3, 1) + m(1, 1))) / sigma.x, (m(0, 2) + c * (m(1, 3) + m(1, 1))) / sigma.y},
          m(1, 1) + c * (m(2, 2) + c / 2.0 * m(3, 3))};
}

}  // namespace

BlurredGrid::BlurredGrid(const cv::Mat& cells)
  : cells_(cells), are_all_known_(cv::countNonZero(cells == kFreeCell) == 0)
{
}

BlurredPoint BlurredGrid::at(const cv::Point2d& point, const cv::Point2d& sigma, double correlation) const
{
  const Shares columns = sharesAt(point.x, sigma.x, cells_.cols), rows = sharesAt(point.y, sigma.y, cells_.rows);
  cv::Matx44d white = cv::Matx44d::zeros(), known = columns.all * rows.all.t();
  for (int r = 0; r < rows.count; ++r)
  {
    const auto* row = cells_.ptr<uchar>(rows.first + r) + columns.first;
    const Share& of_row = rows.of[static_cast<std::size_t>(r)];
    Share white_in_row, free_in_row;
    for (int c = 0; c < columns.count; ++c)
      if (row[c] != 0) (row[c] == kFreeCell ? free_in_row : white_in_row) += columns.of[static_cast<std::size_t>(c)];
    white += white_in_row * of_row.t();
    if (!are_all_known_) known -= free_in_row * of_row.t();
  }
  return {areaOf(white, sigma, correlation), areaOf(known, sigma, correlation)};
}

}  // namespace robot_vision
