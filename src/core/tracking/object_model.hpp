#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/features/flow_image.hpp"
#include "core/features/similarity.hpp"

namespace robot_vision
{

/// The fit of a model to an image.
struct ModelFit
{
  Similarity pose;                     // from the model's pixels to the image's
  std::vector<std::size_t> seen;       // indices of the model's points that look as they should
  std::vector<cv::Point2f> positions;  // px in the image, of these points
};

/// The first appearance of an object: its pixels, at most 96 along the longer side, and their feature points.
class ObjectModel
{
public:
  /// Makes the model of a region of a gray image (CV_8UC1), with at most `points` feature points. Throws
  /// std::invalid_argument naming what is wrong with the region.
  ObjectModel(const cv::Mat& gray, const cv::Rect& region, int points);

  /// The pose in the image that it was made from.
  const Similarity& firstPose() const { return first_pose_; }
  const std::vector<cv::Point2f>& points() const { return points_; }
  const std::vector<cv::Point2f>& corners() const { return corners_; }  // clockwise from the top left
  cv::Point2d center() const { return center_; }

  /// Corrects a pose by the points that are seen in the image. A point counts as seen if the pixels around it have at
  /// least the correlation `min_similarity` with those in the model.
  ModelFit fit(FlowImage& image, const FlowParams& params, const Similarity& pose, double min_similarity) const;

private:
  /// The part of the image in which the object should be, in the model's pixels.
  cv::Mat warped(FlowImage& image, const FlowParams& params, const Similarity& pose) const;
  /// Finds the points in such a part. Writes the positions of all points, and returns the indices of those that are
  /// seen.
  std::vector<std::size_t> findIn(const cv::Mat& patch, double min_similarity, std::vector<cv::Point2f>& found) const;

  Similarity first_pose_;
  cv::Mat pixels_;                // CV_8UC1, smoothed
  std::vector<cv::Mat> pyramid_;  // of the pixels
  std::vector<cv::Mat> windows_;  // CV_32FC1, the pixels around each point with mean 0 and norm 1
  std::vector<cv::Point2f> points_, corners_;
  cv::Point2d center_;
};

}  // namespace robot_vision
