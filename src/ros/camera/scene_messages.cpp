#include "scene_messages.hpp"

#include <tf2/LinearMath/Matrix3x3.h>
#include <tf2/LinearMath/Quaternion.h>

#include <algorithm>
#include <iterator>

namespace robot_vision
{
namespace
{

geometry_msgs::Pose toPose(const cv::Affine3d& affine)
{
  const cv::Matx33d r = affine.rotation();
  tf2::Quaternion q;
  tf2::Matrix3x3(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)).getRotation(q);
  geometry_msgs::Pose pose;
  pose.position.x = affine.translation()[0];
  pose.position.y = affine.translation()[1];
  pose.position.z = affine.translation()[2];
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  pose.orientation.w = q.w();
  return pose;
}

geometry_msgs::Point toPoint(const cv::Point2d& pixel)
{
  geometry_msgs::Point point;
  point.x = pixel.x;
  point.y = pixel.y;
  return point;
}

GroundTruthObject toMessage(const SceneObject& object)
{
  GroundTruthObject message;
  message.name = object.name;
  message.pose = toPose(object.pose);
  message.center = toPoint(object.center);
  std::transform(object.outline.begin(), object.outline.end(), std::back_inserter(message.outline), toPoint);
  message.visible = object.visible;
  return message;
}

}  // namespace

sensor_msgs::CameraInfo toCameraInfo(const CameraModel& model)
{
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(model.width);
  info.height = static_cast<std::uint32_t>(model.height);
  info.distortion_model = model.distortion_model;
  info.D.assign(model.D.begin(), model.D.end());
  std::copy(model.K.val, model.K.val + 9, info.K.begin());
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const cv::Matx33d& k = model.K;
  info.P = {k(0, 0), k(0, 1), k(0, 2), 0, k(1, 0), k(1, 1), k(1, 2), 0, k(2, 0), k(2, 1), k(2, 2), 0};
  return info;
}

sensor_msgs::CameraInfo toRightCameraInfo(const CameraModel& left, const SecondCamera& right)
{
  sensor_msgs::CameraInfo info = toCameraInfo(right.model);
  info.P = toCameraInfo(left).P;
  info.P[3] = -info.P[0] * right.pose.translation()[0];
  return info;
}

GroundTruth toMessage(const SceneTruth& truth, const std_msgs::Header& header)
{
  GroundTruth message;
  message.header = header;
  message.frame = static_cast<std::uint64_t>(truth.frame);
  message.camera = toPose(truth.camera);
  for (const SceneObject& object : truth.objects)
    message.objects.push_back(toMessage(object));
  return message;
}

geometry_msgs::TransformStamped toTransform(const cv::Affine3d& pose, const std_msgs::Header& header,
                                            const std::string& child_frame_id)
{
  const geometry_msgs::Pose as_message = toPose(pose);
  geometry_msgs::TransformStamped transform;
  transform.header = header;
  transform.child_frame_id = child_frame_id;
  transform.transform.translation.x = as_message.position.x;
  transform.transform.translation.y = as_message.position.y;
  transform.transform.translation.z = as_message.position.z;
  transform.transform.rotation = as_message.orientation;
  return transform;
}

std::vector<geometry_msgs::TransformStamped> toTransforms(const SceneTruth& truth, const std_msgs::Header& header)
{
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (const SceneObject& object : truth.objects)
    transforms.push_back(toTransform(object.pose, header, "scene/" + object.name));
  return transforms;
}

}  // namespace robot_vision
