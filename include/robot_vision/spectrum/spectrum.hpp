#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct SpectrumParams
{
  std::string window = "hann";
  bool optimal_size = true;
  std::string filter = "none";
  std::string shape = "gaussian";
  double radius = 0.1;
  double width = 0.1;
  int order = 2;
  double min_response = 0.1;
  double max_gap = 2.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("window", &SpectrumParams::window, OneOf{"hann or none"}, "",
          "magnitude: what fades the image out towards its borders, which otherwise show as a cross");
    visit("optimal_size", &SpectrumParams::optimal_size, Anything{}, "",
          "magnitude and filter: fill the image up to a size that is transformed fast");
    visit("filter", &SpectrumParams::filter, OneOf{"none, low_pass, high_pass or band_pass"}, "",
          "which frequencies are kept");
    visit("shape", &SpectrumParams::shape, OneOf{"ideal, gaussian or butterworth"}, "",
          "how the filter falls off at its border");
    visit("radius", &SpectrumParams::radius, Above{0, 1.5}, "",
          "border of low_pass and high_pass, middle of band_pass, as share of the Nyquist frequency");
    visit("width", &SpectrumParams::width, Above{0, 1.5}, "", "width of band_pass, as share of the Nyquist frequency");
    visit("order", &SpectrumParams::order, Range{1, 10}, "", "butterworth: how steep the filter falls off");
    visit("min_response", &SpectrumParams::min_response, Range{0, 1}, "",
          "least response of a shift; of 640x480 px that have nothing in common it is up to 0.04, of fewer more");
    visit("max_gap", &SpectrumParams::max_gap, Above{0, 3600}, "s",
          "shift: between two frames that are compared; a later one begins anew");
  }
};

/// The magnitude of the discrete Fourier transform of the gray image: CV_32FC1, log(1 + magnitude), with frequency 0 at
/// column cols / 2 and row rows / 2. It is as large as the image, or as its next optimal size (see optimal_size), to
/// which zeros are appended; the pixel u columns to the right of the middle and v rows below it has u / cols and v /
/// rows periods per px of the image. `image` is not modified. Throws std::invalid_argument as validate() does, and if
/// `image` is not an image of `encoding` (see encoding.hpp).
cv::Mat spectrumMagnitude(const cv::Mat& image, const std::string& encoding,
                          const SpectrumParams& params = SpectrumParams());

/// A magnitude (CV_32FC1) as an image to look at: CV_8UC1, its largest value 255 and 0 black. Throws
/// std::invalid_argument if it is no such image.
cv::Mat spectrumImage(const cv::Mat& magnitude);

/// The factors by which the filter multiplies the frequencies of an image of this size: CV_32FC1, 0 to 1, centred as
/// spectrumMagnitude(). With r, the frequency as share of the Nyquist frequency (half a period per px in each
/// direction), low_pass has 1 up to the radius and then 0 (ideal), exp(-(r / radius)^2 / 2) (gaussian), or
/// 1 / (1 + (r / radius)^(2 order)) (butterworth); high_pass has 1 less that. band_pass has 1 within half the width of
/// the radius (ideal), exp(-d^2) or 1 / (1 + d^(2 order)), with d = (r^2 - radius^2) / (r width). Throws
/// std::invalid_argument as validate() does, and for an empty size.
cv::Mat frequencyMask(const cv::Size& size, const SpectrumParams& params);

/// Draws the borders of the filter into an image of the spectrum (CV_8UC3, of the size of the magnitude): one curve,
/// two of band_pass, none without filter. A frequency is an ellipse there if the image is wider than high. Throws
/// std::invalid_argument as validate() does, and if `bgr` is no such image.
void drawPassband(cv::Mat& bgr, const SpectrumParams& params);

/// Filters gray images by their frequencies. As the transform takes an image for periodic, what is near a border
/// changes what is near the opposite one. The factors are kept from frame to frame.
class FrequencyFilter
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit FrequencyFilter(const SpectrumParams& params = SpectrumParams());

  /// Writes CV_32FC1, gray levels, into `filtered` (reused if it fits). What has passed high_pass or band_pass has a
  /// mean of 0 over the image that is transformed: with optimal_size the image filled up with its last row and column,
  /// so that what is written differs from 0 by what they differ from the rest. `image` is not modified. Throws
  /// std::invalid_argument if `image` is not of `encoding` (see encoding.hpp).
  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& filtered);

  /// Writes what apply() has made as an image to look at (CV_8UC1) into `shown`: of high_pass and band_pass 0 is gray
  /// (128). Throws std::invalid_argument if it is no such image.
  void show(const cv::Mat& filtered, cv::Mat& shown) const;

private:
  SpectrumParams params_;
  cv::Mat mask_;  // CV_32FC2, the factor twice, with frequency 0 at the top left
};

/// How far an image has moved as a whole.
struct ImageShift
{
  double x = 0.0, y = 0.0;  // px to the right and down since the last frame; 0 if not found
  double response = 0.0;    // share of the correlation that is around its peak, 0 to 1
  bool found = false;       // whether the response is at least min_response and above 0
};

/// Finds how far the image has moved since the last frame, by phase correlation: cv::phaseCorrelate of the gray images
/// less their means under a Hann window, filled up with zeros to even sizes, as with odd ones that function is wrong by
/// half a pixel. Images of a single gray have no shift. Threads may share one; their calls wait for each other.
class PhaseCorrelator
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit PhaseCorrelator(const SpectrumParams& params = SpectrumParams());
  ~PhaseCorrelator();

  /// The shift from the last frame to the one of `time_s` (s, of any clock). None for the first frame, one of another
  /// size, of an earlier time, or of more than max_gap later: each begins anew. `image` is not modified. Throws
  /// std::invalid_argument if `image` is not an image of `encoding` (see encoding.hpp).
  std::optional<ImageShift> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// The time between the two frames of the last shift, s; 0 if there was none.
  double interval() const;

  /// Makes the next frame the first one.
  void reset();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
