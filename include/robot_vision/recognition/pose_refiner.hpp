#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

struct RefinerParams
{
  int levels = 3;
  int rounds = 2;
  double search = 0.1;
  int points = 250;
  int contour_points = 200;
  double contour_error = 0.7;
  double min_gradient = 50.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("levels", &RefinerParams::levels, Range{1, 10}, "",
          "how often the object is drawn in the pose found so far, to find a better one nearby");
    visit("rounds", &RefinerParams::rounds, Range{1, 100}, "",
          "how often its contours are looked for in the image, for each drawing");
    visit("search", &RefinerParams::search, Range{0.001, 1}, "",
          "how far the object may be from the first pose, as share of its diameter");
    visit("points", &RefinerParams::points, Range{20, 100000}, "", "of its surface that are compared, at most");
    visit("contour_points", &RefinerParams::contour_points, Range{20, 100000}, "", "of its contours, at most");
    visit("contour_error", &RefinerParams::contour_error, Range{0.01, 100}, "px",
          "standard deviation of where a contour is in an image of colors");
    visit("min_gradient", &RefinerParams::min_gradient, Range{1, 1000}, "",
          "gradient of colors (Sobel, 3x3) from which something can be a contour");
  }
};

/// A pose that fits to a frame.
struct RefinedPose
{
  cv::Affine3d pose;                // of the object's frame, that of its mesh, in the camera's optical frame, m
  cv::Matx66d covariance;           // of x, y, z (m) and the rotations about x, y, z (rad) along the camera's axes
  std::vector<FreeAxis> free_axes;  // in the mesh's frame, about which it could be turned by any angle
  double score = 0.0;               // 0 to 1, how well the frame has what is expected there
  double first_score = 0.0;         // of the first pose
};

/// Finds the pose near a first one in which an object fits best to a frame.
///
/// By the method of Levenberg and Marquardt, with Tukey's weights, the distances of the depths from the object's
/// surface (each along its normal, by the noise of the sensor) and of the image's edges and the depths' jumps from the
/// object's contours (along their normals, in the image) become as small as they can be. Both kinds are used if the
/// frame has both images, as a plane can be shifted within itself, and a contour hardly tells a distance; without
/// depths, contours alone give the pose. A pose is never worse than the first one by its score.
///
/// Memory is kept from call to call. For one thread at a time.
class PoseRefiner
{
public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PoseRefiner(const RefinerParams& params = RefinerParams(),
                       const DepthErrorParams& errors = DepthErrorParams());
  ~PoseRefiner();
  PoseRefiner(PoseRefiner&&) noexcept;
  PoseRefiner& operator=(PoseRefiner&&) noexcept;

  /// Where nothing of the object would be seen, or the frame has nothing to compare with, it is the first pose, with a
  /// score of 0 and a covariance that says that nothing is known. Throws std::invalid_argument if the pose is not
  /// finite or not that of a rigid body, and if nothing was set in the frame.
  RefinedPose refine(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& first);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
