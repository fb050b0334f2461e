#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

struct RegionSample;

struct LocatorParams
{
  std::string shape = "surface";
  double min_share = 0.3;
  int min_pixels = 20;
  double box_error = 0.05;
  double pixel_error = 0.5;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("shape", &LocatorParams::shape, OneOf{"surface or sphere"}, "",
          "where a thing is: its surface that is seen, or the middle of a sphere");
    visit("min_share", &LocatorParams::min_share, Range{0, 1}, "",
          "of the depths in a region, that what is nearest must have to be the thing; the middle counts most");
    visit("min_pixels", &LocatorParams::min_pixels, Range{1, 1000000}, "px^2",
          "fewest that must show the thing with a depth");
    visit("box_error", &LocatorParams::box_error, Range{0, 1}, "",
          "standard deviation of the place of a box, as share of its sides");
    visit("pixel_error", &LocatorParams::pixel_error, Range{0.01, 1000}, "px",
          "what is added to it, whatever the size of the box is");
  }
};

/// Something found in an image. Positions are in px from the centre of the top left pixel.
struct ImageRegion
{
  cv::Rect box;                       // px, around it; may reach out of the image
  std::vector<cv::Point2d> outline;   // px, closed; with less than a pixel in it all of the box is looked at
  std::optional<cv::Point2d> center;  // px; none: the middle of the box
  double radius = 0.0;                // px, of a sphere; 0: a quarter of the box's width and height together
};

/// Where it is, in the camera's optical frame.
struct LocatedRegion
{
  cv::Point3d position;    // m
  cv::Matx33d covariance;  // m^2, of the position; symmetric and positive definite
  cv::Vec3d size;  // m, along the axes of the frame: of the box at that depth, and of the depths that its surface
                   // has without their outermost fifth and the noise; of a sphere its diameter
  int pixels = 0;  // px^2, that show it with a depth
};

/// Finds where things are that were found in the images of one camera, by the depths that belong to these images.
///
/// The depths of a region are counted in a histogram whose bins are 4 % of the depth wide. Between its valleys are
/// layers: the thing, what is behind it, and what hides a part of it. The thing is the nearest layer with a large share
/// of the depths, where the middle of the region counts most; without such a one it is the largest layer. Its depth is
/// the median. Holes do no harm, nor do flying pixels at edges.
///
/// A surface is where the ray through the centre has that depth. The middle of a sphere is where its pixels say that
/// it is, for a sphere that appears with the radius of the region.
///
/// Threads may share a RegionLocator, because it never changes.
class RegionLocator
{
public:
  /// Throws std::invalid_argument as validate() of the camera and of the parameters does.
  explicit RegionLocator(const CameraModel& camera, const LocatorParams& params = LocatorParams(),
                         const DepthErrorParams& errors = DepthErrorParams());

  const CameraModel& camera() const { return camera_; }

  /// Empty if too few pixels have a depth, of at most 1000 m. Throws std::invalid_argument if `depth` is not of
  /// `encoding` (see depth_image.hpp) or not of the camera's size, and if the region is not finite, not in the image or
  /// where the lens has no rays.
  std::optional<LocatedRegion> locate(const cv::Mat& depth, const std::string& encoding,
                                      const ImageRegion& region) const;

private:
  LocatedRegion asSurface(const std::vector<RegionSample>& samples, int pixels, const ImageRegion& region) const;
  std::optional<LocatedRegion> asSphere(const std::vector<RegionSample>& samples, int pixels,
                                        const ImageRegion& region) const;

  CameraModel camera_;
  LocatorParams params_;
  DepthErrorParams errors_;
};

}  // namespace robot_vision
