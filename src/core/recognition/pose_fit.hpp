#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <optional>
#include <vector>

#include "contour_points.hpp"
#include "contour_search.hpp"
#include "pinhole.hpp"
#include "pose_equations.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

/// A point of an object's surface that is seen.
struct SurfacePoint
{
  cv::Vec3d point;   // m, from the center of the mesh, along the camera's axes
  cv::Vec3d normal;  // of length 1
};

/// Some of the points that a region shows, evenly.
void takeSurfacePoints(const RenderedRegion& region, int max_count, std::vector<SurfacePoint>& points);

/// How far a pose may be from where it is expected, beyond the noise.
struct FitTolerance
{
  double shift = 0.0;   // m, standard deviation
  double pixels = 0.0;  // px, standard deviation
  int radius = 4;       // px, that contours are looked for in
};

/// Where a frame has a point of a contour, as far as it does.
struct ContourMatch
{
  cv::Point2d place;                         // px, where the point was when it was looked for
  bool is_hidden = true;                     // something is before it
  std::optional<double> by_color, by_depth;  // px, from that place along the normal
};

/// The residuals of an object's surface and contours in a frame.
///
/// A point of the surface is compared with the plane at the depth of the pixel that it is seen at: its residual is the
/// distance along its normal. A point of a contour is compared with the nearest change of the image's colors, and of
/// the outline with the nearest jump of its depths: the residuals are distances along the normal of the contour. These
/// are looked for in match(), and stay the same until it is called again.
class PoseResiduals
{
public:
  PoseResiduals(const RecognitionFrame& frame, const DepthErrorParams& errors, double contour_error,
                double min_gradient);

  /// How much each point counts, by how many pixels of the image there are for it: what is nearer to others than the
  /// noise is independent counts less.
  void setDensity(double surface_pixels, double contour_pixels);

  /// Looks for the contours of an object that was `turned` since its points were taken, and whose center is here (m).
  void match(const std::vector<ContourPoint>& contours, const cv::Matx33d& turned, const cv::Vec3d& center,
             const FitTolerance& tolerance);

  /// Adds all residuals of an object in such a pose. The contours are those that were matched, or none.
  void add(const std::vector<SurfacePoint>& surface, const std::vector<ContourPoint>& contours,
           const cv::Matx33d& turned, const cv::Vec3d& center, const FitTolerance& tolerance,
           PoseEquations& equations) const;

  /// What depths of all points of a surface would tell of a pose: which motions leave it as it is.
  cv::Matx66d surfaceInformation(const std::vector<SurfacePoint>& surface, const cv::Vec3d& center) const;

  /// By how much (m) what is measured at the pixel of a point is behind it; NaN where nothing is.
  double distanceBehind(const cv::Vec3d& point) const;

  /// The standard deviation (m) along a surface's normal of a depth (m): of the noise, and of half a pixel.
  double surfaceDeviation(double depth, const cv::Vec3d& ray, const cv::Vec3d& normal) const;

private:
  bool addSurface(const SurfacePoint& sample, const cv::Matx33d& turned, const cv::Vec3d& center, double shift,
                  PoseEquations& equations) const;
  ContourMatch matchOf(const ContourPoint& contour, const cv::Vec3d& point, const FitTolerance& tolerance) const;
  void addContour(const ContourPoint& contour, const ContourMatch& match, const cv::Matx33d& turned,
                  const cv::Vec3d& center, double tolerance, PoseEquations& equations) const;

  const RecognitionFrame& frame_;
  DepthErrorParams errors_;
  double contour_error_;  // px
  Pinhole camera_;
  double pixel_width_;  // m, at a depth of 1 m
  ContourSearch search_;
  double surface_share_ = 1.0, contour_share_ = 1.0;
  std::vector<ContourMatch> matches_;
};

}  // namespace robot_vision
