#include <algorithm>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/image/conversion_buffer.hpp"
#include "core/image/filled_up.hpp"
#include "core/image/frame_sequence.hpp"
#include "dft.hpp"
#include "robot_vision/spectrum/spectrum.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinSide = 16;  // px, so that the surroundings of the peak are there

/// The next even size that cv::dft is fast with.
int evenSize(int length)
{
  return std::max(kMinSide, 2 * cv::getOptimalDFTSize((length + 1) / 2));
}

/// The image without its mean and faded out. With the mean the window would be seen in it, which never moves.
cv::Mat withoutMean(const cv::Mat& gray)
{
  const double mean = cv::sum(gray)[0] / static_cast<double>(gray.total());
  return toFloat(gray, /*is_faded=*/true, mean);
}

}  // namespace

struct PhaseCorrelator::Impl
{
  explicit Impl(const SpectrumParams& p) : params(p), sequence(p.max_gap) {}

  std::optional<ImageShift> update(double time_s, const cv::Mat& image, const std::string& encoding)
  {
    const cv::Mat gray = buffer.gray(image, encoding);
    const cv::Size size(evenSize(gray.cols), evenSize(gray.rows));
    const cv::Mat next = filledUp(withoutMean(gray), size);
    const cv::Mat before = std::exchange(last, next);
    if (!sequence.follows(time_s, gray.size())) return std::nullopt;
    ImageShift shift;
    const cv::Point2d by = cv::phaseCorrelate(before, next, cv::noArray(), &shift.response);
    shift.response = std::clamp(shift.response, 0.0, 1.0);  // the surroundings of the peak have negative parts
    shift.found = shift.response > 0.0 && shift.response >= params.min_response;
    if (shift.found)
    {
      shift.x = by.x;
      shift.y = by.y;
    }
    return shift;
  }

  SpectrumParams params;
  FrameSequence sequence;
  ConversionBuffer buffer;
  cv::Mat last;      // CV_32FC1, without its mean and faded out towards its borders
  std::mutex mutex;  // guards all above; held during a call
};

PhaseCorrelator::PhaseCorrelator(const SpectrumParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

PhaseCorrelator::~PhaseCorrelator() = default;

std::optional<ImageShift> PhaseCorrelator::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->update(time_s, image, encoding);
}

double PhaseCorrelator::interval() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->sequence.interval();
}

void PhaseCorrelator::reset()
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->sequence.reset();
}

}  // namespace robot_vision
