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
  require(a.type() == CV_32FC1 && !a.empty(), "the first histogram", describePixels(a.type()),
          describePixels(CV_32FC1));
  require(a.type() == b.type() && a.size() == b.size(), "the second histogram",
          sizeText(b.rows, b.cols) + " bins of " + describePixels(b.type()),
          "as the first, of " + sizeText(a.rows, a.cols));
  const double sum_a = cv::sum(a)[0], sum_b = cv::sum(b)[0];
  // OpenCV takes the correlation of a histogram that is empty for 1.
  if (found->second == cv::HISTCMP_CORREL && (sum_a <= 0.0 || sum_b <= 0.0)) return 0.0;
  cv::Mat shares_a, shares_b;
  cv::normalize(a, shares_a, 1.0, 0.0, cv::NORM_L1);
  cv::normalize(b, shares_b, 1.0, 0.0, cv::NORM_L1);
  return cv::compareHist(shares_a, shares_b, found->second);
}

}  // namespace robot_vision
