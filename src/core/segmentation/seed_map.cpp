#include "seed_map.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

int first(int pixel, double scale)
{
  return static_cast<int>(std::floor(pixel * scale));
}

int end(int pixel, double scale)
{
  return static_cast<int>(std::ceil(pixel * scale));
}

/// The pixel of an image of another size that has the middle of this one in it.
int middle(int pixel, double scale)
{
  return static_cast<int>(std::floor((pixel + 0.5) * scale));
}

/// Sets the pixels along the edges of an image.
void setBorder(cv::Mat& image, int width, int value)
{
  const int x = std::min(width, image.cols), y = std::min(width, image.rows);
  image.colRange(0, x).setTo(value);
  image.colRange(image.cols - x, image.cols).setTo(value);
  image.rowRange(0, y).setTo(value);
  image.rowRange(image.rows - y, image.rows).setTo(value);
}

}  // namespace

SeedMap::SeedMap(const std::vector<SegmentSeed>& seeds, const cv::Size& whole, const cv::Size& size,
                 const SegmenterParams& params)
  : size_(size)
{
  const double scale_x = static_cast<double>(size.width) / whole.width;
  const double scale_y = static_cast<double>(size.height) / whole.height;
  radius_ = cvRound(params.seed_radius * scale_x);
  border_ = end(params.border, scale_x);
  int number = 0;
  for (const SegmentSeed& seed : seeds)
  {
    ++number;
    const bool clicked = seed.region.empty();
    const cv::Rect there = (clicked ? cv::Rect(seed.point, cv::Size(1, 1)) : seed.region) & cv::Rect({0, 0}, whole);
    if (there.empty()) continue;
    const cv::Point corner(first(there.x, scale_x), first(there.y, scale_y));
    const cv::Point behind(end(there.br().x, scale_x), end(there.br().y, scale_y));
    const cv::Rect region = cv::Rect(corner, behind) & cv::Rect({0, 0}, size);  // a product may be rounded upwards
    const cv::Point point = clicked ? seed.point : there.tl() + cv::Point(there.width / 2, there.height / 2);
    spots_.push_back(
        {number, clicked ? cv::Rect() : region, cv::Point(middle(point.x, scale_x), middle(point.y, scale_y))});
  }
}

cv::Mat SeedMap::markers(int background) const
{
  cv::Mat markers = cv::Mat::zeros(size_, CV_32SC1);
  if (border_ > 0) setBorder(markers, border_ + 1, background);  // cv::watershed overwrites the outermost pixels
  for (const Spot& spot : spots_)
    if (spot.region.empty())
      cv::circle(markers, spot.point, radius_, spot.number, cv::FILLED);
    else
      markers(spot.region).setTo(spot.number);
  return markers;
}

cv::Mat SeedMap::grabCutMask() const
{
  const bool has_regions =
      std::any_of(spots_.begin(), spots_.end(), [](const Spot& spot) { return !spot.region.empty(); });
  cv::Mat mask(size_, CV_8UC1, cv::Scalar(has_regions ? cv::GC_BGD : cv::GC_PR_FGD));
  if (!has_regions) setBorder(mask, border_, cv::GC_BGD);
  for (const Spot& spot : spots_)
    if (!spot.region.empty()) mask(spot.region).setTo(cv::GC_PR_FGD);
  for (const Spot& spot : spots_)
    if (spot.region.empty()) cv::circle(mask, spot.point, radius_, cv::GC_FGD, cv::FILLED);
  return mask;
}

}  // namespace robot_vision
