#include "robot_vision/spectrum/spectrum.hpp"

#include <array>
#include <opencv2/imgproc.hpp>

#include "core/image/conversion_buffer.hpp"
#include "core/image/filled_up.hpp"
#include "dft.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

const cv::Scalar kGreen(0, 255, 0);

/// Draws the frequencies of this share of the Nyquist frequency, below 0 none.
void drawFrequency(cv::Mat& bgr, double share)
{
  if (share < 0.0) return;
  const int fraction_bits = 4;
  const double unit = 1 << fraction_bits;
  const cv::Point middle(cvRound(bgr.cols / 2 * unit), cvRound(bgr.rows / 2 * unit));
  const cv::Size radii(cvRound(share * bgr.cols / 2.0 * unit), cvRound(share * bgr.rows / 2.0 * unit));
  cv::ellipse(bgr, middle, radii, 0.0, 0.0, 360.0, kGreen, 1, cv::LINE_AA, fraction_bits);
}

}  // namespace

cv::Mat spectrumMagnitude(const cv::Mat& image, const std::string& encoding, const SpectrumParams& params)
{
  validate(params);
  ConversionBuffer buffer;
  const cv::Mat gray = buffer.gray(image, encoding);
  const cv::Size size = dftSize(gray.size(), params.optimal_size);
  cv::Mat frequencies;
  cv::dft(filledUp(toFloat(gray, params.window == "hann"), size), frequencies, cv::DFT_COMPLEX_OUTPUT);
  std::array<cv::Mat, 2> parts;  // real, imaginary
  cv::split(frequencies, parts.data());
  cv::Mat magnitude;
  cv::magnitude(parts[0], parts[1], magnitude);
  magnitude += cv::Scalar::all(1.0);
  cv::log(magnitude, magnitude);
  return centered(magnitude);
}

cv::Mat spectrumImage(const cv::Mat& magnitude)
{
  checkPixels(magnitude, "32FC1", CV_32FC1);
  double largest = 0.0;
  cv::minMaxLoc(magnitude, nullptr, &largest);
  cv::Mat image;
  magnitude.convertTo(image, CV_8U, largest > 0.0 ? 255.0 / largest : 0.0);
  return image;
}

void drawPassband(cv::Mat& bgr, const SpectrumParams& params)
{
  validate(params);
  checkPixels(bgr, "bgr8");
  if (params.filter == "none") return;
  const bool is_band = params.filter == "band_pass";
  const double half = is_band ? params.width / 2.0 : 0.0;
  drawFrequency(bgr, params.radius + half);
  if (is_band) drawFrequency(bgr, params.radius - half);
}

}  // namespace robot_vision
