#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "observed_frame.hpp"
#include "pose_step.hpp"
#include "view_camera.hpp"
#include "view_points.hpp"

namespace robot_vision
{

/// How features of a view are compared with a frame.
struct FitLimits
{
  double tolerance = 0.0;      // m, of depths
  double growth = 0.0;         // m/m^2, what it grows by with the square of the distance
  float normal_cosine = 0.0F;  // of the largest angle between normals
  int reach = 0;               // px, farthest that an edge is looked for
  int most = 1000;             // features of one kind, the first
};

/// Of the shares of features, in the evidence for an object.
struct FitWeights
{
  float bias, depth_edges, image_edges, edges_beyond, hidden_edges, surfaces, surfaces_beyond, hidden_surfaces;
};

/// What has become of the features of a view.
struct FitCounts
{
  int all_edges = 0, depth_edges = 0, image_edges = 0, edges_beyond = 0, hidden_edges = 0;
  int all_surfaces = 0, surfaces = 0, surfaces_beyond = 0, hidden_surfaces = 0;

  /// The logarithm of how much more likely it is that the object is there than not.
  float evidence(const FitWeights& weights) const;
};

/// Compares the features of views, at exact poses, with a frame. For one thread.
class ViewFit
{
public:
  ViewFit(const ObservedFrame& frame, const ViewCamera& camera);

  FitCounts count(const ViewFeatures& features, const ViewPose& pose, const FitLimits& limits);

  /// Moves the pose so that surfaces are where the frame has them, and contours where it has edges, by one step of
  /// Gauss and Newton; false: too few are.
  bool improve(const ViewFeatures& features, const FitLimits& limits, ViewPose& pose);

private:
  struct Seen;

  int project(const ViewPoints& points, const ViewPose& pose, int most);
  Seen seenAt(int i, const FitLimits& limits) const;
  void countEdge(const Seen& seen, FitCounts& counts) const;
  bool hasEdge(const Seen& seen, std::uint32_t bit) const;
  void countSurface(const Seen& seen, float cosine, FitCounts& counts) const;
  void addSurface(const Seen& seen, const cv::Vec3d& anchor, float cosine, PoseStep& step) const;
  void addEdge(const Seen& seen, const cv::Vec3d& anchor, int reach, PoseStep& step) const;

  const ObservedFrame& frame_;
  const ViewCamera& camera_;
  FitCamera fit_camera_;
  std::vector<float> numbers_;
  std::vector<std::int32_t> pixels_;
  SeenPoints seen_{};
};

}  // namespace robot_vision
