#pragma once

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "robot_vision/tags/detection/tag_families.hpp"

/// The corners of a tag in an image, in the order of robot_vision::Tag.
using TagCorners = std::array<cv::Point2d, 4>;

/// The corners of a square of `side` px around `center`, turned by `angle` (rad) and then tilted by `tilt` (rad) about
/// an axis in the image plane at `axis` (rad), as seen from a distance of 6 sides.
inline TagCorners tagCorners(cv::Point2d center, double side, double angle = 0.0, double tilt = 0.0, double axis = 0.0)
{
  TagCorners corners;
  const std::array<cv::Point2d, 4> square = {{{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}}};
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const double direction = std::atan2(square[i].y, square[i].x) + angle - axis;
    const double radius = side * cv::norm(square[i]);
    const cv::Point2d along(std::cos(axis), std::sin(axis)), across(-along.y, along.x);
    const double x = radius * std::cos(direction);
    const double y = radius * std::sin(direction);
    const double distance = 1.0 + y * std::sin(tilt) / (6.0 * side);
    corners[i] = center + along * (x / distance) + across * (y * std::cos(tilt) / distance);
  }
  return corners;
}

/// The tag's cells with a white margin of `margin` cells.
inline cv::Mat paperOf(const std::string& family, int id, int margin = 1)
{
  cv::Mat paper;
  cv::copyMakeBorder(robot_vision::tagCells(family, id), paper, margin, margin, margin, margin, cv::BORDER_CONSTANT,
                     255);
  return paper;
}

/// Draws the levels of cells, one pixel each, into an image `scale` times as fine as the one whose pixels `to_cells`
/// takes to cells, and whose pixel at `origin` is at its corner. What is beside the cells stays. OpenCV does that: in a
/// loop of its own it takes most of a test's time where a sanitizer watches.
inline void drawCells(const cv::Mat& levels, const cv::Matx33d& to_cells, const cv::Point& origin, int scale,
                      cv::Mat& fine)
{
  const double step = 1.0 / scale;
  const cv::Matx33d to_pixels(step, 0.0, origin.x + 0.5 * step - 0.5, 0.0, step, origin.y + 0.5 * step - 0.5, 0.0, 0.0,
                              1.0);
  const cv::Matx33d to_middles(1.0, 0.0, -0.5, 0.0, 1.0, -0.5, 0.0, 0.0, 1.0);
  cv::warpPerspective(levels, fine, to_middles * to_cells * to_pixels, fine.size(),
                      cv::INTER_NEAREST | cv::WARP_INVERSE_MAP, cv::BORDER_TRANSPARENT);
}

/// What takes the pixels of an image to the cells of a sheet of paper. `border` is the number of cells from the paper's
/// edge to the corners.
inline cv::Matx33d pixelsToCells(const TagCorners& corners, const cv::Mat& paper, int border)
{
  const auto near = static_cast<float>(border);
  const auto far = static_cast<float>(paper.cols - border);
  const std::vector<cv::Point2f> cells = {{near, far}, {far, far}, {far, near}, {near, near}};
  return cv::Mat(cv::getPerspectiveTransform(std::vector<cv::Point2f>(corners.begin(), corners.end()), cells));
}

/// Draws a sheet of paper (CV_8UC1, one pixel per cell). Each pixel is the mean of 4x4 points.
inline void drawPaper(cv::Mat& gray, const cv::Mat& paper, int border, const TagCorners& corners)
{
  constexpr int kScale = 4;
  const cv::Matx33d to_cells = pixelsToCells(corners, paper, border);
  const auto end = static_cast<float>(paper.cols);
  std::vector<cv::Point2f> outline;
  cv::perspectiveTransform(std::vector<cv::Point2f>{{0, 0}, {end, 0}, {end, end}, {0, end}}, outline,
                           cv::Mat(to_cells.inv()));
  const cv::Rect box = (cv::boundingRect(outline) + cv::Size(1, 1)) & cv::Rect({0, 0}, gray.size());
  if (box.empty()) return;
  cv::Mat levels, fine, part = gray(box);
  cv::Mat(paper == 255).convertTo(levels, CV_32F, 215.0 / 255.0, 20.0);
  cv::resize(part, fine, box.size() * kScale, 0.0, 0.0, cv::INTER_NEAREST);
  fine.convertTo(fine, CV_32F);
  drawCells(levels, to_cells, box.tl(), kScale, fine);
  cv::Mat means;
  cv::resize(fine, means, box.size(), 0.0, 0.0, cv::INTER_AREA);
  means.convertTo(part, CV_8U);
}

/// Draws a tag on white paper.
inline void drawTag(cv::Mat& gray, const std::string& family, int id, const TagCorners& corners)
{
  const robot_vision::TagFamily& facts = robot_vision::tagFamily(family);
  drawPaper(gray, paperOf(family, id), (facts.width - facts.width_at_border) / 2 + 1, corners);
}

/// Adds pixel noise of a standard deviation in gray levels.
inline void addNoise(cv::Mat& gray, double deviation, cv::RNG& random)
{
  cv::Mat noise(gray.size(), CV_16SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  cv::add(gray, noise, gray, cv::noArray(), CV_8U);
}

inline cv::Mat grayWall(cv::Size size)
{
  return cv::Mat(size, CV_8UC1, cv::Scalar(128));
}

/// Makes the image that of a camera: a little out of focus, and noisy.
inline void photograph(cv::Mat& gray, cv::RNG& random)
{
  cv::GaussianBlur(gray, gray, {0, 0}, 0.7);
  addNoise(gray, 3.0, random);
}
