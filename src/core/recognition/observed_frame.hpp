#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "padded_image.hpp"
#include "view_camera.hpp"

namespace robot_vision
{

/// Sides (px) of the squares whose bins are united: an object's part may be anywhere in one.
constexpr std::array<int, 10> kWindows = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32};

struct EdgeLimits
{
  int contrast = 0;   // gray levels, smallest step of an edge
  float jump = 0.0F;  // smallest step of an edge of depth, as share of the depth
};

inline std::uint32_t nearestOf(std::uint32_t range)
{
  return range & 0xFFFF;
}

inline std::uint32_t farthestOf(std::uint32_t range)
{
  return range >> 16;
}

/// What an image and its depths show, in bins (feature_bins.hpp), at the resolution of a ViewCamera. Memory is kept
/// from frame to frame.
class ObservedFrame
{
public:
  /// Makes it of a frame. `bgr` is CV_8UC3 or CV_8UC1, `depth` CV_16UC1 (mm) or CV_32FC1 (m), of the camera's size;
  /// one of them may be empty.
  void observe(const ViewCamera& camera, const cv::Mat& bgr, const cv::Mat& depth, const EdgeLimits& limits);

  const cv::Size& size() const { return size_; }
  bool hasDepth() const { return has_depth_; }

  /// The inverse depth (1/m) of the nearest surface in each pixel, 0: none; and how it changes with x and y of the ray,
  /// where there is a bin of its normal.
  const PaddedImage<float>& inverses() const { return inverses_; }
  const PaddedImage<float>& across() const { return across_; }
  const PaddedImage<float>& along() const { return along_; }

  /// The bins in squares of kWindows[i] px whose top left corner a pixel is: in the lowest byte of edges of the image,
  /// in the next one of edges of depth, or of the image again if there is no depth, then of surfaces.
  PaddedImages<std::uint32_t>::ConstView bins(std::size_t i) const { return bins_[i]; }

  /// The number of pixels with an edge, of depth if it is known, in a rectangle, as far as it is in the image.
  int edges(int left, int top, int right, int bottom) const
  {
    const auto clamped = [](int position, int size) { return std::clamp(position, 0, size); };
    const int* const above = edge_sums_.ptr<int>(clamped(top, size_.height));
    const int* const below = edge_sums_.ptr<int>(clamped(bottom, size_.height));
    const int first = clamped(left, size_.width), last = clamped(right, size_.width);
    return below[last] - below[first] - above[last] + above[first];
  }

  /// The inverse depth of the nearest surface in those squares in the lower 16 bits, of the farthest one in the upper
  /// ones, in steps of 1 / kInverseSteps; none: kNoRange.
  static constexpr float kInverseSteps = 4096.0F;
  PaddedImages<std::uint32_t>::ConstView ranges(std::size_t i) const { return ranges_[i]; }

  /// How many numbers after the bins (ranges) of a size those of the next one are.
  int nextWindow() const { return bins_.next(); }

private:
  void observeDepth(const ViewCamera& camera, const cv::Mat& depth, const EdgeLimits& limits);
  void reduceDepth(const ViewCamera& camera, const cv::Mat& depth);
  void observeImage(const ViewCamera& camera, const cv::Mat& bgr, const EdgeLimits& limits);
  void reduceImage(const ViewCamera& camera, const cv::Mat& bgr);
  void unite();
  void sumEdges();

  cv::Size size_;
  bool has_depth_ = false;
  PaddedImage<float> inverses_, filled_, across_, along_;
  PaddedImage<std::uint8_t> edges_, depth_edges_, surfaces_, octants_;
  PaddedImage<std::int16_t> magnitudes_;
  std::array<PaddedImage<std::uint8_t>, 3> channels_;
  PaddedImages<std::uint32_t> bins_, ranges_;
  AlignedRows<float> full_rows_;
  cv::Mat edge_sums_;  // CV_32SC1, of all pixels above and to the left
  cv::Mat reduced_, moved_inverses_, reduced_image_, moved_;
  std::vector<cv::Mat> planes_;
};

}  // namespace robot_vision
