#include "robot_vision/people/people_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "core/common/work_limit.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinWindows = 1.5;  // that an image is shrunk to, along either side: a window alone fits nobody well
constexpr int kBlockStride = 8;      // px, of the models
constexpr int kCell = 4;             // px, that a stride is a multiple of
constexpr int kMaxSizes = 1000;      // more than an image has; OpenCV's 64 end at 454 px with a scale of 1.02
constexpr double kMaxSteps = 1.2e8;  // of detectMultiScale for an image, some 40 ns each

cv::HOGDescriptor makeDescriptor(const PeopleParams& params)
{
  validate(params);
  cv::HOGDescriptor hog;
  if (params.model == "daimler")
  {
    hog = cv::HOGDescriptor({48, 96}, {16, 16}, {8, 8}, {8, 8}, 9);  // without gamma correction, as it was trained
    hog.setSVMDetector(cv::HOGDescriptor::getDaimlerPeopleDetector());
  }
  else
    hog.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  hog.nlevels = kMaxSizes;
  return hog;
}

/// The nearest stride that is a multiple of kCell. OpenCV computes a block at each multiple of what divides the stride
/// and kBlockStride: with odd strides at every pixel, which takes ten times as long.
int strideOf(const PeopleParams& params)
{
  return (params.win_stride + kCell / 2) / kCell * kCell;
}

/// Work for each pixel of an image: the blocks of the images of all sizes, of which there is one for each kBlockStride
/// in both directions.
double stepsOf(const cv::Size& image, const cv::Size& window, const PeopleParams& params)
{
  const double smallest = std::min(1.0 * image.width / window.width, 1.0 * image.height / window.height);
  double pixels = 0.0;  // as a share of the image's
  for (double scale = 1.0; scale <= smallest; scale *= params.scale)
    pixels += 1.0 / (scale * scale);
  const int finer = kBlockStride / std::gcd(kBlockStride, strideOf(params));
  return pixels * finer * finer;
}

/// A box in an image that is larger by these factors, and inside of it.
cv::Rect enlarged(const cv::Rect& box, double scale_x, double scale_y, const cv::Size& image)
{
  const cv::Point corner(cvRound(box.x * scale_x), cvRound(box.y * scale_y));
  const cv::Point end(cvRound(box.br().x * scale_x), cvRound(box.br().y * scale_y));
  return cv::Rect(corner, end) & cv::Rect({0, 0}, image);
}

/// Threads find windows in any order.
bool isSurer(const Person& a, const Person& b)
{
  const auto key = [](const Person& one)
  { return std::make_tuple(-one.weight, one.box.x, one.box.y, one.box.width, one.box.height); };
  return key(a) < key(b);
}

}  // namespace

PeopleDetector::PeopleDetector(const PeopleParams& params) : params_(params), hog_(makeDescriptor(params))
{
}

/// How much smaller an image of this size is searched.
double PeopleDetector::scaleOf(const cv::Size& image) const
{
  const cv::Size2d window = hog_.winSize;
  const double smallest = kMinWindows * std::max(window.width / image.width, window.height / image.height);
  const double by_width = std::max(static_cast<double>(params_.max_width) / image.width, smallest);
  const double by_height = params_.min_height > 0 ? window.height / params_.min_height : 1.0;
  return std::min({1.0, by_width, by_height});
}

std::vector<Person> PeopleDetector::detect(const cv::Mat& image, const std::string& encoding) const
{
  cv::Mat bgr;
  toBgr(image, encoding, bgr);
  const cv::Size size = scaledSize(bgr.size(), scaleOf(bgr.size()));
  // OpenCV would read beyond an image that is smaller than its window.
  if (size.width < hog_.winSize.width || size.height < hog_.winSize.height) return {};
  requireWork("max_width is " + toText(params_.max_width) + " with scale " + toText(params_.scale) +
                  " and win_stride " + toText(params_.win_stride),
              stepsOf(size, hog_.winSize, params_), size, kMaxSteps);
  cv::Mat smaller = bgr;
  if (size != bgr.size()) cv::resize(bgr, smaller, size, 0.0, 0.0, cv::INTER_AREA);

  std::vector<cv::Rect> boxes;
  std::vector<double> weights;
  const cv::Size stride(strideOf(params_), strideOf(params_)), padding(params_.padding, params_.padding);
  hog_.detectMultiScale(smaller, boxes, weights, params_.hit_threshold, stride, padding, params_.scale,
                        params_.group_threshold, params_.mean_shift);
  const double scale_x = static_cast<double>(bgr.cols) / size.width;
  const double scale_y = static_cast<double>(bgr.rows) / size.height;
  std::vector<Person> people;
  for (std::size_t i = 0; i < boxes.size(); ++i)
  {
    const cv::Rect box = enlarged(boxes[i], scale_x, scale_y, bgr.size());
    if (!box.empty()) people.push_back({box, weights[i], 1.0 / (1.0 + std::exp(-weights[i]))});
  }
  std::sort(people.begin(), people.end(), isSurer);
  people.resize(std::min(people.size(), static_cast<std::size_t>(params_.max_people)));
  return people;
}

}  // namespace robot_vision
