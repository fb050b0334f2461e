#include "camera_info.hpp"

#include <image_transport/camera_common.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "bounded_reading.hpp"
#include "subscribing_lock.hpp"

namespace robot_vision
{

CameraModel cameraModel(const sensor_msgs::CameraInfo& info)
{
  CameraModel model;
  constexpr std::uint32_t kMaxInt = std::numeric_limits<int>::max();
  model.width = static_cast<int>(std::min(info.width, kMaxInt));
  model.height = static_cast<int>(std::min(info.height, kMaxInt));
  model.K = cv::Matx33d(info.K.data());
  model.D = info.D;
  model.distortion_model = info.distortion_model;
  return model;
}

std::string cameraInfoTopic(const ros::NodeHandle& nh, const std::string& camera)
{
  const std::string name = camera + "/camera_info", resolved = nh.resolveName(name);
  if (resolved != nh.resolveName(name, /*remap=*/false)) return resolved;
  return image_transport::getCameraInfoTopic(nh.resolveName(camera + "/image_raw"));
}

ros::Subscriber subscribeToCameraInfo(const ros::NodeHandle& nh, const std::string& topic, std::uint32_t queue_size,
                                      const boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>& callback)
{
  ros::SubscribeOptions options = boundedOptions<sensor_msgs::CameraInfo>(topic, queue_size, callback);
  options.transport_hints = ros::TransportHints().tcpNoDelay();  // otherwise small packets wait for each other
  // `nh` would remap the topic once more: to that of another camera where the names of two are exchanged.
  ros::NodeHandle exact("/", {{topic, topic}});
  exact.setCallbackQueue(nh.getCallbackQueue());
  const SubscribingLock subscribing;
  return exact.subscribe(options);
}

}  // namespace robot_vision
