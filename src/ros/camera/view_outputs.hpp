#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calibration.hpp"
#include "frame_view.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

/// What is published of one view of a camera, in a namespace of its own: image_raw (in output_encoding) with
/// camera_info, and image_mono; of a view of depths image_raw with camera_info, and no gray, JPEG or video, which could
/// not hold them. Nothing is made for a topic that nobody subscribes to.
/// image_raw/compressed does not come from a plugin, so that the JPEG of a camera can be passed on as it is. Neither
/// does image_raw/compressedDepth: it exists only in a view of depths, and with the output_encoding native, so that a
/// recorder that subscribes to all topics has no JPEG decoded for it. Images are compressed in other threads, and no
/// other output waits for that.
class ViewOutputs
{
public:
  struct Params
  {
    std::string frame_id;                             // the view's optical frame
    std::string camera_name;                          // letters, digits and _; names the calibration
    std::string output_encoding;                      // of image_raw: auto, bgr8, rgb8, mono8 or native
    std::string camera_info_url;                      // file:// or package://; "": in $ROS_HOME/camera_info
    bool depths = false;                              // whether the view is one of depths
    std::string frame_parameter = "camera_frame_id";  // that sets frame_id
  };

  /// `on_connection` is called when subscribers come or go. Throws std::invalid_argument naming the bad parameter.
  ViewOutputs(const ros::NodeHandle& nh, const Params& params, const std::function<void()>& on_connection);

  const std::string& frameId() const { return frame_id_; }

  /// Whether somebody subscribes to any of the topics.
  bool wanted() const;

  /// What is shared of the topics of images.
  const std::vector<std::shared_ptr<SharedTopic>>& sharedTopics() const { return makers_.topics(); }

  /// The calibration that the source knows, which is exact or that of its make, or null.
  void setModel(std::unique_ptr<sensor_msgs::CameraInfo> model, bool exact)
  {
    calibration_.setModel(std::move(model), exact);
  }

  /// Gives an image memory of the next message, if it is going to be published as it is.
  void prepare(cv::Mat& image);

  /// Publishes what can be made of the image, and then throws what has kept the first of the other outputs from being
  /// made: std::invalid_argument if the image is damaged. An image that could not be compressed is told of by a later
  /// call. The frame_id of `header` is replaced by the view's own.
  void publish(const EncodedImage& image, std_msgs::Header header);

private:
  /// A topic and what is published on it.
  struct Output
  {
    std::function<bool()> wanted;
    std::function<void(FrameView& view)> publish;
  };

  void advertise(ros::NodeHandle nh, bool depths, const std::function<void()>& on_connection);
  template <class Publisher, class Publish>
  void add(const Publisher& publisher, const Publish& publish);
  sensor_msgs::ImageConstPtr rawImage(FrameView& view);
  void publishGray(const image_transport::Publisher& publisher, FrameView& view);

  std::string name_;
  std::string frame_id_;
  std::string output_encoding_;
  std::string given_encoding_ = "bgr8";  // of the last image; what fills memory begins with this one
  bool told_ = false;                    // whether the log says that an encoding cannot be published
  bool told_gray_ = false;               // whether it says that depths have no gray
  Calibration calibration_;
  ImageMakers makers_;
  image_transport::Publisher raw_;
  std::vector<Output> outputs_;  // in the order in which they are published
};

}  // namespace robot_vision
