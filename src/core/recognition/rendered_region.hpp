#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "pinhole.hpp"
#include "robot_vision/recognition/object_shape.hpp"

namespace robot_vision
{

/// The part of an image that an object is in, as it would look in a pose. Of a large one only every `step`th pixel in
/// rows and columns is drawn: the one at the same place of the image, as it is.
struct RenderedRegion
{
  cv::Rect box;  // px, within the image
  int step = 1;  // px
  cv::Affine3d pose;
  cv::Vec3d center;  // m, of the mesh in the camera's optical frame
  MeshView view;
  Pinhole camera{cv::Matx33d::eye()};  // of the view's pixels

  cv::Point inImage(int x, int y) const { return {box.x + x * step, box.y + y * step}; }
  cv::Matx33d K() const { return {camera.fx, camera.skew, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1}; }
};

/// The number of pixels of a view that show something.
int drawnPixels(const MeshView& view);

/// The smallest box of an image that has all pixels of a mesh of this extent in it, whatever its shape is; empty if
/// that is outside of the image, or a part of it is not before the camera.
cv::Rect projectedBox(const MeshExtent& extent, const cv::Affine3d& pose, const cv::Matx33d& K, const cv::Size& image);

/// Draws an object with at most so many pixels (of the box around it). Returns false if nothing of it would be seen.
bool drawRegion(const ObjectShape& shape, const cv::Affine3d& pose, const cv::Matx33d& K, const cv::Size& image,
                int max_pixels, const RenderParts& parts, RenderedRegion& region);

}  // namespace robot_vision
