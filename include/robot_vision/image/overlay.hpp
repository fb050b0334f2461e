#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

// Functions that draw results into images for people to look at. Images are CV_8UC3, colours are BGR, and positions are
// in px; positions in floating point are drawn to a sixteenth of a pixel. What lies outside of the image is cut off.
// All functions throw std::invalid_argument if the image is not CV_8UC3.

/// Copies the pixels where the mask (CV_8UC1, of the same size) is not 0 to `out`, and makes it black elsewhere. `out`
/// is reused if it fits, and must not share pixels with `bgr`. Throws std::invalid_argument if the mask does not fit.
void maskPicture(const cv::Mat& bgr, const cv::Mat& mask, cv::Mat& out);

/// Draws a closed polygon with `label` (ASCII, may be empty) above it, or below it if there is no room above.
void drawOutline(cv::Mat& bgr, const std::vector<cv::Point>& outline, const std::string& label,
                 const cv::Scalar& color = cv::Scalar(0, 255, 0));

/// Writes one line of text (ASCII), whose baseline begins at `position`.
void drawText(cv::Mat& bgr, const std::string& text, const cv::Point& position,
              const cv::Scalar& color = cv::Scalar(0, 255, 0));

/// Draws a filled circle around `center` with a radius in px.
void drawDot(cv::Mat& bgr, const cv::Point2d& center, double radius, const cv::Scalar& color = cv::Scalar(0, 255, 0));

/// Draws a ball as a circle with a dot in its centre; the circle is thin and dashed if the ball is only predicted.
void drawBall(cv::Mat& bgr, const cv::Point2d& center, double radius, bool predicted = false);

/// Draws the path of a ball through its last centres, the newest last; the line grows wider towards that one. A centre
/// that is not finite interrupts the path.
void drawTrail(cv::Mat& bgr, const std::vector<cv::Point2d>& centers);

}  // namespace robot_vision
