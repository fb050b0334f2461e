#include "robot_vision/motion/motion.hpp"

#include <atomic>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "motion_background.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kOutlineError = 1.0;  // px; the blur has moved the outline by more than that

RegionFinder finderOf(const MotionParams& params)
{
  return RegionFinder({params.min_area, /*opening=*/1, /*closing=*/1});
}

}  // namespace

struct MotionDetector::Impl
{
  explicit Impl(const MotionParams& p) : params(p), finder(finderOf(p)), background(p) {}

  void configure(const MotionParams& p)
  {
    if (p.method != params.method) everywhere_since.reset();
    params = p;
    finder = finderOf(p);
    background.configure(p);
  }

  Motion update(double time_s, const cv::Mat& image, const std::string& encoding)
  {
    requireFinite("time_s", time_s);
    const EncodedImage frame = background.prepare(image, encoding);
    const bool is_earlier = time_s < last_time;
    last_time = time_s;
    if (is_earlier) everywhere_since.reset();
    // What the first frame shows is the background whenever it was.
    const bool is_new = (is_earlier && params.method != "first_frame") || !background.fits(frame, encoding);
    Motion motion;
    motion.mask = writableMask(frame.pixels.size());
    if (is_new)
    {
      begin(frame, encoding);
      motion.mask.setTo(0);
      return motion;
    }
    const cv::Rect part = background.compare(frame, motion.mask);
    motion.changed = cv::countNonZero(motion.mask(part)) / static_cast<double>(motion.mask.total());
    motion.everywhere = motion.changed > params.max_changed;
    if (motion.everywhere)
      settle(time_s, frame, encoding);
    else
    {
      everywhere_since.reset();
      motion.regions = findRegions(part);
    }
    return motion;
  }

  void begin(const EncodedImage& frame, const std::string& encoding)
  {
    everywhere_since.reset();
    background.begin(frame, encoding);
  }

  /// Takes what is seen for the new background once the whole image has differed from the old one for long enough.
  void settle(double time_s, const EncodedImage& frame, const std::string& encoding)
  {
    if (!everywhere_since) everywhere_since = time_s;
    if (time_s - *everywhere_since >= params.settle) begin(frame, encoding);
  }

  /// The regions of the mask, which is black outside of `part`, with simplified outlines.
  std::vector<Region> findRegions(const cv::Rect& part)
  {
    std::vector<Region> regions = finder.apply(mask, part);
    for (Region& region : regions)
      cv::approxPolyDP(region.outline, region.outline, kOutlineError, true);
    return regions;
  }

  /// A mask that nobody else holds: the last one if possible, as that costs less than new memory.
  cv::Mat writableMask(const cv::Size& size)
  {
    const bool is_free = mask.size() == size && mask.u->refcount == 1;
    std::atomic_thread_fence(std::memory_order_acquire);  // after the last reader's release in another thread
    if (!is_free) mask = cv::Mat(size, CV_8UC1);
    return mask;
  }

  MotionParams params;
  RegionFinder finder;
  MotionBackground background;
  cv::Mat mask;                            // the last one that was returned
  double last_time = 0.0;                  // s, of the newest frame
  std::optional<double> everywhere_since;  // s, when the whole image began to differ
  std::mutex mutex;                        // guards all above; held during a call
};

MotionDetector::MotionDetector(const MotionParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

MotionDetector::~MotionDetector() = default;

void MotionDetector::configure(const MotionParams& params)
{
  validate(params);
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->configure(params);
}

Motion MotionDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->update(time_s, image, encoding);
}

void MotionDetector::reset()
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->background.clear();
}

}  // namespace robot_vision
