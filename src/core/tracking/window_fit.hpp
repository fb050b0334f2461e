#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "robot_vision/tracking/window_tracker.hpp"

namespace robot_vision
{

/// A place of an object in a back projection.
struct WindowFit
{
  cv::Rect window;                     // px, as OpenCV gives it
  std::array<cv::Point2d, 4> outline;  // px
  cv::Point2d center;                  // px, centre of mass in the upright box around the outline
  double area = 0.0;                   // px^2, of the outline
  double direction = 0.0;              // rad, of the longer side, clockwise from x, -pi/2 to pi/2; 0 for meanshift
  double similarity = 0.0;             // mean of the back projection in the outline, 0 to 1
};

/// Where cv::meanShift or cv::CamShift leads from a window (px). Nothing if that is no place where the object can be:
/// the window is outside of the image or vanishes, or area or similarity are too small.
std::optional<WindowFit> fitWindow(const cv::Mat& back_projection, const cv::Rect& window,
                                   const WindowTrackerParams& params);

/// The window of a size (px; cut off at the image's) in which the back projection has the largest sum. Nothing if that
/// is 0.
std::optional<cv::Rect> densestWindow(const cv::Mat& back_projection, const cv::Size& size);

}  // namespace robot_vision
