#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "plane_regions.hpp"
#include "plane_sums.hpp"
#include "robot_vision/depth/planes.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// What a PlaneFinder does, with what else it knows of the last image.
class PlaneSearch
{
public:
  PlaneSearch(const CameraModel& camera, const PlaneParams& params);

  /// See PlaneFinder.
  const PlaneSegmentation& find(const cv::Mat& depth, const std::string& encoding);

  const PlaneSegmentation& found() const { return found_; }
  const RayTable& rays() const { return rays_; }
  const cv::Mat& inverse() const { return inverse_; }  // see invertDepth()

  /// The standard deviation of a depth, m.
  double deviation(double depth) const { return params_.noise * depth * depth + params_.min_noise; }

private:
  /// A plane, and the parts of the image that may have pixels of it.
  struct Candidate
  {
    std::vector<cv::Rect> parts;
    InversePlane plane;
    PlaneSums sums;
  };

  void findCandidates(double min_pixels);
  void add(const PlaneRegion& region);
  bool isSamePlane(const PlaneSums& a, const PlaneSums& b) const;
  void label();
  void labelPart(const cv::Rect& part, const InversePlane& plane, std::uint8_t number);
  void measure(double min_pixels);

  CameraModel camera_;
  PlaneParams params_;
  InverseNoise noise_;
  RayTable rays_;
  PlaneBlocks blocks_;
  cv::Mat inverse_;
  std::vector<Candidate> candidates_;
  cv::Mat errors_;                 // CV_32FC1, of each pixel with regard to its plane, in standard deviations
  std::vector<float> row_errors_;  // likewise, of a part of a row
  PlaneSegmentation found_;
};

}  // namespace robot_vision
