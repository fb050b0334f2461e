#include "touching_objects.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace robot_vision
{
namespace
{

constexpr int kMinOpening = 3;  // px of the image that is worked on; a smaller one removes nothing
constexpr int kUnknown = 2;     // px around objects that may belong to them

/// Whether most of the pixels along the edges of a mask are white.
bool isWhiteAround(const cv::Mat& mask)
{
  const int white = cv::countNonZero(mask.row(0)) + cv::countNonZero(mask.row(mask.rows - 1)) +
                    cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1));
  return white > mask.rows + mask.cols;
}

cv::Mat findMask(const cv::Mat& bgr, const SegmenterParams& params, double scale)
{
  cv::Mat gray, mask;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  cv::threshold(gray, mask, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
  if (params.objects == "dark" || (params.objects == "auto" && isWhiteAround(mask))) cv::bitwise_not(mask, mask);
  const int opening = std::max(2 * static_cast<int>(params.opening * scale / 2.0) + 1, kMinOpening);
  if (params.opening > 1)
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {opening, opening}));
  return mask;
}

/// With a frame of one pixel around it.
cv::Mat framed(const cv::Mat& image, int value)
{
  cv::Mat larger;
  cv::copyMakeBorder(image, larger, 1, 1, 1, 1, cv::BORDER_CONSTANT, value);
  return larger;
}

/// The largest distance in each of the components.
std::vector<float> summits(const cv::Mat_<int>& components, int count, const cv::Mat_<float>& distances)
{
  std::vector<float> summits(count, 0.0F);
  for (int y = 0; y < components.rows; ++y)
    for (int x = 0; x < components.cols; ++x)
      summits[components(y, x)] = std::max(summits[components(y, x)], distances(y, x));
  return summits;
}

/// The label of a neighbour above `none`, of those at a side first; `none` if there is none.
int neighborAbove(const cv::Mat_<int>& labels, int x, int y, int none)
{
  const cv::Point around[] = {{0, -1}, {-1, 0}, {1, 0}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  for (const cv::Point& step : around)
  {
    const cv::Point place = cv::Point(x, y) + step;
    if (cv::Rect({0, 0}, labels.size()).contains(place) && labels(place) > none) return labels(place);
  }
  return none;
}

}  // namespace

ObjectSeeds findObjectSeeds(const cv::Mat& bgr, const SegmenterParams& params, double scale)
{
  ObjectSeeds seeds;
  seeds.mask = findMask(bgr, params, scale);
  cv::Mat_<float> distance;
  cv::Mat_<int> components;
  cv::distanceTransform(seeds.mask, distance, cv::DIST_L2, 5);
  const int count = cv::connectedComponents(seeds.mask, components);
  const std::vector<float> highest = summits(components, count, distance);
  cv::Mat_<std::uint8_t> peaks(seeds.mask.size());
  for (int y = 0; y < peaks.rows; ++y)
    for (int x = 0; x < peaks.cols; ++x)
    {
      const int component = components(y, x);
      const auto level = static_cast<float>(params.peak_height) * highest[component];
      peaks(y, x) = component > 0 && distance(y, x) >= level ? 255 : 0;
    }
  seeds.count = cv::connectedComponents(peaks, seeds.markers) - 1;
  return seeds;
}

cv::Mat watershedMarkers(const ObjectSeeds& seeds)
{
  const int side = 2 * kUnknown + 1;
  cv::Mat near, markers = seeds.markers.clone();
  cv::dilate(seeds.mask, near, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  markers.setTo(seeds.count + 1, near == 0);
  return markers;
}

cv::Mat divideObjects(const ObjectSeeds& seeds)
{
  const int background = 1;  // so that all labels above are objects
  cv::Mat mask, labels = seeds.markers.clone();
  labels.setTo(background, seeds.mask == 0);
  cv::add(labels, background, labels, seeds.markers > 0);
  labels = framed(labels, background);  // of which cv::watershed makes a line
  cv::cvtColor(framed(seeds.mask, 0), mask, cv::COLOR_GRAY2BGR);
  cv::watershed(mask, labels);
  const cv::Mat_<int> flooded = labels(cv::Rect({1, 1}, seeds.mask.size()));
  cv::Mat_<int> divided = cv::Mat::zeros(flooded.size(), CV_32SC1);
  for (int y = 0; y < flooded.rows; ++y)
    for (int x = 0; x < flooded.cols; ++x)
    {
      if (seeds.mask.at<std::uint8_t>(y, x) == 0) continue;
      const int label = flooded(y, x) > 0 ? flooded(y, x) : neighborAbove(flooded, x, y, background);
      divided(y, x) = label - background;
    }
  return divided;
}

}  // namespace robot_vision
