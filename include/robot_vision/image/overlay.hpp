#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

// What is drawn over a picture for people to look at. Pictures are CV_8UC3, colours BGR; positions are px, those in
// floating point are drawn to a sixteenth of a pixel, and what lies outside of the picture is cut off. All functions
// throw std::invalid_argument if a picture is not CV_8UC3.

/// Writes the picture where the mask (CV_8UC1, of the same size) is not 0, and black elsewhere, into `out`, which is
/// reused if it fits and must not share pixels with `bgr`. Throws std::invalid_argument if the mask does not fit.
void maskPicture(const cv::Mat& bgr, const cv::Mat& mask, cv::Mat& out);

/// Draws a closed polygon, and `label` (ASCII, may be empty) above it, or wherever next to it there is room.
void drawOutline(cv::Mat& bgr, const std::vector<cv::Point>& outline, const std::string& label,
                 const cv::Scalar& color = cv::Scalar(0, 255, 0));

/// Writes one line of text (ASCII) from `position`, the left end of the line that the letters stand on.
void drawText(cv::Mat& bgr, const std::string& text, const cv::Point& position,
              const cv::Scalar& color = cv::Scalar(0, 255, 0));

/// Draws a ball as a circle and a dot in the middle; if it is only predicted, the circle is thin and dashed.
void drawBall(cv::Mat& bgr, const cv::Point2d& center, double radius, bool predicted = false);

/// Draws the way of a ball through its last centres, the newest last, growing in width towards it. A centre that is not
/// finite interrupts the way.
void drawTrail(cv::Mat& bgr, const std::vector<cv::Point2d>& centers);

}  // namespace robot_vision
