#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <robot_vision/GroundTruth.h>
#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>

#include <string>
#include <vector>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// The calibration without a rectifying rotation; P equals K.
sensor_msgs::CameraInfo toCameraInfo(const CameraModel& model);

/// The calibration of the right one of two cameras side by side that look in the same direction. Its P is that of the
/// left one, moved by the distance between them: so both are calibrated together, and need no rectifying rotation.
sensor_msgs::CameraInfo toRightCameraInfo(const CameraModel& left, const SecondCamera& right);

GroundTruth toMessage(const SceneTruth& truth, const std_msgs::Header& header);

/// The transform from the frame of `header` to one that has this pose there.
geometry_msgs::TransformStamped toTransform(const cv::Affine3d& pose, const std_msgs::Header& header,
                                            const std::string& child_frame_id);

/// The transforms from the camera's optical frame (header.frame_id) to scene/<name> for each object.
std::vector<geometry_msgs::TransformStamped> toTransforms(const SceneTruth& truth, const std_msgs::Header& header);

}  // namespace robot_vision
