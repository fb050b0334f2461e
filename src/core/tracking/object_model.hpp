#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/features/flow_image.hpp"
#include "core/features/similarity.hpp"

namespace robot_vision
{

/// How well a model fits a picture.
struct ModelFit
{
  Similarity pose;                 // from the model's pixels to the picture's
  std::vector<std::size_t> seen;   // the model's points that look as they should
  std::vector<cv::Point2f> where;  // px of the picture, of these
};

/// The first appearance of an object: its pixels, 96 to the longer side if it has more, and their feature points.
class ObjectModel
{
public:
  /// Of a region of a gray picture (CV_8UC1), with at most so many points. Throws std::invalid_argument saying what is
  /// wrong with the region.
  ObjectModel(const cv::Mat& gray, const cv::Rect& region, int points);

  /// Where it was in the picture that it was made from.
  const Similarity& firstPose() const { return first_pose_; }
  const std::vector<cv::Point2f>& points() const { return points_; }
  const std::vector<cv::Point2f>& corners() const { return corners_; }  // clockwise from the top left
  cv::Point2d center() const { return center_; }

  /// Corrects a pose by the points seen in the picture.
  /// `min_similarity`: correlation of a point's surroundings with the model's from which it counts as seen.
  ModelFit fit(FlowImage& picture, const FlowParams& params, const Similarity& pose, double min_similarity) const;

private:
  /// What the picture shows where the object would be, in the model's pixels.
  cv::Mat warped(FlowImage& picture, const FlowParams& params, const Similarity& pose) const;
  /// Where each point is in such a patch, and which of them look as they should there.
  std::vector<std::size_t> findIn(const cv::Mat& patch, double min_similarity, std::vector<cv::Point2f>& found) const;

  Similarity first_pose_;
  cv::Mat pixels_;                // CV_8UC1, smoothed
  std::vector<cv::Mat> pyramid_;  // of them
  std::vector<cv::Mat> windows_;  // CV_32FC1, around each point: mean 0, norm 1
  std::vector<cv::Point2f> points_, corners_;
  cv::Point2d center_;
};

}  // namespace robot_vision
