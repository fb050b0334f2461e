#include "robot_vision/flow/dense_flow.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>
#include <vector>

#include "core/common/in_this_thread.hpp"
#include "core/common/work_limit.hpp"
#include "core/image/conversion_buffer.hpp"
#include "core/image/filled_up.hpp"
#include "core/image/frame_sequence.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

// What OpenCV's DIS can have: with fewer px its pyramid has not all of the levels that it writes to, with more it has
// more than it has made room for.
constexpr int kMinDisSide = 32;       // px, of the smaller side
constexpr int kMinDisLength = 96;     // px, of the larger side
constexpr int kMaxDisLength = 16384;  // px

constexpr double kMaxFarnebackSteps = 5e9;  // for a frame

cv::Ptr<cv::DISOpticalFlow> makeDis(const std::string& preset)
{
  static const std::map<std::string, int> presets = {{"ultrafast", cv::DISOpticalFlow::PRESET_ULTRAFAST},
                                                     {"fast", cv::DISOpticalFlow::PRESET_FAST},
                                                     {"medium", cv::DISOpticalFlow::PRESET_MEDIUM}};
  return cv::DISOpticalFlow::create(presets.at(preset));
}

/// A size that DIS can have, of this one or larger. Throws std::invalid_argument if it is too large.
cv::Size disSize(const cv::Size& size)
{
  require(std::max(size.width, size.height) <= kMaxDisLength, "the larger side of the image that is worked on",
          std::max(size.width, size.height), "at most " + std::to_string(kMaxDisLength) + " px with dis");
  cv::Size larger(std::max(size.width, kMinDisSide), std::max(size.height, kMinDisSide));
  if (std::max(larger.width, larger.height) < kMinDisLength) larger.width = kMinDisLength;
  return larger;
}

/// What farneback does for each pixel of the image that is worked on, in all levels, in steps of 1 ns: an iteration has
/// 30 of them, and one for each pixel of the side of a Gaussian window; a level begins with as much as 3 iterations.
double farnebackSteps(const DenseFlowParams& params)
{
  double pixels = 0.0;
  for (int level = 0; level <= params.levels; ++level)
    pixels += std::pow(params.pyr_scale, 2 * level);
  return pixels * (params.iterations + 3) * (30 + (params.gaussian_window ? params.window : 0));
}

/// The flow of a smaller image as one of this size.
cv::Mat enlarged(const cv::Mat& flow, const cv::Size& size)
{
  if (flow.size() == size) return flow;
  cv::Mat large;
  cv::resize(flow, large, size, 0.0, 0.0, cv::INTER_LINEAR);
  const cv::Scalar factors(static_cast<double>(size.width) / flow.cols, static_cast<double>(size.height) / flow.rows);
  cv::multiply(large, factors, large);
  return large;
}

/// One coordinate of all pixels of a flow, in any order.
std::vector<float> component(const cv::Mat& flow, int channel)
{
  cv::Mat values;
  cv::extractChannel(flow, values, channel);
  return {values.ptr<float>(), values.ptr<float>() + values.total()};
}

/// NaN if one of the values is.
double median(std::vector<float> values)
{
  const auto unknown = std::find_if(values.begin(), values.end(), [](float value) { return std::isnan(value); });
  if (unknown != values.end()) return *unknown;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

struct DenseFlow::Impl
{
  explicit Impl(const DenseFlowParams& p) : params(p), sequence(p.max_gap)
  {
    if (p.method == "dis") dis = makeDis(p.preset);
  }

  cv::Mat update(double time_s, const cv::Mat& image, const std::string& encoding)
  {
    cv::Mat flow;
    inThisThread(
        [&]
        {
          const cv::Mat gray = buffer.gray(image, encoding);
          std::swap(last, next);
          shrink(gray);
          if (sequence.follows(time_s, gray.size())) flow = enlarged(flowBetween(), gray.size());
        });
    return flow;
  }

  /// Makes `next` of the image, whose pixels may be those of the input and are not kept.
  void shrink(const cv::Mat& gray)
  {
    const cv::Size size = scaledSize(gray.size(), params.scale);
    if (size == gray.size())
      gray.copyTo(next);
    else
      cv::resize(gray, next, size, 0.0, 0.0, cv::INTER_AREA);
  }

  /// From `last` to `next`. The result has memory of its own: what is there already DIS would take for a first guess.
  cv::Mat flowBetween()
  {
    cv::Mat flow;
    if (!dis)
    {
      requireWork("window, iterations, levels are " + toText(params.window) + ", " + toText(params.iterations) + ", " +
                      toText(params.levels) + " at scale " + toText(params.scale),
                  farnebackSteps(params), last.size(), kMaxFarnebackSteps);
      cv::calcOpticalFlowFarneback(last, next, flow, params.pyr_scale, params.levels, params.window, params.iterations,
                                   params.poly_n, params.poly_sigma,
                                   params.gaussian_window ? cv::OPTFLOW_FARNEBACK_GAUSSIAN : 0);
      return flow;
    }
    const cv::Size size = disSize(last.size());
    dis->calc(filledUp(last, size, cv::BORDER_REPLICATE), filledUp(next, size, cv::BORDER_REPLICATE), flow);
    return flow({0, 0, last.cols, last.rows});
  }

  DenseFlowParams params;
  FrameSequence sequence;
  ConversionBuffer buffer;
  cv::Ptr<cv::DISOpticalFlow> dis;  // null for farneback
  cv::Mat last, next;               // CV_8UC1, shrunk; both keep their memory
  std::mutex mutex;                 // guards all above; held during a call
};

DenseFlow::DenseFlow(const DenseFlowParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

DenseFlow::~DenseFlow() = default;

cv::Mat DenseFlow::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->update(time_s, image, encoding);
}

double DenseFlow::interval() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->sequence.interval();
}

void DenseFlow::reset()
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->sequence.reset();
}

cv::Point2d meanFlow(const cv::Mat& flow)
{
  checkPixels(flow, "32FC2", CV_32FC2);
  const cv::Scalar mean = cv::mean(flow);
  return {mean[0], mean[1]};
}

cv::Point2d medianFlow(const cv::Mat& flow)
{
  checkPixels(flow, "32FC2", CV_32FC2);
  return {median(component(flow, 0)), median(component(flow, 1))};
}

}  // namespace robot_vision
