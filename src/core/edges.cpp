#include "robot_vision/edges.hpp"

#include <opencv2/imgproc.hpp>

#include "robot_vision/encoding.hpp"
#include "robot_vision/range.hpp"

namespace robot_vision
{

void validate(const EdgeParams& params)
{
  require(params.blur_size >= 1 && params.blur_size <= 31 && params.blur_size % 2 == 1, "blur_size", params.blur_size,
          "odd and from 1 to 31");
  requireRange("low_threshold", params.low_threshold, 0.0, 10000.0);
  requireRange("high_threshold", params.high_threshold, 0.0, 10000.0);
  require(params.high_threshold >= params.low_threshold, "high_threshold", params.high_threshold,
          "at least low_threshold, " + toText(params.low_threshold));
  require(params.aperture == 3 || params.aperture == 5 || params.aperture == 7, "aperture", params.aperture,
          "3, 5 or 7");
}

EdgeDetector::EdgeDetector(const EdgeParams& params) : params_(params)
{
  validate(params);
}

void EdgeDetector::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& edges)
{
  cv::Mat gray = gray_;  // toGray may let it share the input's pixels, which must not be kept
  toGray(image, encoding, gray);
  if (!sharesPixels(gray, image)) gray_ = gray;

  if (params_.blur_size > 1) cv::blur(gray, blurred_, {params_.blur_size, params_.blur_size});
  const cv::Mat& smooth = params_.blur_size > 1 ? blurred_ : gray;
  cv::Canny(smooth, edges, params_.low_threshold, params_.high_threshold, params_.aperture, params_.l2_gradient);
}

std::string EdgeDetector::outputEncoding(const std::string&)
{
  return "mono8";
}

}  // namespace robot_vision
