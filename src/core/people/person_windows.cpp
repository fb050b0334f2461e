#include "person_windows.hpp"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>

namespace robot_vision
{
namespace
{

// The work of grouping goes with the square of their number: with mean_shift it is some 0.7 s for so many.
constexpr std::size_t kMaxWindows = 1000;
constexpr double kMaxDifference = 0.2;  // of similar boxes, as a share of their sides: that of detectMultiScale()

void append(const PersonWindows& from, std::size_t i, PersonWindows& to)
{
  to.boxes.push_back(from.boxes[i]);
  to.weights.push_back(from.weights[i]);
  to.scales.push_back(from.scales[i]);
}

/// The windows of one size.
PersonWindows windowsOf(const cv::HOGDescriptor& hog, const cv::Mat& bgr, double scale, const cv::Size& stride,
                        const PeopleParams& params)
{
  cv::Mat smaller = bgr;
  const cv::Size size(cvRound(bgr.cols / scale), cvRound(bgr.rows / scale));
  if (size != bgr.size()) cv::resize(bgr, smaller, size, 0.0, 0.0, cv::INTER_LINEAR_EXACT);
  PersonWindows windows;
  std::vector<cv::Point> corners;
  hog.detect(smaller, corners, windows.weights, params.hit_threshold, stride, {params.padding, params.padding});
  const cv::Size box(cvRound(hog.winSize.width * scale), cvRound(hog.winSize.height * scale));
  for (const cv::Point& corner : corners)
    windows.boxes.emplace_back(cv::Point(cvRound(corner.x * scale), cvRound(corner.y * scale)), box);
  windows.scales.assign(corners.size(), scale);
  return windows;
}

PersonWindows surest(const PersonWindows& windows, std::size_t count)
{
  std::vector<std::size_t> order(windows.boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto is_surer = [&windows](std::size_t a, std::size_t b)
  { return std::make_tuple(-windows.weights[a], a) < std::make_tuple(-windows.weights[b], b); };
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), is_surer);
  order.resize(count);
  std::sort(order.begin(), order.end());
  PersonWindows kept;
  for (const std::size_t i : order)
    append(windows, i, kept);
  return kept;
}

}  // namespace

std::vector<double> windowScales(const cv::Size& image, const cv::Size& window, double step)
{
  std::vector<double> scales;
  for (double scale = 1.0;
       cvRound(image.width / scale) >= window.width && cvRound(image.height / scale) >= window.height; scale *= step)
    scales.push_back(scale);
  return scales;
}

PersonWindows findWindows(const cv::HOGDescriptor& hog, const cv::Mat& bgr, const cv::Size& stride,
                          const PeopleParams& params)
{
  const std::vector<double> scales = windowScales(bgr.size(), hog.winSize, params.scale);
  std::vector<PersonWindows> of_sizes(scales.size());
  cv::parallel_for_(cv::Range(0, static_cast<int>(scales.size())),
                    [&](const cv::Range& range)
                    {
                      for (int i = range.start; i < range.end; ++i)
                      {
                        const auto size = static_cast<std::size_t>(i);
                        of_sizes[size] = windowsOf(hog, bgr, scales[size], stride, params);
                      }
                    });
  PersonWindows windows;
  for (const PersonWindows& of_size : of_sizes)
    for (std::size_t i = 0; i < of_size.boxes.size(); ++i)
      append(of_size, i, windows);
  return windows.boxes.size() > kMaxWindows ? surest(windows, kMaxWindows) : windows;
}

void groupWindows(const cv::HOGDescriptor& hog, PersonWindows& windows, const PeopleParams& params)
{
  if (params.mean_shift)
    cv::groupRectangles_meanshift(windows.boxes, windows.weights, windows.scales, params.group_threshold, hog.winSize);
  else
    hog.groupRectangles(windows.boxes, windows.weights, static_cast<int>(params.group_threshold), kMaxDifference);
}

}  // namespace robot_vision
