#include "flow_corners.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr int kStep = 3;    // px, from one place to the next
constexpr int kRadius = 2;  // px, of the window around a place
// The smaller eigenvalue at the corner of a square that differs by 12 gray levels from what is around it is somewhat
// larger; with noise of a standard deviation of 3 it is half of this where there is nothing else.
constexpr double kMinStrength = 1e5;

/// Products of gradients, summed over the rows of a window, for each column.
class ColumnSums
{
public:
  explicit ColumnSums(int columns)
    : xx_(static_cast<std::size_t>(columns)), xy_(xx_.size()), yy_(xx_.size()), width_(columns)
  {
  }

  void sum(const cv::Mat& derivatives, int row)
  {
    for (std::vector<int>* sums : {&xx_, &xy_, &yy_})
      std::fill(sums->begin(), sums->end(), 0);
    for (int y = row - kRadius; y <= row + kRadius; ++y)
      add(derivatives.ptr<short>(y));
  }

  /// The smaller eigenvalue in the window around a column.
  double strength(int column) const
  {
    int xx = 0, xy = 0, yy = 0;
    for (int x = column - kRadius; x <= column + kRadius; ++x)
    {
      const auto i = static_cast<std::size_t>(x);
      xx += xx_[i];
      xy += xy_[i];
      yy += yy_[i];
    }
    return 0.5 * (xx + static_cast<double>(yy)) - std::hypot(0.5 * (xx - static_cast<double>(yy)), xy);
  }

private:
  void add(const short* gradients)
  {
    int *xx = xx_.data(), *xy = xy_.data(), *yy = yy_.data();
    for (int x = 0; x < width_; ++x)
    {
      const int gx = gradients[2 * x], gy = gradients[2 * x + 1];
      xx[x] += gx * gx;
      xy[x] += gx * gy;
      yy[x] += gy * gy;
    }
  }

  std::vector<int> xx_, xy_, yy_;
  int width_;
};

struct Corner
{
  double strength = kMinStrength;
  cv::Point place{-1, -1};
};

}  // namespace

std::vector<cv::Point2f> flowCorners(const cv::Mat& derivatives, const cv::Mat& mask, int count)
{
  const double side = std::sqrt(static_cast<double>(derivatives.total()) / count);
  const int columns = cvCeil(derivatives.cols / side), rows = cvCeil(derivatives.rows / side);
  std::vector<Corner> best(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  ColumnSums sums(derivatives.cols);
  for (int y = kRadius; y + kRadius < derivatives.rows; y += kStep)
  {
    sums.sum(derivatives, y);
    Corner* cells = &best[static_cast<std::size_t>(cvFloor(y / side)) * static_cast<std::size_t>(columns)];
    for (int x = kRadius; x + kRadius < derivatives.cols; x += kStep)
    {
      if (!mask.empty() && mask.at<uchar>(y, x) != 0) continue;
      Corner& cell = cells[cvFloor(x / side)];
      const double strength = sums.strength(x);
      if (strength > cell.strength) cell = {strength, {x, y}};
    }
  }
  std::vector<cv::Point2f> points;
  for (const Corner& corner : best)
    if (corner.place.x >= 0) points.emplace_back(corner.place);
  return points;
}

}  // namespace robot_vision
