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

/// Draws a sheet of paper (CV_8UC1, one pixel per cell). Each pixel is the mean of 4x4 points. `border` is the number
/// of cells from the paper's edge to the corners.
inline void drawPaper(cv::Mat& gray, const cv::Mat& paper, int border, const TagCorners& corners)
{
  const auto near = static_cast<float>(border);
  const auto far = static_cast<float>(paper.cols - border);
  const std::vector<cv::Point2f> cells = {{near, far}, {far, far}, {far, near}, {near, near}};
  const std::vector<cv::Point2f> pixels(corners.begin(), corners.end());
  const cv::Matx33d to_cells = cv::Mat(cv::getPerspectiveTransform(pixels, cells));
  const auto end = static_cast<float>(paper.cols);
  std::vector<cv::Point2f> outline;
  cv::perspectiveTransform(std::vector<cv::Point2f>{{0, 0}, {end, 0}, {end, end}, {0, end}}, outline,
                           cv::Mat(to_cells.inv()));
  const cv::Rect box = (cv::boundingRect(outline) + cv::Size(1, 1)) & cv::Rect({0, 0}, gray.size());
  for (int y = box.y; y < box.br().y; ++y)
    for (int x = box.x; x < box.br().x; ++x)
    {
      double sum = 0.0;
      for (int i = 0; i < 16; ++i)
      {
        const cv::Vec3d cell = to_cells * cv::Vec3d(x + (i % 4 - 1.5) / 4.0, y + (i / 4 - 1.5) / 4.0, 1.0);
        const int column = cvFloor(cell[0] / cell[2]);
        const int row = cvFloor(cell[1] / cell[2]);
        const bool inside = column >= 0 && row >= 0 && column < paper.cols && row < paper.rows;
        sum += inside ? (paper.at<uchar>(row, column) == 255 ? 235.0 : 20.0) : gray.at<uchar>(y, x);
      }
      gray.at<uchar>(y, x) = cv::saturate_cast<uchar>(sum / 16.0);
    }
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
