#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/segmentation/segmenter.hpp"

namespace robot_vision
{
namespace
{

const cv::Scalar kWhite(255, 255, 255), kBlack(0, 0, 0);
constexpr int kClickRadius = 4;            // px, of the circle around a click
constexpr double kGoldenRatio = 0.618034;  // of the circle of hues from one label to the next: they never come near
constexpr double kFirstHue = 0.1;          // of the same circle: label 1 is green
constexpr int kUnit = 256;                 // of the weights of two colours

/// Sums over the pixels of a label.
struct Sums
{
  std::int64_t count = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
  cv::Point low{INT32_MAX, INT32_MAX};
  cv::Point high{-1, -1};
};

std::vector<Sums> sumUp(const cv::Mat_<std::uint16_t>& labels)
{
  std::vector<Sums> all(1);
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
    {
      const int label = labels(y, x);
      if (label >= static_cast<int>(all.size())) all.resize(label + 1);
      Sums& sums = all[label];
      ++sums.count;
      sums.x += x;
      sums.y += y;
      sums.low = {std::min(sums.low.x, x), std::min(sums.low.y, y)};
      sums.high = {std::max(sums.high.x, x), std::max(sums.high.y, y)};
    }
  return all;
}

/// The largest connected piece of what is white in a mask, as a region.
Region largestPiece(const cv::Mat& mask)
{
  cv::Mat pieces, statistics, centers;
  const int count = cv::connectedComponentsWithStats(mask, pieces, statistics, centers);
  int best = 1;
  for (int piece = 2; piece < count; ++piece)
    if (statistics.at<int>(piece, cv::CC_STAT_AREA) > statistics.at<int>(best, cv::CC_STAT_AREA)) best = piece;
  cv::Mat only = pieces == best;
  return RegionFinder({/*min_area=*/0.0, /*opening=*/1, /*closing=*/1}).apply(only).front();
}

void checkLabels(const cv::Mat& labels)
{
  checkPixels(labels, "a label", CV_16UC1);
}

/// A colour of each label, BGR, as different as they can be.
std::vector<cv::Vec3b> distinctColors(int count)
{
  cv::Mat_<cv::Vec3b> colors(1, count);
  for (int label = 0; label < count; ++label)
  {
    const double turn = std::fmod(kFirstHue + (label + 1) * kGoldenRatio, 1.0);
    colors(label) = cv::Vec3b(cv::saturate_cast<std::uint8_t>(std::min(180.0 * turn, 179.0)), 210, 255);
  }
  cv::Mat bgr;
  cv::cvtColor(colors, bgr, cv::COLOR_HSV2BGR);
  return {bgr.begin<cv::Vec3b>(), bgr.end<cv::Vec3b>()};
}

/// The mean colour of each label.
std::vector<cv::Vec3b> meanColors(const cv::Mat& bgr, const cv::Mat_<std::uint16_t>& labels, int count)
{
  std::vector<cv::Vec4d> sums(count);  // of the colours, and the number of pixels
  auto color = bgr.begin<cv::Vec3b>();
  for (const std::uint16_t label : labels)
  {
    sums[label] += cv::Vec4d((*color)[0], (*color)[1], (*color)[2], 1);
    ++color;
  }
  std::vector<cv::Vec3b> means(count);
  for (int label = 0; label < count; ++label)
    for (int channel = 0; channel < 3; ++channel)
      means[label][channel] = cv::saturate_cast<std::uint8_t>(sums[label][channel] / std::max(sums[label][3], 1.0));
  return means;
}

}  // namespace

std::vector<Segment> findSegments(const cv::Mat& labels)
{
  checkLabels(labels);
  const std::vector<Sums> all = sumUp(labels);
  std::vector<Segment> segments;
  for (std::size_t label = 1; label < all.size(); ++label)
  {
    const Sums& sums = all[label];
    if (sums.count == 0) continue;
    const cv::Rect box(sums.low, sums.high + cv::Point(1, 1));
    Segment segment{static_cast<int>(label), largestPiece(labels(box) == static_cast<double>(label))};
    Region& region = segment.region;
    const auto area = static_cast<double>(sums.count);
    region.area = area;
    region.center = {static_cast<double>(sums.x) / area, static_cast<double>(sums.y) / area};
    region.box = box;
    region.circle_center += cv::Point2d(box.tl());
    for (cv::Point& point : region.outline)
      point += box.tl();
    segments.push_back(std::move(segment));
  }
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& a, const Segment& b) { return a.region.area > b.region.area; });
  return segments;
}

void paintSegments(const cv::Mat& bgr, const cv::Mat& labels, const SegmentPaintParams& params, cv::Mat& out)
{
  validate(params);
  checkPixels(bgr, "bgr8");
  checkLabels(labels);
  require(labels.size() == bgr.size(), "the labels' size", toText(labels.size()), "the image's, " + toText(bgr.size()));
  double highest = 0.0;
  cv::minMaxLoc(labels, nullptr, &highest);
  const int count = static_cast<int>(highest) + 1;
  const std::vector<cv::Vec3b> colors = params.paint == "mean" ? meanColors(bgr, labels, count) : distinctColors(count);
  const int weight = cvRound(kUnit * params.opacity);
  bgr.copyTo(out);
  for (int y = 0; y < out.rows; ++y)
  {
    const auto* row = labels.ptr<std::uint16_t>(y);
    const auto* below = labels.ptr<std::uint16_t>(std::min(y + 1, out.rows - 1));
    auto* pixels = out.ptr<cv::Vec3b>(y);
    for (int x = 0; x < out.cols; ++x)
    {
      if (params.outlines && (row[x] != row[std::min(x + 1, out.cols - 1)] || row[x] != below[x]))
        pixels[x] = cv::Vec3b(255, 255, 255);
      else if (row[x] > 0)
        for (int channel = 0; channel < 3; ++channel)
        {
          const int mixed = pixels[x][channel] * (kUnit - weight) + colors[row[x]][channel] * weight;
          pixels[x][channel] = static_cast<std::uint8_t>(mixed / kUnit);
        }
    }
  }
}

void drawSeeds(cv::Mat& bgr, const std::vector<SegmentSeed>& seeds)
{
  checkPixels(bgr, "bgr8");
  for (const SegmentSeed& seed : seeds)
    for (const int thickness : {3, 1})  // an outline, visible on any colour
    {
      const cv::Scalar& color = thickness > 1 ? kBlack : kWhite;
      if (seed.region.empty())
        cv::circle(bgr, seed.point, kClickRadius, color, thickness);
      else
        cv::rectangle(bgr, seed.region, color, thickness);
    }
}

}  // namespace robot_vision
