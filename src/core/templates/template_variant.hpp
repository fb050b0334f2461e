#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/templates/template_matcher.hpp"

namespace robot_vision
{

/// A place where a template fits better than next to it.
struct TemplatePeak
{
  double score = 0.0;
  std::size_t variant = 0;  // its number
  cv::Point place;          // px, of the template's top left pixel
  cv::Point2d offset;       // px, from there to the top of a parabola through the responses, -0.5 to 0.5
};

/// The best first. The order depends on nothing but the peaks.
bool isBetter(const TemplatePeak& a, const TemplatePeak& b);

/// A template at a scale.
struct TemplateVariant
{
  int index = 0;  // of the template
  double scale = 1.0;
  cv::Mat pixels;         // CV_8UC1 or CV_8UC3
  cv::Mat mask;           // CV_8UC1, not 0 for what counts; empty: all does
  double values = 0.0;    // number of values that count, of all channels
  double largest = 0.0;   // response of ccorr or ccoeff in any image
  double contrast = 0.0;  // gray levels: standard deviation, or without ccoeff's mean the root of the mean square

  bool fits(const cv::Size& image) const { return pixels.cols <= image.width && pixels.rows <= image.height; }

  /// 0 to 1, of a response.
  double score(double response, const std::string& method) const;

  /// The best peaks of a response that have the score of a result.
  std::vector<TemplatePeak> peaks(const cv::Mat_<float>& response, std::size_t number,
                                  const TemplateParams& params) const;
};

/// A template at all scales, without those where it has too little contrast for the method or no pixel that counts.
/// Throws std::invalid_argument if none is left.
std::vector<TemplateVariant> templateVariants(int index, const cv::Mat& pixels, const cv::Mat& mask,
                                              const TemplateParams& params);

/// All scales, the smallest first.
std::vector<double> scalesOf(const TemplateParams& params);

}  // namespace robot_vision
