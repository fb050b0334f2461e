#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <stereo_msgs/DisparityImage.h>

#include <opencv2/core.hpp>

#include "robot_vision/stereo/stereo_camera.hpp"
#include "robot_vision/stereo/stereo_matcher.hpp"
#include "stereo_input.hpp"

namespace robot_vision
{

/// The calibration of a pair. Throws std::invalid_argument naming the topics, what is wrong there and what it must be,
/// if the cameras are not calibrated, not together, or if their camera_info is of images of another size.
StereoCamera stereoCamera(const StereoFrame& frame);

/// The camera_info of the rectified left images: K is that of P, without distortion and rotation.
sensor_msgs::CameraInfoPtr rectifiedInfo(const std_msgs::Header& header, const RectifiedCamera& left);

/// Disparities (CV_32FC1, px, NaN: none) as image_pipeline has them: relative to the disparity at infinity, and below
/// min_disparity where there is none.
stereo_msgs::DisparityImagePtr toDisparityImage(const std_msgs::Header& header, const cv::Mat& disparity,
                                                const StereoMatcher& matcher, const StereoGeometry& geometry);

}  // namespace robot_vision
