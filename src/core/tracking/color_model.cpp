#include "color_model.hpp"

#include <algorithm>

namespace robot_vision
{
namespace
{

/// The region with its own width and height on every side, as far as the image reaches.
cv::Rect surroundings(const cv::Rect& region, const cv::Size& image)
{
  const cv::Rect around(region.x - region.width, region.y - region.height, 3 * region.width, 3 * region.height);
  return around & cv::Rect({0, 0}, image);
}

/// Lets the bins of a histogram count less that have a share of the background as well. Both are shares of all pixels,
/// whose numbers these are: where little has a colour, each pixel that has one would count for much.
void subtract(const cv::Mat_<float>& background, int background_pixels, int object_pixels, cv::Mat_<float>& object)
{
  if (background_pixels == 0) return;
  auto behind = background.begin();
  for (float& count : object)
  {
    const double expected = static_cast<double>(*behind++) * object_pixels / background_pixels;
    count = static_cast<float>(std::max(0.0, count - expected));
  }
}

}  // namespace

ColorModel::ColorModel(const cv::Mat& bgr, const cv::Rect& region, const WindowTrackerParams& params)
{
  const cv::Rect around = surroundings(region, bgr.size());
  around_ = bgr(around).clone();
  region_ = region - around.tl();
  configure(params);
}

void ColorModel::configure(const WindowTrackerParams& params)
{
  min_saturation_ = params.min_saturation;
  min_value_ = params.min_value;
  const int saturation_bins = params.channels == "hue" ? 1 : params.saturation_bins;
  const HsvPixels pixels(around_, params.min_saturation, params.min_value);
  cv::Mat_<float> object = pixels(region_).histogram(params.hue_bins, saturation_bins);
  if (params.subtract_background)
  {
    const cv::Mat_<float> background = pixels.histogram(params.hue_bins, saturation_bins) - object;
    subtract(background, static_cast<int>(around_.total()) - region_.area(), region_.area(), object);
  }
  histogram_ = object;
}

cv::Mat ColorModel::backProject(const cv::Mat& bgr) const
{
  cv::Mat projection;
  HsvPixels(bgr, min_saturation_, min_value_).backProject(histogram_, projection);
  return projection;
}

}  // namespace robot_vision
