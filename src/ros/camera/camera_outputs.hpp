#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "calibration.hpp"
#include "frame_view.hpp"
#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// What a camera publishes: ~image_raw (in output_encoding) with ~camera_info, ~image_mono, and of the synthetic scene
/// ~ground_truth and the tf frames scene/<name>. Nothing is made for a topic that nobody subscribes to.
/// ~image_raw/compressed does not come from a plugin, so that the JPEG of a camera can be passed on as it is. Neither
/// does ~image_raw/compressedDepth: it exists only with the output_encoding native, the only one that can hold depths,
/// so that a recorder that subscribes to all topics has no JPEG decoded for it. Images are compressed in other threads,
/// and no other output waits for that.
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

  /// Whether somebody subscribes to any of the topics.
  bool wanted() const;

  /// The geometry of the source, or null if the source does not know it.
  void setModel(const CameraModel* model) { calibration_.setModel(model); }

  /// Gives the frame memory of the next message, if its image is going to be published as it is.
  void prepare(Frame& frame);

  /// Publishes what can be made of the frame, and then throws what has kept the first of the other outputs from being
  /// made: std::invalid_argument if the frame is damaged. An image that could not be compressed is told of by a later
  /// call.
  void publish(const Frame& frame, const ros::Time& stamp);

private:
  /// A topic and what is published on it.
  struct Output
  {
    std::function<bool()> wanted;
    std::function<void(FrameView& view)> publish;
  };

  void advertise(ros::NodeHandle nh, const std::function<void()>& on_connection);
  sensor_msgs::ImageConstPtr rawImage(FrameView& view);
  void broadcast(const SceneTruth& truth, const std_msgs::Header& header);

  std::string name_;
  std::string frame_id_;
  std::string output_encoding_;
  bool told_ = false;  // whether the log says that an encoding cannot be published
  Calibration calibration_;
  ImageMakers makers_;
  image_transport::Publisher raw_;
  std::vector<Output> outputs_;  // in the order in which they are published
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_;
};

}  // namespace robot_vision
