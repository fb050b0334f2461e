#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct HueSaturationParams
{
  int hue_bins = 30;
  int saturation_bins = 32;
  int min_saturation = 0;
  int min_value = 0;
  int disc = 5;
  std::string comparison = "correlation";

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("hue_bins", &HueSaturationParams::hue_bins, Range{1, 180}, "", "of the hues, which are 0 to 179");
    visit("saturation_bins", &HueSaturationParams::saturation_bins, Range{1, 256}, "",
          "of the saturations, which are 0 to 255");
    visit("min_saturation", &HueSaturationParams::min_saturation, Range{0, 255}, "",
          "pixels below it do not count: they are gray, and have hardly a hue");
    visit("min_value", &HueSaturationParams::min_value, Range{0, 255}, "",
          "pixels below it do not count: they are dark, and have hardly a hue");
    visit("disc", &HueSaturationParams::disc, OddRange{1, 31}, "px",
          "diameter of the disc over which the back projection is summed; 1: none");
    visit("comparison", &HueSaturationParams::comparison,
          OneOf{"correlation, chi_square, intersection or bhattacharyya"}, "",
          "by what a selection is compared with the image");
  }
};

/// The two-dimensional histogram of hue and saturation: CV_32FC1, hue_bins rows and saturation_bins columns, in px, as
/// cv::calcHist counts them in a region of the image (see partOf() in histogram.hpp). `image` is not modified. Throws
/// std::invalid_argument as validate() does, if `image` is not an image of `encoding` (see encoding.hpp), and as
/// partOf() does.
cv::Mat hueSaturationHistogram(const cv::Mat& image, const std::string& encoding,
                               const HueSaturationParams& params = HueSaturationParams(),
                               const cv::Rect& region = cv::Rect());

/// How frequent the colour of each pixel is in a histogram of hueSaturationHistogram(): CV_8UC1, 255 for the most
/// frequent one, as cv::calcBackProject gives it, 0 where a pixel does not count; then the sum over a disc
/// (cv::filter2D with a cv::MORPH_ELLIPSE), cut off at 255. `out` is reused if it fits. `image` is not modified. Throws
/// std::invalid_argument as above, and if the histogram is not of hue_bins and saturation_bins.
void backProject(const cv::Mat& image, const std::string& encoding, const cv::Mat& histogram,
                 const HueSaturationParams& params, cv::Mat& out);

/// Compares two histograms of the same type and size, after each was divided by its sum, by a method of
/// cv::compareHist: correlation (-1 to 1, 1 for equal ones; 0 if only one of them has the same in all bins), chi_square
/// (0 for equal ones; the differences are relative to `a`), intersection (0 to 1, 1 for equal ones) or bhattacharyya (0
/// to 1, 0 for equal ones). One without pixels has nothing in common with any: 0, 1, 0 and 1. Throws
/// std::invalid_argument for another method, and for histograms that cannot be compared.
double compareHistograms(const cv::Mat& a, const cv::Mat& b, const std::string& method);

}  // namespace robot_vision
