#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct EpipolarParams
{
  std::string epipolar = "rectified";
  int epipolar_lines = 24;
  int epipolar_features = 500;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("epipolar", &EpipolarParams::epipolar, OneOf{"rectified or fundamental"}, "",
          "what ~epipolar shows: rows of the rectified images, or lines in the images as they come, by the fundamental "
          "matrix of what looks alike in both");
    visit("epipolar_lines", &EpipolarParams::epipolar_lines, Range{0, 200}, "", "most lines that it shows");
    visit("epipolar_features", &EpipolarParams::epipolar_features, Range{20, 5000}, "",
          "most keypoints of each image that are compared");
  }
};

/// Points of the left image, and those of the right one that look most like them, the most alike first.
struct PairMatches
{
  std::vector<cv::Point2f> left;   // px
  std::vector<cv::Point2f> right;  // px
};

/// Matches keypoints of ORB in both images, at most `features` of each, by Lowe's ratio and in both directions. Throws
/// std::invalid_argument if an image is not of `encoding` (see encoding.hpp).
PairMatches matchPair(const cv::Mat& left, const cv::Mat& right, const std::string& encoding, int features);

/// The fundamental matrix F of a pair: right^T F left = 0 for homogeneous px of the same thing. F * left is the line of
/// the right image on which it is, F^T * right that of the left image.
struct FundamentalMatrix
{
  cv::Matx33d F;
  std::vector<uchar> inliers;  // 1 for matches that agree with it within 1.5 px
};

/// That of rectified images: the line of a point is its row.
cv::Matx33d rectifiedFundamental();

/// Finds it by cv::findFundamentalMat with RANSAC; none if fewer than 15 matches agree.
std::optional<FundamentalMatrix> findFundamental(const PairMatches& matches);

/// The distance of each right point from the line of its left point, px; NaN where F or a point is.
std::vector<double> epipolarDistances(const PairMatches& matches, const cv::Matx33d& F);

// These draw both images beside each other (CV_8UC3, BGR, the left one left) into `out`, which is reused if it fits and
// must not share pixels with them. Throw std::invalid_argument if an image is not CV_8UC3, and as validate() does.

/// Rectified images of one size, with lines along rows: what both see is on the same one. Matches are green where their
/// rows differ by at most 1.5 px, else red; the median difference is written below.
void drawRectifiedPair(const cv::Mat& left, const cv::Mat& right, const EpipolarParams& params, cv::Mat& out);

/// Images as they come, with the epipolar lines of matches that agree with the fundamental matrix, each match in a
/// color of its own. Below stands how many agree, and their median distance from the lines.
void drawEpipolarLines(const cv::Mat& left, const cv::Mat& right, const EpipolarParams& params, cv::Mat& out);

}  // namespace robot_vision
