#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/image/conversion_buffer.hpp"
#include "core/image/filled_up.hpp"
#include "dft.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/spectrum/spectrum.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMiddleGray = 128.0;

/// Of a frequency as share of the radius.
double lowPass(double share, const SpectrumParams& params)
{
  if (params.shape == "ideal") return share <= 1.0 ? 1.0 : 0.0;
  if (params.shape == "gaussian") return std::exp(-0.5 * share * share);
  return 1.0 / (1.0 + std::pow(share, 2 * params.order));
}

/// Of a frequency as share of the Nyquist frequency.
double bandPass(double frequency, const SpectrumParams& params)
{
  if (params.shape == "ideal") return std::abs(frequency - params.radius) <= params.width / 2.0 ? 1.0 : 0.0;
  if (frequency == 0.0) return 0.0;
  const double distance = (frequency * frequency - params.radius * params.radius) / (frequency * params.width);
  if (params.shape == "gaussian") return std::exp(-distance * distance);
  return 1.0 / (1.0 + std::pow(distance, 2 * params.order));
}

double factorOf(double frequency, const SpectrumParams& params)
{
  if (params.filter == "none") return 1.0;
  if (params.filter == "band_pass") return bandPass(frequency, params);
  const double low = lowPass(frequency / params.radius, params);
  return params.filter == "low_pass" ? low : 1.0 - low;
}

bool hasMean(const SpectrumParams& params)
{
  return params.filter == "none" || params.filter == "low_pass";
}

}  // namespace

cv::Mat frequencyMask(const cv::Size& size, const SpectrumParams& params)
{
  validate(params);
  require(!size.empty(), "the size of the mask", toText(size), "1x1 or larger");
  cv::Mat mask(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y)
  {
    const double vertical = 2.0 * (y - size.height / 2) / size.height;  // share of the Nyquist frequency
    auto* row = mask.ptr<float>(y);
    for (int x = 0; x < size.width; ++x)
    {
      const double horizontal = 2.0 * (x - size.width / 2) / size.width;
      row[x] = static_cast<float>(factorOf(std::sqrt(vertical * vertical + horizontal * horizontal), params));
    }
  }
  return mask;
}

FrequencyFilter::FrequencyFilter(const SpectrumParams& params) : params_(params)
{
  validate(params);
}

void FrequencyFilter::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& filtered)
{
  ConversionBuffer buffer;
  const cv::Mat gray = buffer.gray(image, encoding);
  if (params_.filter == "none")
  {
    gray.convertTo(filtered, CV_32F);
    return;
  }
  const cv::Size size = dftSize(gray.size(), params_.optimal_size);
  if (mask_.size() != size)
  {
    const cv::Mat mask = uncentered(frequencyMask(size, params_));
    cv::merge(std::array<cv::Mat, 2>{mask, mask}.data(), 2, mask_);
  }
  cv::Mat frequencies;
  cv::dft(filledUp(toFloat(gray, /*is_faded=*/false), size, cv::BORDER_REPLICATE), frequencies, cv::DFT_COMPLEX_OUTPUT);
  cv::multiply(frequencies, mask_, frequencies);
  cv::Mat whole;
  cv::dft(frequencies, whole, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  whole({{0, 0}, gray.size()}).copyTo(filtered);
}

void FrequencyFilter::show(const cv::Mat& filtered, cv::Mat& shown) const
{
  checkPixels(filtered, "32FC1", CV_32FC1);
  filtered.convertTo(shown, CV_8U, 1.0, hasMean(params_) ? 0.0 : kMiddleGray);
}

}  // namespace robot_vision
