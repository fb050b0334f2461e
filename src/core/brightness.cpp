#include "robot_vision/brightness.hpp"

#include <cmath>
#include <cstdint>

#include "robot_vision/encoding.hpp"
#include "robot_vision/range.hpp"

namespace robot_vision
{
namespace
{

/// The output for each input value of an unsigned integer type.
template <class T>
cv::Mat makeTable(const BrightnessParams& params)
{
  constexpr int kMax = std::numeric_limits<T>::max();
  cv::Mat_<T> ramp(1, kMax + 1);
  for (int i = 0; i <= kMax; ++i)
    ramp(i) = static_cast<T>(i);
  cv::Mat_<T> table;
  ramp.convertTo(table, -1, params.gain, params.offset * (kMax / 255));
  for (T& value : table)
    value = cv::saturate_cast<T>(std::pow(value / double{kMax}, params.gamma) * kMax);
  return std::move(table);
}

cv::Mat keepAlpha(const cv::Mat& table)
{
  cv::Mat identity(table.size(), CV_8UC1);
  for (int i = 0; i < identity.cols; ++i)
    identity.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  cv::Mat merged;
  cv::merge(std::vector<cv::Mat>{table, table, table, identity}, merged);
  return merged;
}

/// cv::LUT for 16 bits, which it has only since OpenCV 5.
void lookUp(const cv::Mat_<std::uint16_t>& image, const cv::Mat_<std::uint16_t>& table, cv::Mat& out)
{
  out.create(image.size(), CV_16UC1);
  const std::uint16_t* values = table[0];
  for (int y = 0; y < image.rows; ++y)
  {
    const std::uint16_t* from = image[y];
    auto* to = out.ptr<std::uint16_t>(y);
    for (int x = 0; x < image.cols; ++x)
      to[x] = values[from[x]];
  }
}

}  // namespace

void validate(const BrightnessParams& params)
{
  requireRange("gain", params.gain, 0.0, 10.0);
  requireRange("offset", params.offset, -255.0, 255.0);
  requireRange("gamma", params.gamma, 0.1, 10.0);
}

Brightness::Brightness(const BrightnessParams& params) : params_(params)
{
  validate(params);
  table_ = makeTable<std::uint8_t>(params);
  alpha_table_ = keepAlpha(table_);
}

void Brightness::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& out)
{
  checkPixels(image, encoding);
  if (encoding == "mono16")
  {
    if (wide_table_.empty()) wide_table_ = makeTable<std::uint16_t>(params_);
    lookUp(image, wide_table_, out);
  }
  else if (outputEncoding(encoding) == encoding)
  {
    cv::LUT(image, image.channels() == 4 ? alpha_table_ : table_, out);
  }
  else
  {
    toBgr(image, encoding, bgr_);
    cv::LUT(bgr_, table_, out);
  }
}

std::string Brightness::outputEncoding(const std::string& encoding)
{
  const bool kept =
      encoding == "rgb8" || encoding == "bgra8" || encoding == "rgba8" || encoding == "mono8" || encoding == "mono16";
  return kept ? encoding : "bgr8";
}

}  // namespace robot_vision
