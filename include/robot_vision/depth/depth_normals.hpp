#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

struct NormalParams
{
  int radius = 5;
  double max_jump = 0.05;
  int threads = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("radius", &NormalParams::radius, Range{1, 50}, "px",
          "of the square that a plane is fitted to; less beside what is no part of the surface");
    visit("max_jump", &NormalParams::max_jump, Range{0.001, 1}, "",
          "largest difference of depth between neighbours on one surface, as share of the depth");
    visit("threads", &NormalParams::threads, Range{1, 64}, "",
          "number of threads that share an image, as far as OpenCV's setting allows");
  }
};

/// Finds the normals of the surfaces that the pixels of a depth image show.
///
/// Around each pixel a plane is fitted to the inverse depths of the largest square that has no jump, no pixel without a
/// depth and no border of the image in it. Where not even the eight neighbours are of one surface there is no normal.
/// The sums of all squares come from integral images. Memory is kept from frame to frame. For one thread at a time.
class DepthNormals
{
public:
  /// Throws std::invalid_argument as validate() of the camera and of the parameters does.
  explicit DepthNormals(const CameraModel& camera, const NormalParams& params = NormalParams());
  ~DepthNormals();

  /// Writes CV_32FC3, unit vectors in the camera's optical frame that point to its side of the surface, NaN where there
  /// is none, into `normals`, which is reused if it fits. Throws std::invalid_argument if `depth` is not of `encoding`
  /// (see depth_image.hpp), or not of the camera's size.
  void apply(const cv::Mat& depth, const std::string& encoding, cv::Mat& normals);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
