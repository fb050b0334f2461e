#pragma once

#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robot_vision/camera/frame_source.hpp"
#include "view_outputs.hpp"

namespace robot_vision
{

/// What a camera publishes: a view (see ViewOutputs) in its own namespace, or two of them, with the same stamps, in
/// ~left and ~right or in ~rgb and ~depth. Where the second is to the first is on /tf_static, if the source knows it,
/// and where both are in their housing: <camera_name>_link, with the frames <camera_name>_rgb_frame (x forward)
/// between. Of the synthetic scene there are also ~ground_truth and the tf frames scene/<name>, in the first view's
/// frame.
///
/// Both of a stereo pair have the frame of the left one, unless `right_frame` is own: the P of both have their points
/// there, with the baseline in the right one. image_pipeline refuses a pair in two frames (image_geometry's
/// StereoCameraModel asserts that), and in a frame of its own the right one's P would count the baseline twice, as
/// rviz does. But its K and D, and what is found by them in image_raw, belong to a frame of its own. That is on
/// /tf_static in both cases. A depth camera has one, too. The names are those of freenect and openni:
/// <camera_name>_depth_optical_frame.
class CameraOutputs
{
public:
  struct Params
  {
    std::string frame_id = "head_camera";     // the optical frame of the camera, or of its first view
    std::string camera_name = "head_camera";  // letters, digits and _; names the calibration
    std::string output_encoding = "auto";     // of image_raw: auto, bgr8, rgb8, mono8 or native
    std::string camera_info_url;              // file:// or package://; "": in $ROS_HOME/camera_info
    std::string views = "one";                // one, stereo or rgbd, see CaptureParams
    std::string right_frame = "left";         // of the right one of a pair: left, the same, or own
    bool depths = false;                      // whether the only view is one of depths
    std::string second_frame_id;              // of the second view; "": <camera_name>_<view>_optical_frame
    bool publish_tf = true;                   // whether anything is on /tf and /tf_static
  };

  /// `on_connection` is called when subscribers come or go. Throws std::invalid_argument naming the bad parameter.
  CameraOutputs(const ros::NodeHandle& pnh, const Params& params, const std::function<void()>& on_connection);

  /// Whether somebody subscribes to any of the topics.
  bool wanted() const;

  /// What is shared of the topics of images.
  std::vector<std::shared_ptr<SharedTopic>> sharedTopics() const;

  /// The views to which somebody subscribes. That of a camera with one view always counts as wanted.
  WantedViews wantedViews() const;

  /// The geometry of the source; null for what it does not know. With a housing it is that of its make, else exact.
  void setCameras(const CameraModel* first, const SecondCamera* second, const Housing* housing = nullptr);

  /// Gives the images of a frame memory of the next messages, if they are going to be published as they are.
  void prepare(Frame& frame);

  /// Publishes what can be made of the frame, and then throws what has kept the first of the other outputs from being
  /// made: std::invalid_argument if the frame is damaged. An image that could not be compressed is told of by a later
  /// call. Only the views that the frame says were wanted are published.
  void publish(const Frame& frame, const ros::Time& stamp);

private:
  void broadcast(const SceneTruth& truth, const std_msgs::Header& header);
  void broadcastSecond(const cv::Affine3d& pose, const Housing* housing);

  Params params_;
  std::string second_frame_;                         // where the second camera is
  std::vector<std::unique_ptr<ViewOutputs>> views_;  // one or two
  ros::Publisher truth_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> static_tf_;
};

}  // namespace robot_vision
