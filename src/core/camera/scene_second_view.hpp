#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/camera/open_source.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/scene/depth_noise.hpp"
#include "robot_vision/scene/scene.hpp"

namespace robot_vision
{

/// How bright the things are that the pixels of a depth camera measure, as the color camera beside it sees them.
class DepthBrightness
{
public:
  /// `pose` is that of the depth camera in the color camera's optical frame; both look in the same direction.
  DepthBrightness(const CameraModel& depth_camera, const CameraModel& color_camera, const cv::Affine3d& pose);

  /// CV_8UC1 of the depth image's size, valid until the next call; 128 for what the color image does not show. `bgr` is
  /// CV_8UC3, `metres` CV_32FC1.
  const cv::Mat& measure(const cv::Mat& bgr, const cv::Mat& metres);

private:
  cv::Mat far_x_;  // px, CV_32FC1: where the color camera sees what is far away, for each pixel of the depth camera
  cv::Mat far_y_;
  double shift_;  // px m, by which it is seen to the right of that, divided by its z
  cv::Mat gray_;
  cv::Mat x_;  // px, CV_32FC1: where the color camera sees what is as near as it is
  cv::Mat brightness_;
};

/// The second images of a scene: those of its right camera, or of its depth camera as a sensor measures them.
class SceneSecondView
{
public:
  /// `params.views` is stereo or rgbd. The scene must outlive the view.
  SceneSecondView(const Scene& scene, const CaptureParams& params);

  const SecondCamera& camera() const { return camera_; }

  /// Makes the image of a frame. `bgr` is what the color camera sees in it, or empty if nobody has made that.
  void render(std::int64_t frame, const cv::Mat& bgr, EncodedImage& image);

private:
  void renderDepth(std::int64_t frame, const cv::Mat& bgr, cv::Mat& depth);

  const Scene& scene_;
  bool is_right_;
  SecondCamera camera_;
  std::string encoding_;
  std::unique_ptr<const DepthNoise> noise_;      // null if depths are to be exact
  std::unique_ptr<DepthBrightness> brightness_;  // null without noise
  cv::Mat bgr_;
  cv::Mat metres_;
};

}  // namespace robot_vision
