#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/recognition/texture_model.hpp"

namespace robot_vision
{

/// What a camera sees of an object.
struct TextureView
{
  cv::Mat image;  // CV_8UC3 (BGR) or CV_8UC1
  cv::Mat depth;  // CV_32FC1, m, of each of its pixels; NaN where there is none
  cv::Mat mask;   // CV_8UC1, not 0 where the object is; empty: wherever there is a depth
  CameraModel camera;
  cv::Affine3d pose;  // of the object's frame in the camera's optical frame, m
};

/// The views that a mesh is learned from: it is looked at from all sides.
class TextureViews
{
public:
  /// Throws std::invalid_argument as MeshRenderer and validate() of the parameters do.
  TextureViews(const Mesh& mesh, const TextureParams& params);

  int count() const { return static_cast<int>(directions_.size()); }
  const MeshExtent& extent() const { return renderer_.extent(); }

  /// Draws one of them. Throws std::invalid_argument for an index that there is not.
  TextureView view(int index) const;

private:
  TextureParams params_;
  MeshRenderer renderer_;
  std::vector<cv::Vec3d> directions_;
};

/// Learns the keypoints of an object from views of it. Keypoints of several views at the same place that look alike are
/// one; a place that changes its look with the direction has several. The same views in the same order give the same
/// bits, whether training was interrupted or not. For one thread at a time.
class TextureTrainer
{
public:
  /// Fewest keypoints of an object that look like no other place of it, or it cannot be found by its texture.
  static constexpr int kMinPoints = 60;

  /// `extent` is that of the object, as far as it is known: keypoints that are not inside of it are left out. Throws
  /// std::invalid_argument as validate() of the parameters does, and for an extent of no size.
  TextureTrainer(const TextureParams& params, const MeshExtent& extent);

  /// Goes on with what was learned before. Throws std::invalid_argument as validate() of the model does.
  explicit TextureTrainer(const TextureModel& model);

  ~TextureTrainer();
  TextureTrainer(TextureTrainer&&) noexcept;
  TextureTrainer& operator=(TextureTrainer&&) noexcept;

  /// Throws std::invalid_argument naming what is wrong with the view.
  void add(const TextureView& view);

  int views() const;

  /// All that was learned so far, from which another trainer can go on.
  const TextureModel& state() const;

  /// The keypoints that enough views have. Throws std::invalid_argument if too few of them look like no other place of
  /// the object: then it has too little texture.
  TextureModel model() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
