#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "scene_textures.hpp"
#include "scene_view.hpp"
#include "texture_kernels.hpp"

// These functions draw anti-aliased shapes over what is already in the image, so the caller goes from the back to the
// front. Every pixel has its ray from the lens's table, so the distortion is exact. `bgr` is CV_8UC3 of the camera's
// size.
namespace robot_vision::scene
{

/// What draws a run of pixels of a texture, as TextureKernels::draw() does.
using DrawTexture = decltype(TextureKernels::draw);

/// Draws a textured rectangle of `size` (m) if the camera sees its front. `pose` is in the optical frame.
void paintBoard(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size, const Lens& lens,
                DrawTexture draw, cv::Mat& bgr);

/// Draws the ball, lit by a lamp in the direction `to_light`. All vectors are in the optical frame.
void paintBall(const cv::Point3d& center, double radius, const cv::Vec3d& to_light, const Lens& lens, cv::Mat& bgr);

/// Draws the line on the floor.
void paintLine(const cv::Affine3d& world_in_camera, const Lens& lens, cv::Mat& bgr);

/// The columns [x, y) that a shape may touch in each row of the image, none where x >= y.
struct RowSpans
{
  int top = 0;  // row of the first span
  std::vector<cv::Point> spans;
};

/// The spans of a polygon, two pixels wider on every side.
RowSpans rowSpans(const Polygon2& polygon, const CameraModel& camera);

/// The spans of a rectangle of `size` (m); `pose` is in the optical frame.
RowSpans boardSpans(const cv::Affine3d& pose, const cv::Size2d& size, const Lens& lens);

/// The homography from a ray (x, y, 1) to the point (a, b) where it meets the plane z = 0 of `pose`: the product of the
/// matrix with the ray is proportional to (a, b, 1). Its third element is positive if the point is in front of the
/// camera and seen from +z.
cv::Matx33d rayToPlane(const cv::Affine3d& pose);

/// Fills what is above the horizon of the plane z = 0 of `ground`, or on its other side.
void paintSky(const cv::Scalar& color, const cv::Affine3d& ground, const Lens& lens, cv::Mat& bgr);

/// Mixes a colour into a pixel with a weight `alpha` of 0 to 255.
inline void blend(uchar* pixel, const uchar* color, int alpha)
{
  for (int i = 0; i < 3; ++i)
    pixel[i] = static_cast<uchar>((pixel[i] * (255 - alpha) + color[i] * alpha + 127) / 255);
}

}  // namespace robot_vision::scene
