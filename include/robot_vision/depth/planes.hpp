#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

struct PlaneParams
{
  double noise = 0.0015;
  double min_noise = 0.001;
  double min_area = 0.01;
  int max_planes = 8;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("noise", &PlaneParams::noise, Range{0, 1}, "m",
          "standard deviation of depth at 1 m; it grows with the square of the depth");
    visit("min_noise", &PlaneParams::min_noise, Range{0.00001, 1}, "m", "what is added to it at any depth");
    visit("min_area", &PlaneParams::min_area, Range{0.0001, 1}, "", "smallest plane, as share of the image");
    visit("max_planes", &PlaneParams::max_planes, Range{1, 100}, "", "number of planes, the largest");
  }
};

/// A part of a plane that a depth image shows, in the camera's optical frame.
struct Plane
{
  cv::Vec3d normal;               // unit vector, to the camera's side
  double distance = 0.0;          // m, of the camera from it: normal * point + distance is 0 for its points
  cv::Point3d center;             // m, where the mean of its pixels' rays meets it
  int pixels = 0;                 // that it has
  double deviation = 0.0;         // root mean square of its pixels' errors, in standard deviations of the noise
  std::vector<cv::Point3d> hull;  // m, the corners of its convex hull, counter-clockwise for the camera
};

struct PlaneSegmentation
{
  std::vector<Plane> planes;  // the one with most pixels first
  cv::Mat labels;             // CV_8UC1: 1 for pixels of the first plane, 2 of the second, ...; 0 of none
};

/// Finds the planes in the depth images of one camera.
///
/// Blocks of pixels whose errors are those of the noise grow to regions as long as that is so of their common plane;
/// regions of one plane are one, also if something stands between them. Each pixel in and beside them belongs to the
/// plane that it is nearest to, if that is within 2.5 standard deviations. Planes are fitted by the least squares of
/// inverse depths: that gives each pixel the weight that its noise allows. Memory is kept from frame to frame. For one
/// thread at a time.
class PlaneFinder
{
public:
  /// Throws std::invalid_argument as validate() of the camera and of the parameters does.
  explicit PlaneFinder(const CameraModel& camera, const PlaneParams& params = PlaneParams());
  ~PlaneFinder();

  /// Throws std::invalid_argument if `depth` is not of `encoding` (see depth_image.hpp), or not of the camera's size.
  /// The labels are the finder's own: valid until its next call.
  const PlaneSegmentation& find(const cv::Mat& depth, const std::string& encoding);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
