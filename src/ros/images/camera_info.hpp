#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>

#include <boost/function.hpp>
#include <cstdint>
#include <opencv2/core/types.hpp>
#include <string>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// The camera of a camera_info, as it is: validate() says whether there can be such a camera.
CameraModel cameraModel(const sensor_msgs::CameraInfo& info);

/// Whether a camera_info has a binning or a region. Then it is that of the whole sensor (REP 104) or, of some drivers,
/// that of the images.
bool hasWindow(const sensor_msgs::CameraInfo& info);

/// Whether both are of the same size, binning and region.
bool haveSameWindow(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b);

/// The camera_info of the pixels of images. A driver that bins pixels, or gives a region, has that of the whole sensor
/// in it (REP 104): then size, K and P are those of the images, as image_geometry takes them, and binning and roi are
/// gone. It stays as it is where its own size is already `size`, that of the images if it is known.
sensor_msgs::CameraInfoConstPtr ofImages(const sensor_msgs::CameraInfoConstPtr& info, const cv::Size& size = {});

/// Where the camera_info of CAMERA/image_raw is: as CAMERA/camera_info is remapped, or else beside the image.
std::string cameraInfoTopic(const ros::NodeHandle& nh, const std::string& camera);

/// Subscribes to what that has returned, through the queue of `nh`.
ros::Subscriber subscribeToCameraInfo(const ros::NodeHandle& nh, const std::string& topic, std::uint32_t queue_size,
                                      const boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>& callback);

}  // namespace robot_vision
