#include <algorithm>
#include <cmath>

#include "robot_vision/common/range.hpp"
#include "robot_vision/recognition/texture_trainer.hpp"
#include "robot_vision/recognition/view_tree.hpp"

namespace robot_vision
{
namespace
{

constexpr double kDistance = 4.0;  // of the camera from the middle of the object, in its radii
constexpr int kMargin = 8;         // px around it

}  // namespace

TextureViews::TextureViews(const Mesh& mesh, const TextureParams& params)
  : params_((validate(params), params)), renderer_(mesh)
{
  for (const ViewDirection& view : viewTree(params.subdivisions).directions)
    directions_.push_back(view.direction);
}

TextureView TextureViews::view(int index) const
{
  requireRange("the index of a view", index, 0, static_cast<double>(directions_.size()) - 1.0);
  const cv::Matx33d rotation = lookedAtFrom(directions_[static_cast<std::size_t>(index)]);
  const MeshExtent& extent = renderer_.extent();
  // What touches the sphere around the object just fits into an image of this focal length.
  const double size = params_.view_size * 2.0 * extent.radius / extent.diameter;
  const double focal = 0.5 * size * std::sqrt(kDistance * kDistance - 1.0);
  const int side = cvCeil(size) + 2 * kMargin;
  TextureView view;
  view.camera.width = view.camera.height = side;
  const double middle = 0.5 * (side - 1);
  view.camera.K = {focal, 0.0, middle, 0.0, focal, middle, 0.0, 0.0, 1.0};
  view.pose = {rotation, cv::Vec3d(0.0, 0.0, kDistance * extent.radius) - rotation * extent.center};
  RenderParts parts;
  parts.bgr = true;
  MeshView drawn;
  renderer_.render(view.camera.K, view.pose, cv::Rect(0, 0, side, side), drawn, parts);
  view.image = drawn.bgr;
  view.depth = drawn.depth;
  return view;
}

}  // namespace robot_vision
