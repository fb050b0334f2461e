#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <functional>
#include <memory>
#include <string>

#include "calibration.hpp"
#include "core/common/throttle.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "ros/images/image_message.hpp"
#include "ros/transports/compression.hpp"

namespace robot_vision
{

/// What a camera publishes: ~image_raw (in output_encoding) with ~camera_info, ~image_mono, and of the
/// synthetic scene ~ground_truth and tf frames scene/<name>. Pictures are converted only for those who subscribe.
/// ~image_raw/compressed is its own, not a plugin's: what a camera gives as JPEG is passed on as it is. So is
/// ~image_raw/compressedDepth, which there is with the only output_encoding that can hold depths, native: recorders
/// subscribe to all topics, and no JPEG is decoded for this one. What is compressed is so in other threads: no other
/// output waits for it.
class CameraOutputs
{
public:
  struct Params
  {
    std::string frame_id = "head_camera";     // the camera's optical frame
    std::string camera_name = "head_camera";  // letters, digits and _; names the calibration
    std::string output_encoding = "auto";     // of ~image_raw: auto, bgr8, rgb8, mono8 or native
    std::string camera_info_url;              // file:// or package://; "": in $ROS_HOME/camera_info
  };

  /// `on_connection` is called when subscribers come or go. Throws std::invalid_argument naming the bad parameter.
  CameraOutputs(const ros::NodeHandle& pnh, const Params& params, const std::function<void()>& on_connection);

  bool wanted() const;

  /// The geometry of the source; null: it is not known. It is exact, and counts unless camera_info_url names another.
  void setModel(const CameraModel* model);

  /// Gives the frame the next message's memory, if its picture is going to be published as it is.
  void prepare(Frame& frame);

  /// Throws std::invalid_argument if the frame is damaged, and what else kept an output from being made, when all the
  /// others have been published; what kept a picture from being compressed it throws of the next one.
  void publish(const Frame& frame, const ros::Time& stamp);

private:
  std::string rawEncoding(const Frame& frame);
  void publishPictures(const Frame& frame, const std_msgs::Header& header);
  void publishInfo(const Frame& frame, cv::Size& size, const std_msgs::Header& header);
  cv::Size publishMono(const Frame& frame, const sensor_msgs::ImagePtr& raw, const std_msgs::Header& header);
  sensor_msgs::ImagePtr rawImage(const Frame& frame);
  sensor_msgs::ImagePtr convert(const Frame& frame, const std::string& encoding);
  sensor_msgs::CameraInfoPtr cameraInfo(cv::Size size);
  void publishTruth(const SceneTruth& truth, const std_msgs::Header& header);

  std::string name_;
  std::string frame_id_;
  std::string output_encoding_;
  bool told_ = false;  // that it cannot be had
  Calibration calibration_;
  bool chosen_;  // camera_info_url names it
  std::unique_ptr<sensor_msgs::CameraInfo> model_;
  image_transport::ImageTransport it_;
  image_transport::Publisher raw_;
  image_transport::Publisher mono_;
  std::unique_ptr<CompressedOutput> compressed_;  // null: disabled
  std::unique_ptr<CompressedDepthOutput> depth_;  // null: disabled, or there can be no depths
  ros::Publisher info_;
  ros::Publisher truth_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_;
  ImagePool prepared_pool_;
  ImageMaker raw_maker_;
  ImageMaker mono_maker_;
  sensor_msgs::ImagePtr prepared_;
  cv::Size size_;  // of the last picture
  Throttle throttle_;
};

}  // namespace robot_vision
