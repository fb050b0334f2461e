#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "robot_vision/image/encoding.hpp"

/// Random pixels. Each row is followed by `row_padding` others that do not belong to the image.
inline cv::Mat noise(cv::Size size, int type, int row_padding = 0)
{
  cv::Mat padded(size.height, size.width + row_padding, type);
  cv::RNG random(0x5EED);
  random.fill(padded, cv::RNG::UNIFORM, 0, padded.depth() == CV_16U ? 65536 : 256);
  return padded.colRange(0, size.width);
}

/// The image after cv::cvtColor with a code; the image itself if the code is negative.
inline cv::Mat converted(const cv::Mat& image, int code)
{
  if (code < 0) return image;
  cv::Mat out;
  cv::cvtColor(image, out, code);
  return out;
}

/// The image after robot_vision::toEncoding().
inline cv::Mat converted(const cv::Mat& image, const std::string& encoding, const std::string& wanted)
{
  cv::Mat out;
  robot_vision::toEncoding(image, encoding, wanted, out);
  return out;
}

using Bytes = std::vector<std::uint8_t>;

/// The JPEG that OpenCV makes of an image.
inline Bytes jpegOf(const cv::Mat& image, const std::vector<int>& params = {})
{
  Bytes bytes;
  cv::imencode(".jpg", image, bytes, params);
  return bytes;
}

/// A copy of bytes as an image of one row, such as a frame of encoding jpeg.
inline cv::Mat rowOf(const Bytes& bytes)
{
  return cv::Mat(bytes, true).reshape(1, 1);
}

/// A matrix of sin(i * step) and cos(i * step) for each index i.
inline cv::Mat_<float> turns(int count, double step)
{
  cv::Mat_<float> result(count, 2);
  for (int i = 0; i < count; ++i)
  {
    result(i, 0) = static_cast<float>(std::sin(step * i));
    result(i, 1) = static_cast<float>(std::cos(step * i));
  }
  return result;
}

/// A smooth color image, like a photograph: each channel is a product of sin(ax + by) and cos(bx - ay).
inline cv::Mat smooth(cv::Size size)
{
  const cv::Matx22f swap(0, 1, 1, 0);
  std::vector<cv::Mat> channels;
  for (const auto& [a, b] : {std::pair(0.05, 0.02), std::pair(0.03, 0.06), std::pair(0.11, 0.01)})
  {
    // The sum formulas need no sine for each of millions of pixels.
    const cv::Mat sines = turns(size.height, b) * cv::Mat(swap) * turns(size.width, a).t();
    const cv::Mat cosines = turns(size.height, a) * turns(size.width, b).t();
    const cv::Mat product = sines.mul(cosines);
    product.convertTo(channels.emplace_back(), CV_8U, 127.0, 127.0);
  }
  cv::Mat image;
  cv::merge(channels, image);
  return image;
}

/// An image that has every color once.
inline cv::Mat allColors()
{
  cv::Mat_<std::uint8_t> ramp(256, 1);
  for (int i = 0; i < ramp.rows; ++i)
    ramp(i) = static_cast<std::uint8_t>(i);
  std::vector<cv::Mat> channels(3);  // each blue has a row, in which green changes with each pixel
  const cv::Mat reds = cv::repeat(ramp, 1, 256), greens = cv::repeat(ramp.t(), 256, 1);
  cv::repeat(ramp, 1, 65536, channels[0]);
  cv::repeat(greens.reshape(1, 1), 256, 1, channels[1]);
  cv::repeat(reds.reshape(1, 1), 256, 1, channels[2]);
  cv::Mat colors;
  cv::merge(channels, colors);
  return colors.reshape(3, 4096);
}

/// An image of any encoding but jpeg: bgr8 is smooth, all others are noise with padded rows.
inline cv::Mat colorful(cv::Size size, const std::string& encoding)
{
  if (encoding != "bgr8") return noise(size, robot_vision::matType(encoding), 3);
  return smooth(size);
}

/// Images on which filters tend to go wrong: noise, saturated noise, a chess board, lines along the border, soft shapes
/// and a uniform level. Each is a part of a larger image.
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
