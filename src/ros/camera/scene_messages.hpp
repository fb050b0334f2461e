#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <robot_vision/GroundTruth.h>
#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>

#include <vector>

#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/scene/scene.hpp"

namespace robot_vision
{

/// The calibration without a rectifying rotation; P equals K.
sensor_msgs::CameraInfo toCameraInfo(const CameraModel& model);

GroundTruth toMessage(const SceneTruth& truth, const std_msgs::Header& header);

/// The transforms from the camera's optical frame (header.frame_id) to scene/<name> for each object.
std::vector<geometry_msgs::TransformStamped> toTransforms(const SceneTruth& truth, const std_msgs::Header& header);

}  // namespace robot_vision
