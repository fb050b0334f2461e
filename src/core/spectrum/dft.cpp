#include "dft.hpp"

#include <cmath>
#include <vector>

namespace robot_vision
{
namespace
{

std::vector<float> hannWindow(int length)
{
  std::vector<float> window(static_cast<std::size_t>(length), 1.0F);
  for (int i = 0; length > 2 && i < length; ++i)
    window[static_cast<std::size_t>(i)] = static_cast<float>(0.5 - 0.5 * std::cos(2.0 * CV_PI * i / (length - 1)));
  return window;
}

/// The image moved cyclically to the right and down, by its size at most.
cv::Mat rolled(const cv::Mat& image, const cv::Point& by)
{
  cv::Mat moved(image.size(), image.type());
  const int columns = image.cols - by.x, rows = image.rows - by.y;  // those that are not moved around
  const auto copy = [&](const cv::Rect& from, const cv::Point& to)
  {
    if (!from.empty()) image(from).copyTo(moved({to, from.size()}));
  };
  copy({0, 0, columns, rows}, by);
  copy({columns, 0, by.x, rows}, {0, by.y});
  copy({0, rows, columns, by.y}, {by.x, 0});
  copy({columns, rows, by.x, by.y}, {0, 0});
  return moved;
}

}  // namespace

cv::Mat toFloat(const cv::Mat& gray, bool is_faded, double black)
{
  cv::Mat image;
  gray.convertTo(image, CV_32F, 1.0, -black);
  if (!is_faded) return image;
  const std::vector<float> columns = hannWindow(image.cols), rows = hannWindow(image.rows);
  for (int y = 0; y < image.rows; ++y)
  {
    auto* row = image.ptr<float>(y);
    const float factor = rows[static_cast<std::size_t>(y)];
    for (std::size_t x = 0; x < columns.size(); ++x)
      row[x] *= factor * columns[x];
  }
  return image;
}

cv::Size dftSize(const cv::Size& size, bool is_optimal)
{
  if (!is_optimal) return size;
  return {cv::getOptimalDFTSize(size.width), cv::getOptimalDFTSize(size.height)};
}

cv::Mat centered(const cv::Mat& image)
{
  return rolled(image, {image.cols / 2, image.rows / 2});
}

cv::Mat uncentered(const cv::Mat& image)
{
  return rolled(image, {image.cols - image.cols / 2, image.rows - image.rows / 2});
}

}  // namespace robot_vision
