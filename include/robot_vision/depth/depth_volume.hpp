#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// A box around an object that is divided into cubes, voxels, to which its surface is found by depth images.
struct VolumeParams
{
  cv::Vec3d low, high;   // m, corners of the box in the object's frame
  double voxel = 0.003;  // m, side of a cube
  double floor = 0.0;    // m, z below which depths are those of what the object stands on; it goes down to low
};

/// Throws std::invalid_argument for a box without an inside, and for more than 16 million voxels.
void validate(const VolumeParams& params);

/// Makes a mesh of depth images of an object from known poses. Each voxel has the mean of its signed distances from the
/// surface along the lines of sight (Curless, Levoy: A Volumetric Method for Building Complex Models from Range Images,
/// 1996). What no depth tells is the object's if it is within the object's outline in all images. For one thread at a
/// time.
class DepthVolume
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit DepthVolume(const VolumeParams& params);

  /// Adds what a camera sees. `bgr` is CV_8UC3, `depth` CV_32FC1 (m, NaN: none), `mask` CV_8UC1, not 0 where the object
  /// is, all of the camera's size; `pose` is that of the object in the camera's optical frame. Throws
  /// std::invalid_argument naming what is wrong.
  void add(const cv::Mat& bgr, const cv::Mat& depth, const cv::Mat& mask, const CameraModel& camera,
           const cv::Affine3d& pose);

  /// The surface, closed, with the colors and normals of its vertices; pieces that are much smaller than the largest
  /// are left out. Throws std::invalid_argument if there is none.
  Mesh mesh() const;

private:
  struct Voxel
  {
    float distance = 0.0F;      // sum of the distances, 1: outside, -1: inside by as much as is told
    std::uint16_t weight = 0;   // their number
    std::uint16_t outside = 0;  // of images in which it is not in the outline
    cv::Vec3f color;            // sum
    std::uint16_t colors = 0;   // their number
  };

  cv::Vec3d middleOf(const cv::Vec3i& at) const;
  std::size_t indexOf(const cv::Vec3i& at) const;
  double valueOf(const Voxel& voxel) const;
  std::vector<float> values() const;
  std::vector<cv::Vec3b> colorsAt(const std::vector<cv::Vec3f>& places) const;

  VolumeParams params_;
  cv::Vec3i size_;  // voxels
  std::vector<Voxel> voxels_;
};

}  // namespace robot_vision
