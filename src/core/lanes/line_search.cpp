#include "line_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace robot_vision::lanes
{
namespace
{

constexpr int kHistogramBlur = 5;  // px

/// A band of rows, and the histogram of what in it has not been in a window.
struct Band
{
  /// The column with most middles, or -1 if there are too few.
  int peak(int min_rows) const
  {
    double most = 0.0;
    cv::Point place;
    cv::minMaxLoc(histogram, nullptr, &most, nullptr, &place);
    return most >= min_rows ? place.x : -1;
  }

  double middle() const { return (begin + end - 1) / 2.0; }

  int begin, end;  // rows
  cv::Mat_<float> histogram;
};

std::vector<Band> bandsOf(const Middles& middles, int columns, int count)
{
  const int rows = static_cast<int>(middles.size());
  std::vector<Band> bands;  // from the bottom up
  count = std::min(count, rows);
  for (int i = 0; i < count; ++i)
  {
    Band band{rows - (i + 1) * rows / count, rows - i * rows / count, cv::Mat_<float>::zeros(1, columns)};
    for (int row = band.begin; row < band.end; ++row)
      for (const double column : middles[static_cast<std::size_t>(row)])
        band.histogram(0, static_cast<int>(column)) += 1.0F;
    // A line that leans a little is in several columns.
    cv::boxFilter(band.histogram.clone(), band.histogram, CV_32F, {kHistogramBlur, 1}, {-1, -1}, /*normalize=*/false,
                  cv::BORDER_CONSTANT);
    bands.push_back(band);
  }
  return bands;
}

/// Adds the middles in the window around a column to `line`, and takes the window off the histogram. `mean` is set
/// unless they are too few.
bool takeWindow(Band& band, const Middles& middles, double column, double half_width, int min_rows, Places& line,
                cv::Point2d& mean)
{
  const int left = std::max(static_cast<int>(std::ceil(column - half_width)), 0);
  const int right = std::min(static_cast<int>(std::floor(column + half_width)) + 1, band.histogram.cols);
  if (left >= right) return false;
  band.histogram.colRange(left, right) = 0.0F;
  Places inside;
  cv::Point2d sum;
  for (int row = band.begin; row < band.end; ++row)
    for (const double at : middles[static_cast<std::size_t>(row)])
      if (std::abs(at - column) <= half_width)
      {
        inside.emplace_back(at, row);
        sum += inside.back();
      }
  if (static_cast<int>(inside.size()) < min_rows) return false;
  line.insert(line.end(), inside.begin(), inside.end());
  mean = sum * (1.0 / static_cast<double>(inside.size()));
  return true;
}

/// Follows a line upwards from a peak of a band. Where it is not painted it goes on as before.
Places followFrom(std::vector<Band>& bands, std::size_t first, int column, const Middles& middles, double half_width,
                  int min_rows)
{
  Places line;
  cv::Point2d last(column, bands[first].middle());
  double slope = 0.0;  // px to the right for each px upwards
  bool begun = false;
  for (std::size_t i = first; i < bands.size(); ++i)
  {
    const double expected = last.x + slope * (last.y - bands[i].middle());
    cv::Point2d mean;
    if (!takeWindow(bands[i], middles, expected, half_width, min_rows, line, mean)) continue;
    if (begun) slope = (mean.x - last.x) / std::max(last.y - mean.y, 1.0);
    last = mean;
    begun = true;
  }
  return line;
}

}  // namespace

Middles middlesOf(const cv::Mat& mask)
{
  Middles middles(static_cast<std::size_t>(mask.rows));
  for (int y = 0; y < mask.rows; ++y)
  {
    const auto* row = mask.ptr<std::uint8_t>(y);
    for (int begin = 0, end = 0; begin < mask.cols; begin = end + 1)
    {
      for (end = begin; end < mask.cols && row[end];)
        ++end;
      if (end > begin) middles[static_cast<std::size_t>(y)].push_back((begin + end - 1) / 2.0);
    }
  }
  return middles;
}

std::vector<Places> followLines(const Middles& middles, int columns, double half_width, const LaneParams& params)
{
  std::vector<Places> lines;
  std::vector<Band> bands = bandsOf(middles, columns, params.windows);
  for (std::size_t i = 0; i < bands.size(); ++i)
    while (lines.size() < kMaxLines)
    {
      const int column = bands[i].peak(params.min_rows);
      if (column < 0) break;
      lines.push_back(followFrom(bands, i, column, middles, half_width, params.min_rows));
    }
  return lines;
}

Places middlesAround(const Middles& middles, const std::vector<double>& columns, double half_width)
{
  Places found;
  for (std::size_t row = 0; row < middles.size(); ++row)
    for (const double at : middles[row])
      if (std::abs(at - columns[row]) <= half_width) found.emplace_back(at, static_cast<double>(row));
  return found;
}

}  // namespace robot_vision::lanes
