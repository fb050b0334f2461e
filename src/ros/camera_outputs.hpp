#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <functional>
#include <memory>
#include <string>

#include "image_message.hpp"
#include "robot_vision/frame_source.hpp"
#include "throttle.hpp"

namespace robot_vision
{

/// What a camera publishes: ~image_raw (bgr8, or mono8 of a grey camera) with ~camera_info, ~image_mono, and of the
/// synthetic scene ~ground_truth and tf frames scene/<name>. Pictures are converted only
/// for those who subscribe (to ~camera_info counts as to ~image_raw).
class CameraOutputs
{
public:
  struct Params
  {
    std::string frame_id = "head_camera";     // the camera's optical frame
    std::string camera_name = "head_camera";  // letters, digits and _; names the calibration
    std::string camera_info_url;              // file:// or package://; "": in $ROS_HOME/camera_info
  };

  /// `on_connection` is called when subscribers come or go. Throws std::invalid_argument naming the bad parameter.
  CameraOutputs(const ros::NodeHandle& pnh, const Params& params, const std::function<void()>& on_connection);

  bool wanted() const;

  /// The geometry to publish while there is no calibration; null: none.
  void setModel(const CameraModel* model);

  /// Gives the frame the next message's memory, if its picture is going to be published as it is.
  void prepare(Frame& frame);

  /// Throws std::invalid_argument if the frame is damaged.
  void publish(const Frame& frame, const ros::Time& stamp);

private:
  sensor_msgs::ImagePtr convert(const Frame& frame, const std::string& encoding);
  sensor_msgs::CameraInfoPtr cameraInfo(const sensor_msgs::Image& image);
  void publishTruth(const SceneTruth& truth, const std_msgs::Header& header);

  std::string name_;
  std::string frame_id_;
  camera_info_manager::CameraInfoManager calibration_;
  std::unique_ptr<sensor_msgs::CameraInfo> model_;
  image_transport::ImageTransport it_;
  image_transport::CameraPublisher raw_;
  image_transport::Publisher mono_;
  ros::Publisher truth_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_;
  ImagePool raw_pool_;
  ImagePool mono_pool_;
  sensor_msgs::ImagePtr prepared_;
  cv::Size size_;  // of the last picture
  Throttle throttle_;
};

}  // namespace robot_vision
