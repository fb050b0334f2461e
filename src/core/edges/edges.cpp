#include "robot_vision/edges/edges.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "canny_stripe.hpp"
#include "core/image/gray_line_buffer.hpp"
#include "core/image/row_bands.hpp"
#include "edge_hysteresis.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kFusedAperture = 3;

/// As cv::Canny rounds them.
EdgeThresholds thresholdsOf(const EdgeParams& params)
{
  const auto threshold = [&params](double of_magnitude)
  {
    const double limit = std::min(of_magnitude, 32767.0);
    return static_cast<std::int32_t>(std::floor(params.l2_gradient ? limit * limit : limit));
  };
  return {threshold(params.low_threshold), threshold(params.high_threshold)};
}

}  // namespace

void validate(const EdgeParams& params)
{
  checkFields(params);
  require(params.high_threshold >= params.low_threshold, "high_threshold", params.high_threshold,
          "at least low_threshold, " + toText(params.low_threshold));
}

struct EdgeDetector::Bands
{
  EdgeHysteresis bits;
  std::vector<CannyStripe> bands;
};

EdgeDetector::EdgeDetector(const EdgeParams& params) : params_(params), bands_(std::make_unique<Bands>())
{
  validate(params);
  bands_->bands.resize(static_cast<std::size_t>(params.threads));
}

EdgeDetector::EdgeDetector(EdgeDetector&&) = default;
EdgeDetector& EdgeDetector::operator=(EdgeDetector&&) = default;
EdgeDetector::~EdgeDetector() = default;

void EdgeDetector::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& edges)
{
  checkPixels(image, encoding);
  if (params_.aperture == kFusedAperture && GrayLineBuffer::takes(encoding))
  {
    applyInBands(image, encoding, edges);
    return;
  }
  cv::Mat gray = gray_;  // toGray may let it share the input's pixels, which must not be kept
  toGray(image, encoding, gray);
  if (!sharesPixels(gray, image)) gray_ = gray;
  if (params_.aperture == kFusedAperture)
    applyInBands(gray, "mono8", edges);
  else
    applyByOpenCv(gray, edges);
}

void EdgeDetector::applyInBands(const cv::Mat& image, const std::string& encoding, cv::Mat& edges)
{
  EdgeHysteresis& bits = bands_->bits;
  bits.reset(image.size());
  const EdgeThresholds thresholds = thresholdsOf(params_);
  parallelForRows(image.rows, params_.threads, 4 * params_.blur_size,
                  [&](int i, const cv::Range& rows)
                  {
                    CannyStripe& band = bands_->bands[static_cast<std::size_t>(i)];
                    band.run(image, encoding, params_.blur_size, thresholds, params_.l2_gradient, rows, bits);
                  });
  bits.connect();
  bits.write(edges);
}

void EdgeDetector::applyByOpenCv(const cv::Mat& gray, cv::Mat& edges)
{
  if (params_.blur_size > 1) cv::blur(gray, blurred_, {params_.blur_size, params_.blur_size});
  const cv::Mat& smooth = params_.blur_size > 1 ? blurred_ : gray;
  cv::Canny(smooth, edges, params_.low_threshold, params_.high_threshold, params_.aperture, params_.l2_gradient);
}

std::string EdgeDetector::outputEncoding(const std::string&)
{
  return "mono8";
}

}  // namespace robot_vision
