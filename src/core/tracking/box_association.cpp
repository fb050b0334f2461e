#include "box_association.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot_vision/tracking/assignment.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMuch = 0.5;      // overlap that needs no explanation: what is before a thing may cut off its box
constexpr double kMaxRatio = 1.5;  // of the sides of boxes that are alike
constexpr double kTie = 1e-9;      // gain of a pair that overlaps by just the least: it is still better than none

double distance(const cv::Rect2d& a, const cv::Rect2d& b)
{
  return std::hypot(a.x - b.x + 0.5 * (a.width - b.width), a.y - b.y + 0.5 * (a.height - b.height));
}

bool isAlike(double a, double b)
{
  return std::max(a, b) <= kMaxRatio * std::min(a, b);
}

double gainOf(const BoxCandidate& track, const BoxCandidate& detection, const PairRules& rules)
{
  if (!rules.mix_classes && track.class_id != detection.class_id) return 0.0;
  const double iou = overlap(track.box, detection.box);
  const double gain = iou - rules.min_iou + kTie;
  if (iou >= std::max(kMuch, rules.min_iou)) return gain;
  const bool is_alike =
      isAlike(track.box.width, detection.box.width) && isAlike(track.box.height, detection.box.height);
  if (!is_alike) return 0.0;
  const double apart = distance(track.box, detection.box);
  const bool is_explained = apart <= rules.gate * std::sqrt(track.variance + detection.variance);
  if (iou >= rules.min_iou && is_explained) return gain;
  return apart < track.reach ? kTie * (1.0 - apart / track.reach) : 0.0;
}

cv::Mat_<double> gainsOf(const std::vector<BoxCandidate>& tracks, const std::vector<BoxCandidate>& detections,
                         const PairRules& rules)
{
  cv::Mat_<double> gains(static_cast<int>(tracks.size()), static_cast<int>(detections.size()));
  for (int row = 0; row < gains.rows; ++row)
  {
    double* gain = gains[row];
    for (const BoxCandidate& detection : detections)
      *gain++ = gainOf(tracks[static_cast<std::size_t>(row)], detection, rules);
  }
  return gains;
}

void keep(std::vector<BoxCandidate>& candidates, const std::vector<char>& taken)
{
  std::vector<BoxCandidate> left;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!taken[i]) left.push_back(candidates[i]);
  candidates = std::move(left);
}

}  // namespace

double overlap(const cv::Rect2d& a, const cv::Rect2d& b)
{
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  if (width <= 0.0 || height <= 0.0) return 0.0;
  const double both = width * height;
  return both / (a.width * a.height + b.width * b.height - both);
}

std::vector<std::pair<std::size_t, std::size_t>> takePairs(std::vector<BoxCandidate>& tracks,
                                                           std::vector<BoxCandidate>& detections,
                                                           const PairRules& rules)
{
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (tracks.empty() || detections.empty()) return pairs;
  const std::vector<int> columns = bestAssignment(gainsOf(tracks, detections, rules));
  std::vector<char> track_taken(tracks.size(), false), detection_taken(detections.size(), false);
  for (std::size_t row = 0; row < tracks.size(); ++row)
  {
    if (columns[row] < 0) continue;
    const auto column = static_cast<std::size_t>(columns[row]);
    pairs.emplace_back(tracks[row].index, detections[column].index);
    track_taken[row] = detection_taken[column] = true;
  }
  keep(tracks, track_taken);
  keep(detections, detection_taken);
  return pairs;
}

}  // namespace robot_vision
