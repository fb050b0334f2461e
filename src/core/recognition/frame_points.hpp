#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <unordered_set>

#include "oriented_points.hpp"
#include "robot_vision/depth/depth_normals.hpp"
#include "robot_vision/depth/planes.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

/// The points of a frame's surfaces, their normals, and the planes that they are part of.
class FramePoints
{
public:
  /// Looks at the depths of a frame; planes only if they are asked for.
  void begin(const RecognitionFrame& frame, bool with_planes);

  /// Writes points about a distance (m) apart, those left out that are part of planes whose extent is larger than this
  /// (m); at most so many, evenly.
  void sample(const RecognitionFrame& frame, double distance, double max_plane, int max_points, OrientedPoints& points);

private:
  std::vector<char> largePlanes(double max_plane) const;

  std::unique_ptr<DepthNormals> normal_finder_;
  std::unique_ptr<PlaneFinder> plane_finder_;
  CameraModel camera_;  // of the finders
  cv::Mat normals_;
  const PlaneSegmentation* planes_ = nullptr;
  std::unordered_set<std::uint64_t> cells_;
};

}  // namespace robot_vision
