#include "robot_vision/line/line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// The regions of a mask, from index 1 on. Only the part of the mask that is around them is looked at.
struct Regions
{
  explicit Regions(const cv::Mat& mask) : part(cv::boundingRect(mask))
  {
    if (!part.empty()) count = cv::connectedComponentsWithStats(mask(part), labels, stats, centers, 8);
  }

  int area(int i) const { return stats(i, cv::CC_STAT_AREA); }
  int areaOfAll() const { return part.area() - area(0); }
  cv::Point2d center(int i) const { return cv::Point2d(centers(i, 0), centers(i, 1)) + cv::Point2d(part.tl()); }
  cv::Rect box(int i) const
  {
    return cv::Rect(stats(i, cv::CC_STAT_LEFT), stats(i, cv::CC_STAT_TOP), stats(i, cv::CC_STAT_WIDTH),
                    stats(i, cv::CC_STAT_HEIGHT)) +
           part.tl();
  }
  /// The pixels of a region in its box, 255.
  cv::Mat pixels(int i) const { return labels(box(i) - part.tl()) == i; }

  cv::Rect part;
  int count = 1;
  cv::Mat_<int> labels, stats;
  cv::Mat_<double> centers;
};

/// The index of the region that is the line, or 0 if there is none. `width` is that of the mask.
int chooseLine(const Regions& regions, int width, double min_area, const Line& previous)
{
  const double half_score_distance = width / 8.0;  // px
  int best = 0;
  double best_score = 0.0;
  for (int i = 1; i < regions.count; ++i)
  {
    if (regions.area(i) < min_area) continue;
    const double distance = previous.found ? (regions.center(i).x - previous.center.x) / half_score_distance : 0.0;
    const double score = regions.area(i) / (1.0 + distance * distance);
    if (score <= best_score) continue;
    best = i;
    best_score = score;
  }
  return best;
}

constexpr double kMaxShare = 0.75;  // of the mask that a line fills

/// A straight line through the middles of a region's rows.
struct Fit
{
  double slope = 0.0;     // px that the middles move to the right from row to row
  double residual = 0.0;  // px, root mean square
  double width = 1.0;     // px, mean length of the rows
  double in_view = 0.0;   // share of the rows that are whole; only these are used
};

/// Fits a line to the rows of a region. `region` (CV_8UC1) has the size of the region's box; `cut_left` and `cut_right`
/// say whether the box ends at the border of the image.
Fit fitRows(const cv::Mat& region, bool cut_left, bool cut_right)
{
  int rows = 0;
  double w = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0, wyy = 0.0;
  for (int y = 0; y < region.rows; ++y)
  {
    const auto* pixels = region.ptr<std::uint8_t>(y);
    if ((cut_left && pixels[0]) || (cut_right && pixels[region.cols - 1])) continue;
    double count = 0.0, sum = 0.0;
    for (int x = 0; x < region.cols; ++x)
    {
      if (pixels[x] == 0) continue;
      count += 1.0;
      sum += x;
    }
    ++rows;
    w += count;
    wx += sum;
    wy += count * y;
    wxx += sum * sum / count;
    wxy += sum * y;
    wyy += count * y * y;
  }
  Fit fit;
  fit.in_view = static_cast<double>(rows) / region.rows;
  if (rows == 0) return fit;
  const double sxx = wxx - wx * wx / w, sxy = wxy - wx * wy / w, syy = wyy - wy * wy / w;
  if (rows > 1) fit.slope = sxy / syy;
  fit.residual = std::sqrt(std::max(sxx - fit.slope * sxy, 0.0) / w);
  fit.width = w / rows;
  return fit;
}

/// The angle as in Line, and the fit that gives it.
std::pair<double, Fit> direction(const cv::Mat& region, const cv::Rect& box, const cv::Size& image)
{
  const bool left = box.x == 0, right = box.br().x == image.width;
  const bool top = box.y == 0, bottom = box.br().y == image.height;
  const Fit along_rows = fitRows(region, left, right);
  const Fit along_columns = fitRows(region.t(), top, bottom);
  const bool upright = along_rows.in_view == along_columns.in_view && box.height >= box.width;
  if (along_rows.in_view > along_columns.in_view || upright) return {std::atan(-along_rows.slope), along_rows};
  // From column to column the middles move down by the slope.
  const double to_right = std::atan2(1.0, -along_columns.slope);
  return {to_right > CV_PI / 2.0 ? to_right - CV_PI : to_right, along_columns};
}

}  // namespace

Line findLine(const cv::Mat& mask, const LineParams& params, const Line& previous)
{
  validate(params);
  checkPixels(mask, "mono8");
  const Regions regions(mask);
  const int chosen = chooseLine(regions, mask.cols, params.min_area, previous);
  Line line;
  if (chosen == 0) return line;

  const cv::Rect box = regions.box(chosen);
  const cv::Mat region = regions.pixels(chosen);
  const auto [angle, fit] = direction(region, box, mask.size());
  line.angle = angle;
  line.found = true;
  line.center = regions.center(chosen);
  line.offset = line.center.x - (mask.cols - 1) / 2.0;
  line.error = line.offset / (mask.cols / 2.0);
  line.area = regions.area(chosen);

  const double bend = fit.residual / fit.width;
  const double white = regions.areaOfAll();
  const double large = line.area / (line.area + params.min_area), straight = 1.0 / (1.0 + bend * bend);
  const bool is_floor = line.area > kMaxShare * static_cast<double>(mask.total());
  line.confidence = is_floor ? 0.0 : line.area / white * fit.in_view * large * straight;

  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(region, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE, box.tl());
  line.outline = std::move(outlines.front());
  return line;
}

}  // namespace robot_vision
