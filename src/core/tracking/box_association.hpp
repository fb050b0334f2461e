#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

namespace robot_vision
{

/// A track or a detection that may be associated.
struct BoxCandidate
{
  std::size_t index;  // in a list of the caller's
  int class_id;
  cv::Rect2d box;
  double variance;     // of its centre's x and of its y, px^2
  double reach = 0.0;  // px, of a track: how far its centre may be from that of a detection that it does not overlap
};

/// What a pair must be like. One that overlaps by less than a half must have about the same width and height, too.
struct PairRules
{
  double min_iou;    // intersection over union, unless it is within reach
  double gate;       // standard deviations between the centres of what overlaps by less than a half
  bool mix_classes;  // or they have the same class
};

/// Intersection over union, 0 to 1; 0 if one of them has no area.
double overlap(const cv::Rect2d& a, const cv::Rect2d& b);

/// Associates tracks with detections by these rules, so that the sum of what their overlaps exceed `min_iou` by is the
/// largest there is, and then as many as possible of what is within reach, and as near as possible. Returns the indices
/// of each pair, and takes what is in one out of both lists.
std::vector<std::pair<std::size_t, std::size_t>> takePairs(std::vector<BoxCandidate>& tracks,
                                                           std::vector<BoxCandidate>& detections,
                                                           const PairRules& rules);

}  // namespace robot_vision
