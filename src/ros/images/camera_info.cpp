#include "camera_info.hpp"

#include <image_transport/camera_common.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cstdint>
#include <limits>
#include <opencv2/core/matx.hpp>

#include "bounded_reading.hpp"
#include "subscribing_lock.hpp"

namespace robot_vision
{
namespace
{

/// Whether the images are of a region of the sensor.
bool hasRegion(const sensor_msgs::CameraInfo& info)
{
  return info.roi.width != 0 && info.roi.height != 0;
}

}  // namespace

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

bool hasWindow(const sensor_msgs::CameraInfo& info)
{
  return info.binning_x > 1 || info.binning_y > 1 || hasRegion(info);
}

bool haveSameWindow(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b)
{
  return a.width == b.width && a.height == b.height && a.binning_x == b.binning_x && a.binning_y == b.binning_y &&
         a.roi == b.roi;
}

sensor_msgs::CameraInfoConstPtr ofImages(const sensor_msgs::CameraInfoConstPtr& info, const cv::Size& size)
{
  const bool is_theirs = cv::Size2d(info->width, info->height) == cv::Size2d(size);
  if (is_theirs || !hasWindow(*info)) return info;

  const sensor_msgs::RegionOfInterest& roi = info->roi;
  const std::uint32_t columns = std::max(info->binning_x, 1U), rows = std::max(info->binning_y, 1U);  // of a pixel
  const auto made = boost::make_shared<sensor_msgs::CameraInfo>(*info);
  const cv::Matx33d binning(1.0 / columns, 0.0, 0.0, 0.0, 1.0 / rows, 0.0, 0.0, 0.0, 1.0);
  const cv::Matx33d region(1.0, 0.0, -1.0 * roi.x_offset, 0.0, 1.0, -1.0 * roi.y_offset, 0.0, 0.0, 1.0);
  const cv::Matx33d K = binning * region * cv::Matx33d(info->K.data());
  const cv::Matx34d P = binning * region * cv::Matx34d(info->P.data());
  std::copy_n(K.val, made->K.size(), made->K.begin());
  std::copy_n(P.val, made->P.size(), made->P.begin());
  made->width = (hasRegion(*info) ? roi.width : info->width) / columns;
  made->height = (hasRegion(*info) ? roi.height : info->height) / rows;
  made->binning_x = made->binning_y = 0;
  made->roi = sensor_msgs::RegionOfInterest();
  return made;
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
