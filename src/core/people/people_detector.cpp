#include "robot_vision/people/people_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "core/common/work_limit.hpp"
#include "core/image/rects.hpp"
#include "person_windows.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinWindows = 1.5;  // that an image is shrunk to, along either side: a window alone fits nobody well
constexpr int kBlockStride = 8;      // px, of the models
constexpr int kCell = 4;             // px, that a stride is a multiple of
constexpr double kMaxSteps = 1.2e8;  // of findWindows() for an image, some 40 ns each

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
  double pixels = 0.0;  // as a share of the image's
  for (const double scale : windowScales(image, window, params.scale))
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

  PersonWindows found = findWindows(hog_, smaller, {strideOf(params_), strideOf(params_)}, params_);
  groupWindows(hog_, found, params_);
  const double scale_x = static_cast<double>(bgr.cols) / size.width;
  const double scale_y = static_cast<double>(bgr.rows) / size.height;
  std::vector<Person> people;
  for (std::size_t i = 0; i < found.boxes.size(); ++i)
  {
    const cv::Rect box = enlarged(found.boxes[i], scale_x, scale_y, bgr.size());
    const double weight = found.weights[i];
    if (!box.empty()) people.push_back({box, weight, 1.0 / (1.0 + std::exp(-weight))});
  }
  std::sort(people.begin(), people.end(), isSurer);
  people.resize(std::min(people.size(), static_cast<std::size_t>(params_.max_people)));
  return people;
}

}  // namespace robot_vision
