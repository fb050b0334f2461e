#include "registration_cameras.hpp"

#include <stdexcept>

#include "ros/images/camera_info.hpp"

namespace robot_vision
{
namespace
{

/// The camera of images as they come, or of rectified ones. Throws std::invalid_argument naming the topic.
CameraModel cameraOf(const sensor_msgs::CameraInfo& info, bool rectified, const std::string& topic)
{
  CameraModel camera = cameraModel(info);
  if (rectified)
  {
    camera.K = cv::Matx34d(info.P.data()).get_minor<3, 3>(0, 0);
    camera.D.clear();
    camera.distortion_model = "plumb_bob";
  }
  try
  {
    validate(camera);
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument("camera_info on " + topic + (rectified ? ", with P for K: " : ": ") + e.what());
  }
  return camera;
}

}  // namespace

void RegistrationCameras::configure(const Params& params)
{
  validate(params.registration);
  params_ = params;
  registration_.reset();
  points_.reset();
}

void RegistrationCameras::set(const RegistrationFrame& frame, const RegistrationTopics& topics,
                              const cv::Affine3d& depth_to_color)
{
  const CameraModel depth = cameraOf(*frame.depth_info, params_.depth_rectified, topics.depth_info);
  const CameraModel color = cameraOf(*frame.color_info, params_.color_rectified, topics.color_info);
  if (!registration_ || !(depth == depth_) || !(color == color_))
  {
    registration_ = std::make_unique<DepthRegistration>(depth, color, depth_to_color, params_.registration);
    points_.reset();
    depth_ = depth;
    color_ = color;
  }
  else if (depth_to_color.matrix != depth_to_color_.matrix)
  {
    registration_->setTransform(depth_to_color);
  }
  depth_to_color_ = depth_to_color;
}

std::shared_ptr<const DepthPoints> RegistrationCameras::points()
{
  if (!points_) points_ = std::make_shared<const DepthPoints>(color_);
  return points_;
}

}  // namespace robot_vision
