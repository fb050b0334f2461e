#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// The camera that a MeshRenderer draws for. Copies share their tables; threads may use one camera.
class MeshCamera
{
public:
  /// A camera without distortion. Converts by itself, so that a matrix can be given for a camera. Throws
  /// std::invalid_argument if K is not that of a camera.
  MeshCamera(const cv::Matx33d& K);  // NOLINT(google-explicit-constructor)

  /// A camera with its lens. Tables are made for one with distortion, which takes some 0.1 us for each pixel: keep it.
  /// Throws std::invalid_argument as validate(CameraModel) does, and for a camera that is not calibrated.
  explicit MeshCamera(const CameraModel& camera);

  const cv::Matx33d& K() const { return K_; }

  /// The rays of the pixels of a lens with distortion, and where they are; nullptr: it has none.
  struct Lens;
  const Lens* lens() const { return lens_.get(); }

private:
  cv::Matx33d K_;
  std::shared_ptr<const Lens> lens_;
};

/// Which images a MeshRenderer draws besides the depth, and in which light.
struct RenderParts
{
  bool bgr = false;
  bool normals = false;
  bool ids = false;
  cv::Vec3d to_light{0.0, 0.0,
                     0.0};  // direction to a far lamp in the camera's optical frame; zeros: it is at the camera
};

/// Images of what a pinhole camera sees of meshes, each as large as the region that was drawn. Those that were not
/// asked for are empty. Memory is used again by the next drawing into the same view.
struct MeshView
{
  cv::Mat depth;    // CV_32FC1, z (m) of what the ray through the middle of a pixel meets first, NaN where nothing is
  cv::Mat bgr;      // CV_8UC3, lit by a lamp and from all around; 0 where nothing is
  cv::Mat normals;  // CV_32FC3, of length 1, in the camera's optical frame, towards the camera; NaN where nothing is
  cv::Mat ids;      // CV_16UC1, 0 where nothing is, else 1 + the index that the mesh was drawn with

  struct Scratch;
  std::shared_ptr<Scratch> scratch;  // memory of the renderer; a copy of a view must be given one of its own (nullptr)
};

/// Draws a mesh in one thread, without a graphics library: the surface that the ray through the middle of each pixel
/// meets first. What is nearer than kNearest is not drawn, and of closed surfaces the inside is not.
class MeshRenderer
{
public:
  static constexpr double kNearest = 0.001;  // m, z in the camera's optical frame

  /// Keeps a copy of what it needs. Throws std::invalid_argument as validate(Mesh) does.
  explicit MeshRenderer(const Mesh& mesh);
  ~MeshRenderer();
  MeshRenderer(MeshRenderer&&) noexcept;
  MeshRenderer& operator=(MeshRenderer&&) noexcept;

  const MeshExtent& extent() const;

  /// Draws the mesh alone: `region` of what the camera sees, which may go beyond the image of one without distortion.
  /// `pose` is that of the mesh's frame in the camera's optical frame. Threads may draw at the same time, each into a
  /// view of its own. Throws std::invalid_argument if the pose is not finite, or the region is empty, larger than 16384
  /// px, or beyond the image of a camera with distortion.
  void render(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Rect& region, MeshView& view,
              const RenderParts& parts = RenderParts()) const;

  /// Draws it into what the view has, of other meshes or of what else has a depth: what is nearest is seen. `index` (0
  /// to 65534) is for the ids. Throws std::invalid_argument as render() does, and if an image of the view is not of the
  /// region's size.
  void merge(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Rect& region, MeshView& view,
             const RenderParts& parts, int index) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
