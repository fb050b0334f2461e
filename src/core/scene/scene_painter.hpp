#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "scene_textures.hpp"
#include "scene_view.hpp"

// Everything is drawn from the back to the front over what is there, with anti-aliased outlines. A pixel of the picture
// is a ray from the lens's table, so distortion is exact in every pixel. `bgr` is CV_8UC3 of the lens's size.
namespace robot_vision::scene
{

/// A textured rectangle seen from its front; nothing when it turns its back. `pose` is in the optical frame.
void paintBoard(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size, const Lens& lens,
                cv::Mat& bgr);

/// The ball, lit by a lamp in the direction `to_light`; all in the optical frame.
void paintBall(const cv::Point3d& center, double radius, const cv::Vec3d& to_light, const Lens& lens, cv::Mat& bgr);

/// The line on the floor.
void paintLine(const cv::Affine3d& world_in_camera, const Lens& lens, cv::Mat& bgr);

/// For each row of the picture the columns that a shape may touch: [first, last), empty when first >= last.
struct RowSpans
{
  int top = 0;  // row of the first span
  std::vector<cv::Point> spans;
};

/// Spans around a polygon, two pixels wider on every side.
RowSpans rowSpans(const Polygon2& polygon, const CameraModel& camera);

/// Rows: for a ray (x, y, 1), the vector they make is proportional to (a, b, 1) where the ray meets the plane z = 0 of
/// `pose` at (a, b); the third row gives a positive number when that is in front of the camera and seen from +z.
cv::Matx33d rayToPlane(const cv::Affine3d& pose);

/// Mixes a colour into a pixel; `alpha` from 0 to 255.
inline void blend(uchar* pixel, const uchar* colour, int alpha)
{
  for (int i = 0; i < 3; ++i)
    pixel[i] = static_cast<uchar>((pixel[i] * (255 - alpha) + colour[i] * alpha + 127) / 255);
}

}  // namespace robot_vision::scene
