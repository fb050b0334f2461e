#include "robot_vision/histogram/hue_saturation.hpp"

#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "hsv_histogram.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/histogram/histogram.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

const std::map<std::string, cv::HistCompMethods> kMethods = {{"correlation", cv::HISTCMP_CORREL},
                                                             {"chi_square", cv::HISTCMP_CHISQR},
                                                             {"intersection", cv::HISTCMP_INTERSECT},
                                                             {"bhattacharyya", cv::HISTCMP_BHATTACHARYYA}};

/// What a method says of histograms that have nothing in common.
double nothingInCommon(cv::HistCompMethods method)
{
  return method == cv::HISTCMP_CHISQR || method == cv::HISTCMP_BHATTACHARYYA ? 1.0 : 0.0;
}

/// Whether all bins have the same.
bool isFlat(const cv::Mat& histogram)
{
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(histogram, &low, &high);
  return low >= high;
}

}  // namespace

cv::Mat hueSaturationHistogram(const cv::Mat& image, const std::string& encoding, const HueSaturationParams& params,
                               const cv::Rect& region)
{
  validate(params);
  cv::Mat bgr;
  toBgr(image, encoding, bgr);
  const HsvPixels pixels(bgr(partOf(bgr.size(), region)), params.min_saturation, params.min_value);
  return pixels.histogram(params.hue_bins, params.saturation_bins);
}

void backProject(const cv::Mat& image, const std::string& encoding, const cv::Mat& histogram,
                 const HueSaturationParams& params, cv::Mat& out)
{
  validate(params);
  const bool fits =
      histogram.type() == CV_32FC1 && histogram.rows == params.hue_bins && histogram.cols == params.saturation_bins;
  require(fits, "the histogram",
          sizeText(histogram.rows, histogram.cols) + " bins of " + describePixels(histogram.type()),
          sizeText(params.hue_bins, params.saturation_bins) + " bins of " + describePixels(CV_32FC1));
  cv::Mat bgr;
  toBgr(image, encoding, bgr);
  HsvPixels(bgr, params.min_saturation, params.min_value).backProject(histogram, out);
  if (params.disc > 1)
    cv::filter2D(out, out, -1, cv::getStructuringElement(cv::MORPH_ELLIPSE, {params.disc, params.disc}));
}

double compareHistograms(const cv::Mat& a, const cv::Mat& b, const std::string& method)
{
  const auto found = kMethods.find(method);
  require(found != kMethods.end(), "method", method, "correlation, chi_square, intersection or bhattacharyya");
  require(!a.empty(), "the first histogram", sizeText(a.rows, a.cols) + " bins", "at least 1x1 bins");
  require(a.type() == CV_32FC1, "the first histogram", describePixels(a.type()), describePixels(CV_32FC1));
  require(a.type() == b.type() && a.size() == b.size(), "the second histogram",
          sizeText(b.rows, b.cols) + " bins of " + describePixels(b.type()),
          "as the first, of " + sizeText(a.rows, a.cols));
  // OpenCV takes one without pixels for equal to any other by chi-square, and a flat one by correlation.
  const bool is_empty = cv::sum(a)[0] <= 0.0 || cv::sum(b)[0] <= 0.0;
  if (is_empty || (found->second == cv::HISTCMP_CORREL && isFlat(a) != isFlat(b)))
    return nothingInCommon(found->second);
  cv::Mat shares_a, shares_b;
  cv::normalize(a, shares_a, 1.0, 0.0, cv::NORM_L1);
  cv::normalize(b, shares_b, 1.0, 0.0, cv::NORM_L1);
  return cv::compareHist(shares_a, shares_b, found->second);
}

}  // namespace robot_vision
