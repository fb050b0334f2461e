#include "robot_vision/motion/motion.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>
#include <optional>

#include "core/image/gray_line_buffer.hpp"
#include "frame_difference.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kOutlineError = 1.0;  // px; the blur has made it a matter of several

RegionParams regionParams(const MotionParams& params)
{
  RegionParams regions;
  regions.min_area = params.min_area;
  regions.opening = regions.closing = 1;
  return regions;
}

/// By how much the picture is brighter than the reference: the median over a grid of pixels.
int brighterBy(const cv::Mat& gray, const cv::Mat& reference)
{
  const int step = std::max(1, std::min(gray.rows, gray.cols) / 48);
  std::vector<int> differences;
  for (int y = step / 2; y < gray.rows; y += step)
    for (int x = step / 2; x < gray.cols; x += step)
      differences.push_back(gray.at<uchar>(y, x) - reference.at<uchar>(y, x));
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

}  // namespace

void validate(const MotionParams& params)
{
  checkFields(params);
}

struct MotionDetector::Impl
{
  explicit Impl(const MotionParams& p) : params(p), finder(regionParams(p)) {}

  bool isNew(double time_s, const EncodedPicture& picture) const
  {
    return size != picture.pixels.size() || encoding != picture.encoding || time_s < last_time;
  }

  /// The picture as it is compared: in colours where only shadows look like what they fall on, as it is where its rows
  /// can be made gray while they are compared, otherwise gray.
  EncodedPicture prepare(const cv::Mat& image, const std::string& image_encoding)
  {
    checkPixels(image, image_encoding);
    const bool is_compared_only = params.method == "first_frame" && !params.ignore_light;
    if (is_compared_only && GrayLineBuffer::takes(image_encoding)) return {image, image_encoding};
    EncodedPicture picture{converted, params.method == "mog2" ? "bgr8" : "mono8"};
    if (params.method == "mog2")
      toBgr(image, image_encoding, picture.pixels);
    else
      toGray(image, image_encoding, picture.pixels);
    if (!sharesPixels(picture.pixels, image)) converted = picture.pixels;  // the input's must not be kept
    return picture;
  }

  /// Takes the picture for the background.
  void begin(const EncodedPicture& picture)
  {
    size = {};  // none until all of it is there
    encoding = picture.encoding;
    everywhere_since.reset();
    if (params.method == "mog2")
    {
      mog2 = cv::createBackgroundSubtractorMOG2();
      cv::Mat unused;
      mog2->apply(picture.pixels, unused, 1.0);
    }
    else
    {
      cv::Mat gray;
      toGray(picture.pixels, encoding, gray);
      gray.copyTo(background.gray);  // some are what they are gray of
      if (params.method == "first_frame") background.blurred = blurred(background.gray, params.blur_size);
      if (params.method == "running_average") background.gray.convertTo(average, CV_32F);
    }
    size = picture.pixels.size();
  }

  /// A mask to be written. The last one, if nobody holds it any more: it costs less than new memory.
  void renewMask(const cv::Size& of)
  {
    const bool is_free = mask.size() == of && mask.u->refcount == 1;
    std::atomic_thread_fence(std::memory_order_acquire);  // after the last reader's release in another thread
    if (!is_free) mask = cv::Mat(of, CV_8UC1);
  }

  /// Makes the mask. Returns a part outside of which it is black.
  cv::Rect compare(const EncodedPicture& picture)
  {
    if (mog2)
    {
      mog2->apply(picture.pixels, mask, params.learning_rate);
      cv::compare(mask, 255.0, mask, cv::CMP_EQ);  // shadows are 127
      if (params.dilate > 0) cv::dilate(mask, mask, cv::Mat(), {-1, -1}, params.dilate);
      return {{0, 0}, mask.size()};
    }
    if (params.ignore_light) cv::subtract(picture.pixels, cv::Scalar(brighterBy(picture.pixels, background.gray)), lit);
    const EncodedPicture compared = params.ignore_light ? EncodedPicture{lit, "mono8"} : picture;
    const Comparison how{params.blur_size, params.threshold, params.dilate};
    return changed_pixels.find(compared, background, how, mask);
  }

  void learn(const cv::Mat& picture)
  {
    if (params.method == "previous_frame") picture.copyTo(background.gray);
    if (params.method != "running_average") return;
    cv::accumulateWeighted(picture, average, params.learning_rate);
    average.convertTo(background.gray, CV_8U);
  }

  MotionParams params;
  RegionFinder finder;
  FrameDifference changed_pixels;
  Reference background;  // blurred for first_frame only: the others have another one in every frame
  cv::Size size;         // of the picture that it is of
  std::string encoding;  // of the same
  cv::Mat average;       // CV_32FC1, from which it is rounded
  cv::Mat lit;           // the picture in the background's light
  cv::Mat mask;          // the last one that was given away
  cv::Mat converted;     // memory for the next picture
  cv::Ptr<cv::BackgroundSubtractorMOG2> mog2;
  double last_time = 0.0;                  // s
  std::optional<double> everywhere_since;  // s
};

MotionDetector::MotionDetector(const MotionParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

MotionDetector::~MotionDetector() = default;
MotionDetector::MotionDetector(MotionDetector&&) noexcept = default;
MotionDetector& MotionDetector::operator=(MotionDetector&&) noexcept = default;

Motion MotionDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  Impl& me = *impl_;
  const EncodedPicture picture = me.prepare(image, encoding);
  Motion motion;
  const bool is_new = me.isNew(time_s, picture);
  me.last_time = time_s;
  me.renewMask(picture.pixels.size());
  motion.mask = me.mask;
  if (is_new)
  {
    me.begin(picture);
    me.mask.setTo(0);
    return motion;
  }
  const cv::Rect part = me.compare(picture);
  me.learn(picture.pixels);
  motion.changed = cv::countNonZero(motion.mask(part)) / static_cast<double>(motion.mask.total());
  motion.everywhere = motion.changed > me.params.max_changed;
  if (!motion.everywhere)
  {
    me.everywhere_since.reset();
    motion.regions = me.finder.apply(motion.mask, part);
    for (Region& region : motion.regions)
      cv::approxPolyDP(region.outline, region.outline, kOutlineError, true);
    return motion;
  }
  if (!me.everywhere_since) me.everywhere_since = time_s;
  if (time_s - *me.everywhere_since >= me.params.settle) me.begin(picture);
  return motion;
}

void MotionDetector::reset()
{
  impl_->size = {};
}

}  // namespace robot_vision
