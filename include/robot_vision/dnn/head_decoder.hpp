#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/dnn/head_params.hpp"
#include "robot_vision/dnn/network_input.hpp"

namespace robot_vision
{

/// An array of numbers that a network gives, row by row without gaps. The numbers are the caller's.
struct NetworkOutput
{
  std::vector<std::int64_t> shape;
  const float* values = nullptr;
};

/// A box by two of its corners, px; coordinates are continuous, as of InputPlacement.
struct CornerBox
{
  double x0 = 0.0;
  double y0 = 0.0;
  double x1 = 0.0;
  double y1 = 0.0;
};

/// The pixels that a box touches by more than a thousandth of a pixel; one at least.
cv::Rect pixelsOf(const CornerBox& box);

struct ObjectKeypoint
{
  float x = 0.0F;  // px of the image, which it may be outside of
  float y = 0.0F;
  float score = 0.0F;  // 0 to 1; 1 for all of a network that gives none. 0 at (0, 0) for what is not finite.
};

/// What a network has found in an image.
struct FoundObject
{
  int class_id = 0;
  double score = 0.0;                // the network's, 0 to 1
  CornerBox box;                     // px of the whole image, inside of it
  std::vector<cv::Point2f> outline;  // of an oriented box: its corners clockwise, which may be outside of the image
  std::vector<ObjectKeypoint> keypoints;  // of a pose
  cv::Mat mask;                           // 8UC1 of pixelsOf(box): 255 on the object, else 0; empty without one

  /// The middle of the outline or, without one, of the box, px.
  cv::Point2d center() const;
};

/// Makes objects of what a network gives, for one image at a time. Each family of networks has its own layout
/// (docs/object_detector.md lists them); leading axes of length 1 may be missing. These are the rules for all:
///
/// - Of a box with scores for several classes, the class with the highest counts, of equals the first.
/// - Its score must be at least the threshold of the class; an objectness, where there is one, the lowest threshold.
/// - What is not finite is left out, be it a score or a coordinate of a box: such a class is none, such a box is none,
///   and neither is a box of detr with a logit of NaN or infinity, a box without area, and one outside of the image.
/// - Of more than kMaxCandidates boxes, those with the highest scores count; of equals, the first.
/// - Then, except for ssd, yolov10, detr and rtdetr, whose networks do that, the surest box is kept, those of its class
///   that overlap it by an intersection over union above iou_threshold are left out, and so on. Oriented boxes overlap
///   by the area that both cover.
/// - A mask has the pixels of the image with their centres in the box at which the sigmoid of the weighted sum of the
///   prototypes, interpolated linearly, is above 0.5. The surest objects have masks, until those have kMaxMaskPixels.
class HeadDecoder
{
public:
  static constexpr std::size_t kMaxCandidates = 4096;
  static constexpr std::size_t kMaxMaskPixels = std::size_t{1} << 26;

  /// Throws std::invalid_argument as validate() does.
  explicit HeadDecoder(const HeadParams& params = HeadParams());

  /// The objects in an image of this size, of which the input was filled as `placement` says; the surest first, of
  /// equals the first in the outputs. Throws std::invalid_argument naming the head, the shape seen and the one expected
  /// for outputs that are not the head's, and naming the scale for one that is not finite and above 0.
  std::vector<FoundObject> decode(const std::vector<NetworkOutput>& outputs, const InputPlacement& placement,
                                  const cv::Size& image) const;

private:
  HeadParams params_;
};

}  // namespace robot_vision
