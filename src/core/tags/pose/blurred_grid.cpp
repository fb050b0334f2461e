#include "blurred_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robot_vision/tags/detection/tag_families.hpp"

namespace robot_vision
{

namespace
{

constexpr int kMaxSigmas = 4;       // the blur is cut off at this distance
constexpr int kMaxCells = 12;       // cells of a row or column that may be within the blur
constexpr int kNodesPerSigma = 64;  // of the table; between the nodes the share has an error of at most 1e-7
constexpr int kNodes = 2 * kMaxSigmas * kNodesPerSigma + 1;

/// The share of a one-dimensional blur on one side of a boundary, and its first three derivatives by the boundary's
/// position in sigmas.
using BoundaryShare = std::array<double, 4>;

/// The shares of the cells along one axis in the blur around a position. They are not set to 0 first, which would take
/// longer than to compute them.
struct AxisShares
{
  int first, count;                         // the cells within the blur
  std::array<BoundaryShare, kMaxCells> of;  // of each of them
  BoundaryShare all;                        // their sum
};

BoundaryShare difference(const BoundaryShare& a, const BoundaryShare& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
}

void add(const BoundaryShare& share, BoundaryShare& sum)
{
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] += share[i];
}

/// The products of all numbers of a column's share with all of a row's.
cv::Matx44d product(const BoundaryShare& column, const BoundaryShare& row)
{
  cv::Matx44d m = cv::Matx44d::zeros();
  for (int i = 0; i < 16; ++i)
    m.val[i] = column[static_cast<std::size_t>(i / 4)] * row[static_cast<std::size_t>(i % 4)];
  return m;
}

/// The cumulative normal distribution and its density at z sigmas.
struct Normal
{
  double z, share, density;
};

std::array<Normal, kNodes> normalTable()
{
  std::array<Normal, kNodes> table;
  for (int i = 0; i < kNodes; ++i)
  {
    const double z = static_cast<double>(i) / kNodesPerSigma - kMaxSigmas;
    table[static_cast<std::size_t>(i)] = {z, std::erfc(-z / std::sqrt(2.0)) / 2.0,
                                          std::exp(-z * z / 2.0) / std::sqrt(2.0 * CV_PI)};
  }
  return table;
}

const std::array<Normal, kNodes> kNormalTable = normalTable();

/// The share of the blur before a boundary at `z` sigmas, by a Taylor series from the nearest node of the table.
BoundaryShare cumulative(double z)
{
  if (z < -kMaxSigmas) return {0.0, 0.0, 0.0, 0.0};
  if (z > kMaxSigmas) return {1.0, 0.0, 0.0, 0.0};
  const Normal& node = kNormalTable[static_cast<std::size_t>(cvRound((z + kMaxSigmas) * kNodesPerSigma))];
  const double d = z - node.z;
  const double density = node.density * (1.0 - d * (node.z + d / 2.0 * (1.0 - node.z * node.z)));
  return {node.share + node.density * d * (1.0 - d / 2.0 * node.z), density, -z * density, (z * z - 1.0) * density};
}

AxisShares sharesAt(double position, double sigma, int width)
{
  AxisShares shares;
  shares.count = 0;
  const double reach = std::min(kMaxSigmas * sigma, kMaxCells / 2.0 - 1.0), per_cell = 1.0 / sigma;
  shares.first = std::max(0, cvFloor(position - reach));
  const int end = std::min(width, cvFloor(position + reach) + 1);
  const BoundaryShare begin = cumulative((shares.first - position) * per_cell);
  BoundaryShare last = begin;
  for (int i = shares.first; i < end; ++i)
  {
    const BoundaryShare next = cumulative((i + 1 - position) * per_cell);
    shares.of[static_cast<std::size_t>(shares.count++)] = difference(next, last);
    last = next;
  }
  shares.all = difference(last, begin);
  return shares;
}

/// The share of an area and its derivatives. `m` sums, over the area's cells, the products of the cell's shares along x
/// and y and of their derivatives; `c` is the correlation. The distribution of two correlated variables is computed by
/// Pearson's tetrachoric series, without terms of fourth derivatives.
BlurredArea areaOf(const cv::Matx44d& m, const cv::Point2d& sigma, double c)
{
  return {m(0, 0) + c * (m(1, 1) + c / 2.0 * (m(2, 2) + c / 3.0 * m(3, 3))),
          {-(m(1, 0) + c * (m(2, 1) + c / 2.0 * m(3, 2))) / sigma.x,
           -(m(0, 1) + c * (m(1, 2) + c / 2.0 * m(2, 3))) / sigma.y},
          {(m(2, 0) + c * (m(3, 1) + m(1, 1))) / sigma.x, (m(0, 2) + c * (m(1, 3) + m(1, 1))) / sigma.y},
          m(1, 1) + c * (m(2, 2) + c / 2.0 * m(3, 3))};
}

}  // namespace

BlurredGrid::BlurredGrid(const cv::Mat& cells) : cells_(cells), all_known_(cv::countNonZero(cells == kFreeCell) == 0)
{
}

BlurredPoint BlurredGrid::at(const cv::Point2d& point, const cv::Point2d& sigma, double correlation) const
{
  const AxisShares columns = sharesAt(point.x, sigma.x, cells_.cols), rows = sharesAt(point.y, sigma.y, cells_.rows);
  cv::Matx44d white = cv::Matx44d::zeros(), known = product(columns.all, rows.all);
  for (int r = 0; r < rows.count; ++r)
  {
    const auto* row = cells_.ptr<uchar>(rows.first + r) + columns.first;
    const BoundaryShare& of_row = rows.of[static_cast<std::size_t>(r)];
    BoundaryShare white_in_row = {}, free_in_row = {};
    for (int c = 0; c < columns.count; ++c)
      if (row[c] != 0) add(columns.of[static_cast<std::size_t>(c)], row[c] == kFreeCell ? free_in_row : white_in_row);
    white += product(white_in_row, of_row);
    if (!all_known_) known -= product(free_in_row, of_row);
  }
  return {areaOf(white, sigma, correlation), areaOf(known, sigma, correlation)};
}

}  // namespace robot_vision
