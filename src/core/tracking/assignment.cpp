#include "robot_vision/tracking/assignment.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxGain = 1e12;  // sums of such numbers are still exact enough, and never infinite

/// Assigns every row a column at the least sum of costs; there are at least as many columns as rows.
class LeastCost
{
public:
  explicit LeastCost(const cv::Mat_<double>& costs)
    : costs_(costs),
      column_of_(count(costs.rows), -1),
      row_of_(count(costs.cols), -1),
      row_before_(count(costs.cols)),
      reached_(count(costs.cols)),
      distance_(count(costs.cols)),
      row_price_(count(costs.rows), 0.0),
      column_price_(count(costs.cols), 0.0)
  {
    for (int row = 0; row < costs.rows; ++row)
      addRow(row);
  }

  const std::vector<int>& columns() const { return column_of_; }

private:
  static std::size_t count(int number) { return static_cast<std::size_t>(number); }

  /// Gives one more row a column, and others new ones along the path that costs least.
  void addRow(int start)
  {
    double length = 0.0;
    const std::size_t end = shortestPath(start, length);
    row_price_[count(start)] += length;
    for (std::size_t column = 0; column < reached_.size(); ++column)
    {
      if (!reached_[column] || column == end) continue;
      row_price_[count(row_of_[column])] += length - distance_[column];
      column_price_[column] -= length - distance_[column];
    }
    for (int column = static_cast<int>(end), row = -1; row != start;)
    {
      row = row_before_[count(column)];
      row_of_[count(column)] = row;
      std::swap(column, column_of_[count(row)]);
    }
  }

  /// Dijkstra's search from a row to the nearest column that is free, over costs reduced by the prices.
  std::size_t shortestPath(int row, double& length)
  {
    reached_.assign(reached_.size(), false);
    distance_.assign(distance_.size(), std::numeric_limits<double>::infinity());
    while (true)
    {
      const std::size_t nearest = nearestFrom(row, length);
      length = distance_[nearest];
      reached_[nearest] = true;
      if (row_of_[nearest] < 0) return nearest;
      row = row_of_[nearest];
    }
  }

  /// The nearest column that was not reached yet, after the ways by a row at this distance were tried.
  std::size_t nearestFrom(int row, double length)
  {
    const double* cost = costs_[row];
    const double base = length - row_price_[count(row)];
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t column = 0; column < reached_.size(); ++column)
    {
      if (reached_[column]) continue;
      const double way = base + cost[column] - column_price_[column];
      if (way < distance_[column])
      {
        distance_[column] = way;
        row_before_[column] = row;
      }
      if (distance_[column] >= least) continue;
      least = distance_[column];
      nearest = column;
    }
    return nearest;
  }

  const cv::Mat_<double>& costs_;
  std::vector<int> column_of_, row_of_, row_before_;
  std::vector<char> reached_;
  std::vector<double> distance_, row_price_, column_price_;
};

/// The parts of a set of nodes that are joined to each other.
class Parts
{
public:
  explicit Parts(int nodes) : parent_(static_cast<std::size_t>(nodes)) { std::iota(parent_.begin(), parent_.end(), 0); }

  int of(int node)
  {
    int& parent = parent_[static_cast<std::size_t>(node)];
    while (parent != parent_[static_cast<std::size_t>(parent)])
      parent = parent_[static_cast<std::size_t>(parent)];
    return parent;
  }

  void join(int a, int b) { parent_[static_cast<std::size_t>(of(a))] = of(b); }

private:
  std::vector<int> parent_;
};

struct Part
{
  std::vector<int> rows, columns;
};

std::vector<Part> partsOf(const cv::Mat_<double>& gains)
{
  Parts joined(gains.rows + gains.cols);
  for (int row = 0; row < gains.rows; ++row)
    for (int column = 0; column < gains.cols; ++column)
      if (gains(row, column) > 0.0) joined.join(row, gains.rows + column);
  std::vector<Part> parts(static_cast<std::size_t>(gains.rows + gains.cols));
  for (int row = 0; row < gains.rows; ++row)
    parts[static_cast<std::size_t>(joined.of(row))].rows.push_back(row);
  for (int column = 0; column < gains.cols; ++column)
    parts[static_cast<std::size_t>(joined.of(gains.rows + column))].columns.push_back(column);
  return parts;
}

void assignPart(const cv::Mat_<double>& gains, const Part& part, std::vector<int>& columns)
{
  // A pair that must not be made costs as much as none, so that every row can have a column.
  const bool turned = part.rows.size() > part.columns.size();
  const std::vector<int>& few = turned ? part.columns : part.rows;
  const std::vector<int>& many = turned ? part.rows : part.columns;
  cv::Mat_<double> costs(static_cast<int>(few.size()), static_cast<int>(many.size()));
  for (int i = 0; i < costs.rows; ++i)
    for (int j = 0; j < costs.cols; ++j)
    {
      const int a = few[static_cast<std::size_t>(i)], b = many[static_cast<std::size_t>(j)];
      costs(i, j) = -std::max(turned ? gains(b, a) : gains(a, b), 0.0);
    }
  const LeastCost solved(costs);
  for (int i = 0; i < costs.rows; ++i)
  {
    const int j = solved.columns()[static_cast<std::size_t>(i)];
    if (costs(i, j) == 0.0) continue;
    const int a = few[static_cast<std::size_t>(i)], b = many[static_cast<std::size_t>(j)];
    columns[static_cast<std::size_t>(turned ? b : a)] = turned ? a : b;
  }
}

}  // namespace

std::vector<int> bestAssignment(const cv::Mat_<double>& gains)
{
  for (int row = 0; row < gains.rows; ++row)
    for (int column = 0; column < gains.cols; ++column)
      if (!(std::abs(gains(row, column)) <= kMaxGain))
        requireRange("gains[" + std::to_string(row) + "][" + std::to_string(column) + "]", gains(row, column),
                     -kMaxGain, kMaxGain);
  std::vector<int> columns(static_cast<std::size_t>(gains.rows), -1);
  for (const Part& part : partsOf(gains))
    if (!part.rows.empty() && !part.columns.empty()) assignPart(gains, part, columns);
  return columns;
}

}  // namespace robot_vision
