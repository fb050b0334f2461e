#include "motion_background.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/image/gray_line_buffer.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// By how much the image is brighter than the reference: the median over a grid of pixels.
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

/// The learning rate by which MOG2 takes what is new for background after as many frames as a running average takes,
/// in which so much of the old background is left by then.
double modelRate(double learning_rate, double background_ratio)
{
  constexpr double kLastShare = 25.0 / 255.0;  // at which white on black is no longer above the default threshold
  constexpr double kMaxRate = 0.9;             // of the one by which what is new would be background at once
  // MOG2 takes it for background when what was there before, which loses a share of `rate` in each frame, weighs less
  // than background_ratio.
  const double rate = 1.0 - std::pow(1.0 - learning_rate, std::log(background_ratio) / std::log(kLastShare));
  return std::min(rate, kMaxRate * (1.0 - background_ratio));
}

}  // namespace

void MotionBackground::configure(const MotionParams& params)
{
  if (params.method != params_.method) clear();
  params_ = params;
  if (!reference_.blurred.empty()) reference_.blurred = blurred(reference_.gray, params_.blur_size);
}

EncodedImage MotionBackground::prepare(const cv::Mat& image, const std::string& encoding)
{
  checkPixels(image, encoding);
  if (params_.method == "mog2") return {buffer_.bgr(image, encoding), "bgr8"};
  // FrameDifference converts such rows itself; but the other methods, and the brightness, need the gray image, too.
  const bool is_compared_only = params_.method == "first_frame" && !params_.ignore_light;
  if (is_compared_only && GrayLineBuffer::takes(encoding)) return {image, encoding};
  return {buffer_.gray(image, encoding), "mono8"};
}

void MotionBackground::begin(const EncodedImage& image, const std::string& encoding)
{
  clear();  // until the new background is complete
  encoding_ = encoding;
  if (params_.method == "mog2")
  {
    mog2_ = cv::createBackgroundSubtractorMOG2();
    cv::Mat unused;
    mog2_->apply(image.pixels, unused, 1.0);
  }
  else
  {
    cv::Mat gray;
    toGray(image.pixels, image.encoding, gray);
    gray.copyTo(reference_.gray);  // as `gray` may share the pixels of the image
    if (params_.method == "first_frame") reference_.blurred = blurred(reference_.gray, params_.blur_size);
    if (params_.method == "running_average") reference_.gray.convertTo(average_, CV_32F);
  }
  size_ = image.pixels.size();
}

void MotionBackground::clear()
{
  size_ = {};
  reference_ = {};
  mog2_.release();
}

cv::Rect MotionBackground::compare(const EncodedImage& image, cv::Mat& mask)
{
  if (mog2_) return compareWithModel(image, mask);
  const cv::Rect part = compareWithReference(image, mask);
  learn(image.pixels);
  return part;
}

/// MOG2 compares and learns at once.
cv::Rect MotionBackground::compareWithModel(const EncodedImage& image, cv::Mat& mask)
{
  mog2_->apply(image.pixels, mask, modelRate(params_.learning_rate, mog2_->getBackgroundRatio()));
  cv::compare(mask, 255.0, mask, cv::CMP_EQ);  // shadows are 127
  if (params_.dilate > 0) cv::dilate(mask, mask, cv::Mat(), {-1, -1}, params_.dilate);
  return fullRect(mask);
}

cv::Rect MotionBackground::compareWithReference(const EncodedImage& image, cv::Mat& mask)
{
  if (!params_.ignore_light) return difference_.find(image, reference_, params_, mask);
  cv::subtract(image.pixels, cv::Scalar(brighterBy(image.pixels, reference_.gray)), relit_);
  return difference_.find({relit_, "mono8"}, reference_, params_, mask);
}

void MotionBackground::learn(const cv::Mat& gray)
{
  if (params_.method == "previous_frame") gray.copyTo(reference_.gray);
  if (params_.method != "running_average") return;
  cv::accumulateWeighted(gray, average_, params_.learning_rate);
  average_.convertTo(reference_.gray, CV_8U);
}

}  // namespace robot_vision
