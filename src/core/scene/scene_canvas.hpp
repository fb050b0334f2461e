#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/meshes/mesh_renderer.hpp"
#include "scene_painter.hpp"
#include "scene_textures.hpp"
#include "scene_view.hpp"

namespace robot_vision::scene
{

/// A mesh at its place.
struct PlacedMesh
{
  const MeshRenderer* renderer;
  cv::Affine3d pose;
};

/// What a scene is drawn on, from the back to the front. So one list of things gives the colors and the depth. All
/// poses and points are in the optical frame of the camera that sees them, m.
class Canvas
{
public:
  virtual ~Canvas() = default;

  /// Fills the image with a color that is nowhere.
  virtual void background(const cv::Scalar& bgr) = 0;

  /// Fills the image with the plane z = 0 of a pose, as far as it goes, and above its horizon with what is nowhere.
  virtual void ground(const cv::Scalar& bgr, const cv::Scalar& sky, const cv::Affine3d& pose) = 0;

  /// A textured rectangle of `size` (m), if the camera sees its front.
  virtual void board(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size) = 0;

  /// The same for a shadow, which lies on what is drawn already.
  virtual void shadow(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size) = 0;

  /// The line on the floor, which is drawn already.
  virtual void line(const cv::Affine3d& world) = 0;

  /// The ball, lit by a lamp in the direction `to_light`.
  virtual void ball(const cv::Point3d& center, double radius, const cv::Vec3d& to_light) = 0;

  /// Meshes that hide parts of each other, lit likewise.
  virtual void meshes(const std::vector<PlacedMesh>& meshes, const cv::Vec3d& to_light) = 0;
};

/// Draws the colors into an image of the camera's size, CV_8UC3 BGR.
class ColorCanvas final : public Canvas
{
public:
  /// Keeps references to both. `draw` draws textures.
  ColorCanvas(const Lens& lens, cv::Mat& bgr, DrawTexture draw = kernels<TextureKernels>().draw)
    : lens_(lens), bgr_(bgr), draw_(draw)
  {
  }

  void background(const cv::Scalar& bgr) override { bgr_.setTo(bgr); }
  void ground(const cv::Scalar& bgr, const cv::Scalar& sky, const cv::Affine3d& pose) override
  {
    bgr_.setTo(bgr);
    paintSky(sky, pose, lens_, bgr_);
  }
  void board(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size) override
  {
    paintBoard(texture, pose, size, lens_, draw_, bgr_);
  }
  void shadow(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size) override
  {
    paintBoard(texture, pose, size, lens_, draw_, bgr_);
  }
  void line(const cv::Affine3d& world) override { paintLine(world, lens_, bgr_); }
  void ball(const cv::Point3d& center, double radius, const cv::Vec3d& to_light) override
  {
    paintBall(center, radius, to_light, lens_, bgr_);
  }
  void meshes(const std::vector<PlacedMesh>& meshes, const cv::Vec3d& to_light) override;

private:
  const Lens& lens_;
  cv::Mat& bgr_;
  DrawTexture draw_;
};

/// Draws the depth into an image of the camera's size, CV_32FC1: of what the ray through the middle of each pixel meets
/// first, in whatever order things are drawn.
class DepthCanvas final : public Canvas
{
public:
  /// Keeps references to both.
  DepthCanvas(const Lens& lens, cv::Mat& depth) : lens_(lens), depth_(depth) {}

  void background(const cv::Scalar& bgr) override;
  void ground(const cv::Scalar& bgr, const cv::Scalar& sky, const cv::Affine3d& pose) override;
  void board(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size) override;
  void shadow(const Texture& /*texture*/, const cv::Affine3d& /*pose*/, const cv::Size2d& /*size*/) override {}
  void line(const cv::Affine3d& /*world*/) override {}
  void ball(const cv::Point3d& center, double radius, const cv::Vec3d& to_light) override;
  void meshes(const std::vector<PlacedMesh>& meshes, const cv::Vec3d& to_light) override;

  /// Until then the image has 1/z, which is linear in the ray for a plane, and 0 where nothing is. Then it has z (m),
  /// and NaN.
  void finish();

private:
  void plane(const cv::Affine3d& pose, const cv::Size2d& size, const RowSpans& rows);

  const Lens& lens_;
  cv::Mat& depth_;
};

}  // namespace robot_vision::scene
