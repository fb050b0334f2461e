#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/recognition/view_model.hpp"

namespace robot_vision
{

/// The camera that views are drawn with: the object's middle is on its axis.
struct StudioCamera
{
  static constexpr int kSide = 160;  // px, of its images

  /// The object is at the distance of the parameters, or two and a half times its radius.
  StudioCamera(const ViewParams& params, double radius);

  cv::Matx33d K() const { return {focal_length, 0, middle, 0, focal_length, middle, 0, 0, 1}; }
  cv::Vec3d ray(const cv::Point& pixel) const
  {
    return {(pixel.x - middle) / focal_length, (pixel.y - middle) / focal_length, 1.0};
  }

  static constexpr double middle = 0.5 * (kSide - 1);  // px
  double distance;                                     // m
  double focal_length;                                 // px
};

/// Finds the features in images of views. Memory is kept from view to view.
class ViewFeatureFinder
{
public:
  ViewFeatureFinder(const ViewParams& params, double radius) : params_(params), radius_(radius), camera_(params, radius)
  {
  }

  const StudioCamera& camera() const { return camera_; }

  /// Makes a view of what is drawn of an object (depth, bgr and normals) that is turned by `rotation`. A view that
  /// shows nothing has no features.
  View find(const MeshView& drawn, const cv::Matx33d& rotation);

private:
  struct Candidate
  {
    cv::Point pixel;
    int strength;
    float direction;  // rad, across an edge
  };

  void findRegions();
  bool findAnchor();
  void findContours(const cv::Mat& far);
  void findInner();
  void findSurfaces();
  void choose(int count, FeatureKind kind, View& view);
  ViewFeature feature(const Candidate& candidate, FeatureKind kind) const;

  ViewParams params_;
  double radius_;
  StudioCamera camera_;
  cv::Mat depth_, bgr_, normals_;              // of the view
  cv::Mat seen_, edges_, smooth_, clearance_;  // where the object is, where it ends, where its normal changes slowly,
                                               // and how far that is from where it does not, px
  cv::Mat taken_;
  cv::Vec3d anchor_;       // m, in the camera's optical frame
  cv::Matx33d to_anchor_;  // turns that frame so that z goes to the anchor
  std::vector<Candidate> candidates_;
};

}  // namespace robot_vision
