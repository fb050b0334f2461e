#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <string>

#include "robot_vision/encoding.hpp"

/// Random pixels; each row is followed by `row_padding` others that do not belong to the picture.
inline cv::Mat noise(cv::Size size, int type, int row_padding = 0)
{
  cv::Mat padded(size.height, size.width + row_padding, type);
  cv::RNG random(0x5EED);
  random.fill(padded, cv::RNG::UNIFORM, 0, padded.depth() == CV_16U ? 65536 : 256);
  return padded.colRange(0, size.width);
}

/// A colour picture with soft shapes, as photographs have them.
inline cv::Mat smooth(cv::Size size)
{
  cv::Mat_<cv::Vec3b> picture(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
    {
      const auto wave = [&](double a, double b)
      { return static_cast<std::uint8_t>(127.5 + 127.0 * std::sin(a * x + b * y) * std::cos(b * x - a * y)); };
      picture(y, x) = {wave(0.05, 0.02), wave(0.03, 0.06), wave(0.11, 0.01)};
    }
  return std::move(picture);
}

/// A picture of any encoding but jpeg, with padded rows if they are noise.
inline cv::Mat colourful(cv::Size size, const std::string& encoding)
{
  if (encoding != "bgr8") return noise(size, robot_vision::matType(encoding), 3);
  return smooth(size);
}

/// Pictures on which filters go wrong: noise, saturated, chess boards, lines along the borders, soft shapes, nothing;
/// in the middle of others.
inline cv::Mat adversarial(cv::Size size, int kind)
{
  cv::Mat around(size + cv::Size(9, 2), CV_8UC1, cv::Scalar(77));
  cv::Mat image = around(cv::Rect({5, 1}, size));
  switch (kind % 6)
  {
    case 0:
      noise(size, CV_8UC1).copyTo(image);
      break;
    case 1:
      cv::threshold(noise(size, CV_8UC1), image, 127, 255, cv::THRESH_BINARY);
      break;
    case 2:
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          image.at<std::uint8_t>(y, x) = (x + y) % 2 == 0 ? 255 : 0;
      break;
    case 3:
      image.setTo(0);
      cv::rectangle(image, cv::Rect({0, 0}, size), 255);
      break;
    case 4:
      cv::cvtColor(smooth(size), image, cv::COLOR_BGR2GRAY);
      break;
    default:
      image.setTo(200);
  }
  return image;
}

/// Same size, type and bytes.
inline bool equal(const cv::Mat& a, const cv::Mat& b)
{
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}
