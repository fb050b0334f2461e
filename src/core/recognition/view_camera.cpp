#include "view_camera.hpp"

#include <algorithm>
#include <cmath>

#include "robot_vision/common/range.hpp"
#include "robot_vision/geometry/distortion_models.hpp"

namespace robot_vision
{
namespace
{

constexpr double kFocalLength = 262.0;  // px, about that of a Kinect with half its pixels in a row

/// The middle of the first pixel is at (block - 1) / 2 in the real image.
double reduced(double position, int block)
{
  return (position + 0.5) / block - 0.5;
}

}  // namespace

ViewCamera::ViewCamera(const CameraModel& camera) : camera_(camera)
{
  validate(camera);
  require(isCalibrated(camera.K), "K of the camera", "zero", "that of a calibrated camera");
  const double focal_length = 0.5 * (camera.K(0, 0) + camera.K(1, 1));
  block_ =
      std::clamp(static_cast<int>(std::lround(focal_length / kFocalLength)), 1, std::min(camera.width, camera.height));
  size_ = {camera.width / block_, camera.height / block_};
  fx_ = camera.K(0, 0) / block_;
  fy_ = camera.K(1, 1) / block_;
  cx_ = reduced(camera.K(0, 2), block_);
  cy_ = reduced(camera.K(1, 2), block_);
  inverse_lengths_.create(size_);
  for (int x = 0; x < size_.width; ++x)
    ray_x_.push_back(static_cast<float>((x - cx_) / fx_));
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x)
      inverse_lengths_[y][x] =
          1.0F / std::sqrt(ray_x_[static_cast<std::size_t>(x)] * ray_x_[static_cast<std::size_t>(x)] +
                           rayY(y) * rayY(y) + 1.0F);
  if (isDistorted(camera) || camera.K(0, 1) != 0.0) findPlaces();
}

void ViewCamera::findPlaces()
{
  places_.create(size_, CV_32FC2);
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x)
    {
      const cv::Point2d pixel = camera_.project({(x - cx_) / fx_, (y - cy_) / fy_, 1.0});
      places_.at<cv::Vec2f>(y, x) = {static_cast<float>(reduced(pixel.x, block_)),
                                     static_cast<float>(reduced(pixel.y, block_))};
    }
}

}  // namespace robot_vision
