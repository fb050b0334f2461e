#include "robot_vision/edges/edges.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "canny_stripe.hpp"
#include "core/image/conversion_buffer.hpp"
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

/// The thresholds of the magnitude, rounded as cv::Canny does.
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

struct EdgeDetector::Impl
{
  explicit Impl(const EdgeParams& p) : params(p) { stripes.resize(static_cast<std::size_t>(p.threads)); }

  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& edges)
  {
    checkPixels(image, encoding);
    if (params.aperture != kFusedAperture)
      applyByOpenCv(buffer.gray(image, encoding), edges);
    else if (GrayLineBuffer::takes(encoding))
      applyInStripes(image, encoding, edges);
    else
      applyInStripes(buffer.gray(image, encoding), "mono8", edges);
  }

  void applyInStripes(const cv::Mat& image, const std::string& encoding, cv::Mat& edges)
  {
    hysteresis.reset(image.size());
    const EdgeThresholds thresholds = thresholdsOf(params);
    parallelForRows(image.rows, params.threads, 4 * params.blur_size,
                    [&](int i, const cv::Range& rows)
                    {
                      CannyStripe& stripe = stripes[static_cast<std::size_t>(i)];
                      stripe.run(image, encoding, params.blur_size, thresholds, params.l2_gradient, rows, hysteresis);
                    });
    hysteresis.connect();
    hysteresis.write(edges);
  }

  void applyByOpenCv(const cv::Mat& gray, cv::Mat& edges)
  {
    if (params.blur_size > 1) cv::blur(gray, blurred, {params.blur_size, params.blur_size});
    const cv::Mat& smooth = params.blur_size > 1 ? blurred : gray;
    cv::Canny(smooth, edges, params.low_threshold, params.high_threshold, params.aperture, params.l2_gradient);
  }

  EdgeParams params;
  ConversionBuffer buffer;
  EdgeHysteresis hysteresis;
  std::vector<CannyStripe> stripes;
  cv::Mat blurred;
};

EdgeDetector::EdgeDetector(const EdgeParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

EdgeDetector::EdgeDetector(EdgeDetector&&) = default;
EdgeDetector& EdgeDetector::operator=(EdgeDetector&&) = default;
EdgeDetector::~EdgeDetector() = default;

void EdgeDetector::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& edges)
{
  impl_->apply(image, encoding, edges);
}

}  // namespace robot_vision
