#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <opencv2/core.hpp>

#include "candidates.hpp"
#include "object_mask.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/dnn/head_decoder.hpp"
#include "suppression.hpp"

namespace robot_vision
{

/// The way from a network's input to the image.
class ImageFrame
{
public:
  /// Throws std::invalid_argument for a scale that is not finite and above 0, and for an empty image.
  ImageFrame(const InputPlacement& placement, const cv::Size& image) : placement_(placement), image_(image)
  {
    for (const double scale : {placement.scale_x, placement.scale_y})
      require(std::isfinite(scale) && scale > 0.0, "scale of the placement", scale, "finite and above 0");
    requireFinite("left of the placement", placement.left);
    requireFinite("top of the placement", placement.top);
    require(!image.empty(), "size of the image", toText(image), "at least 1x1");
  }

  cv::Point2d point(double x, double y) const
  {
    return {(x - placement_.left) / placement_.scale_x + placement_.x,
            (y - placement_.top) / placement_.scale_y + placement_.y};
  }

  /// The box around points, cut off at the border of the image; its sides are 0 or less if it is outside.
  template <class Points>
  CornerBox boxAround(const Points& points) const
  {
    CornerBox box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const cv::Point2d& p : points)
    {
      const cv::Point2d at = point(p.x, p.y);
      box = {std::min(box.x0, at.x), std::min(box.y0, at.y), std::max(box.x1, at.x), std::max(box.y1, at.y)};
    }
    const double width = image_.width, height = image_.height;
    return {std::clamp(box.x0, 0.0, width), std::clamp(box.y0, 0.0, height), std::clamp(box.x1, 0.0, width),
            std::clamp(box.y1, 0.0, height)};
  }

  /// The box of a candidate in the image.
  CornerBox boxOf(const Candidate& candidate, bool oriented) const
  {
    if (oriented) return boxAround(outlineOf(candidate));
    const CornerBox& box = candidate.box;
    return boxAround(std::initializer_list<cv::Point2d>{{box.x0, box.y0}, {box.x1, box.y1}});
  }

  /// From columns of the image to those of an image that is `width` px wide, where the input is `input` px; and rows.
  AxisPlacement columns(double width, double input) const
  {
    const double scale = width / input;
    return {placement_.scale_x * scale, (placement_.left - placement_.scale_x * placement_.x) * scale};
  }
  AxisPlacement rows(double height, double input) const
  {
    const double scale = height / input;
    return {placement_.scale_y * scale, (placement_.top - placement_.scale_y * placement_.y) * scale};
  }

private:
  InputPlacement placement_;
  cv::Size image_;
};

}  // namespace robot_vision
