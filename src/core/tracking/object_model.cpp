#include "object_model.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <stdexcept>
#include <string>

#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxModelSide = 96;        // px
constexpr int kMinRegionSide = 16;       // px
constexpr double kUpscaledSide = 48.0;   // px, shorter side of the model of a small region
constexpr int kMinPoints = 8;            // of a region that can be followed
constexpr int kBorderWidth = 3;          // px along the edge of the model that have no points
constexpr int kWindow = 13;              // px, side of the window around a point that is compared
constexpr double kMinContrast = 6e-5;    // smallest eigenvalue of the gradients around a point
constexpr double kMaxPointError = 0.04;  // of the model's side; objects are neither quite flat nor quite rigid
constexpr int kIterations = 2;           // of corrections; the first may bring more points into view
const cv::Size kFlowWindow(13, 13);
constexpr int kFlowLevels = 2;

void checkRegion(const cv::Size& image, const cv::Rect& region)
{
  if (region.width < kMinRegionSide || region.height < kMinRegionSide)
    throw std::invalid_argument(regionText(region) + " is too small, must be at least 16x16 px inside the image of " +
                                toText(image));
  requireInside(region, image);
}

/// Smooths pixels so that patches can be compared that differ in noise, blur and resolution.
cv::Mat smoothed(const cv::Mat& pixels)
{
  cv::Mat smooth;
  cv::GaussianBlur(pixels, smooth, {5, 5}, 1.2);
  return smooth;
}

/// The strongest corners whose contrast is large enough.
std::vector<cv::Point2f> findPoints(const cv::Mat& pixels, int count)
{
  const int block = 7;
  const double distance = std::max(3.0, std::sqrt(pixels.total() / (2.0 * count)));
  cv::Mat mask = cv::Mat::zeros(pixels.size(), CV_8UC1), contrast;
  mask(cv::Rect(kBorderWidth, kBorderWidth, pixels.cols - 2 * kBorderWidth, pixels.rows - 2 * kBorderWidth)).setTo(255);
  cv::cornerMinEigenVal(pixels, contrast, block);
  mask.setTo(0, contrast < kMinContrast);
  std::vector<cv::Point2f> points;
  cv::goodFeaturesToTrack(pixels, points, count, 0.005, distance, mask, block);
  return points;
}

/// Gives a window the mean 0 and the norm 1. Returns false if it has no contrast.
bool normalize(cv::Mat& window)
{
  window -= cv::mean(window)[0];
  const double norm = cv::norm(window);
  if (norm < 1e-3) return false;
  window *= 1.0 / norm;
  return true;
}

cv::Mat windowAt(const cv::Mat& pixels, const cv::Point2f& point)
{
  cv::Mat window;
  cv::getRectSubPix(pixels, {kWindow, kWindow}, point, window, CV_32F);
  return window;
}

/// Gives the pixels the brightness and contrast of the model, fitted to those pixels that agree, as others may be
/// covered.
void matchBrightness(cv::Mat& pixels, const cv::Mat& model)
{
  double gain = 1.0, offset = 0.0, limit = 1e9;
  for (int round = 0; round < 3; ++round)
  {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, errors = 0;
    for (int row = 0; row < pixels.rows; row += 2)
      for (int column = 0; column < pixels.cols; column += 2)
      {
        const double from = pixels.at<uchar>(row, column), to = model.at<uchar>(row, column);
        const double error = gain * from + offset - to;
        if (from == 0.0 || std::abs(error) > limit) continue;  // pixels outside of the image are 0
        n += 1, x += from, y += to, xx += from * from, xy += from * to, errors += error * error;
      }
    const double variance = n * xx - x * x;
    if (variance <= 0.0) return;
    gain = std::clamp((n * xy - x * y) / variance, 0.25, 4.0);
    offset = (y - gain * x) / n;
    limit = round == 0 ? 40.0 : 1.5 * std::sqrt(errors / n) + 5.0;
  }
  pixels.convertTo(pixels, CV_8U, gain, offset);
}

}  // namespace

ObjectModel::ObjectModel(const cv::Mat& gray, const cv::Rect& region, int points)
{
  checkRegion(gray.size(), region);
  const double longest = std::max(region.width, region.height), shortest = std::min(region.width, region.height);
  // Small regions are enlarged, because points keep a distance from the edge and from each other.
  const double larger = std::max(1.0, std::min(kMaxModelSide / longest, kUpscaledSide / shortest));
  const double shrunk = std::min(larger, std::max(kMaxModelSide / longest, kMinRegionSide / shortest));
  cv::Mat small;
  cv::resize(gray(region), small, {}, shrunk, shrunk, shrunk > 1.0 ? cv::INTER_LINEAR : cv::INTER_AREA);
  pixels_ = smoothed(small);
  points_ = findPoints(pixels_, points);
  if (static_cast<int>(points_.size()) < kMinPoints)
    throw std::invalid_argument(regionText(region) + " has " + std::to_string(points_.size()) +
                                " feature points, must have at least " + std::to_string(kMinPoints) +
                                ": select something with a pattern");
  cv::buildOpticalFlowPyramid(pixels_, pyramid_, kFlowWindow, kFlowLevels, true);
  for (const cv::Point2f& point : points_)
  {
    windows_.push_back(windowAt(pixels_, point));
    normalize(windows_.back());
  }
  const double scale = 1.0 / shrunk, half = 0.5 * (scale - 1.0);  // integer coordinates are those of pixel centres
  first_pose_ = {scale, 0.0, {region.x + half, region.y + half}};
  const auto right = static_cast<float>(region.width * shrunk - 0.5);
  const auto bottom = static_cast<float>(region.height * shrunk - 0.5);
  corners_ = {{-0.5F, -0.5F}, {right, -0.5F}, {right, bottom}, {-0.5F, bottom}};
  center_ = {0.5 * (right - 0.5), 0.5 * (bottom - 0.5)};
}

cv::Mat ObjectModel::warped(FlowImage& image, const FlowParams& params, const Similarity& pose) const
{
  int halvings = cvRound(std::log2(std::max(pose.scale(), 1.0)));  // avoids aliasing
  const cv::Mat& pixels = image.halved(params, halvings);
  const double factor = std::ldexp(1.0, -halvings);
  const Similarity smaller{pose.a * factor, pose.b * factor, pose.shift * factor};
  cv::Mat patch;
  cv::warpAffine(pixels, patch, smaller.matrix(), pixels_.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT);
  return smoothed(patch);
}

std::vector<std::size_t> ObjectModel::findIn(const cv::Mat& patch, double min_similarity,
                                             std::vector<cv::Point2f>& found) const
{
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 15, 0.02);
  std::vector<uchar> status;
  std::vector<float> unused;
  found = points_;
  cv::calcOpticalFlowPyrLK(pyramid_, patch, points_, found, status, unused, kFlowWindow, kFlowLevels, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  std::vector<std::size_t> alike;
  for (std::size_t i = 0; i < points_.size(); ++i)
  {
    if (!status[i]) continue;
    cv::Mat window = windowAt(patch, found[i]);
    if (normalize(window) && window.dot(windows_[i]) >= min_similarity) alike.push_back(i);
  }
  return alike;
}

ModelFit ObjectModel::fit(FlowImage& image, const FlowParams& params, const Similarity& pose,
                          double min_similarity) const
{
  ModelFit result{pose, {}, {}};
  const double tolerance = std::max(1.5, kMaxPointError * std::sqrt(static_cast<double>(pixels_.total())));
  const cv::Rect2d inside({0.0, 0.0}, cv::Size2d(image.size()));
  for (int round = 0; round < kIterations; ++round)
  {
    result.seen.clear();
    result.positions.clear();
    cv::Mat patch = warped(image, params, result.pose);
    matchBrightness(patch, pixels_);
    std::vector<cv::Point2f> found, from, to;
    std::vector<std::size_t> alike = findIn(patch, min_similarity, found);
    const auto is_outside = [&](std::size_t i) { return !inside.contains(result.pose(cv::Point2d(found[i]))); };
    alike.erase(std::remove_if(alike.begin(), alike.end(), is_outside), alike.end());
    for (const std::size_t i : alike)
    {
      from.push_back(points_[i]);
      to.push_back(found[i]);
    }
    const auto correction = fitSimilarity(from, to, tolerance, kMinPoints / 2);
    if (!correction) return result;
    for (const std::size_t i : alike)
    {
      if (cv::norm((*correction)(cv::Point2d(points_[i])) - cv::Point2d(found[i])) > tolerance) continue;
      result.seen.push_back(i);
      result.positions.emplace_back(result.pose(cv::Point2d(found[i])));
    }
    result.pose = result.pose * *correction;
  }
  return result;
}

}  // namespace robot_vision
