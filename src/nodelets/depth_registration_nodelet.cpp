#include <robot_vision/DepthRegistrationConfig.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <string>

#include "factories.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/throttle.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "ros/depth/frame_transforms.hpp"
#include "ros/depth/registered_points.hpp"
#include "ros/depth/registration_cameras.hpp"
#include "ros/depth/registration_input.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/params/fields.hpp"
#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr std::chrono::seconds kTransformGrace(1);  // for the first transforms to come
constexpr int kFramesPerLook = 10;                  // of which one is looked at for odd depths

}  // namespace

/// Publishes the depth images of a depth camera as a color camera beside it would see them, and clouds of their points.
class DepthRegistrationWork
{
public:
  DepthRegistrationWork(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : name_(pnh.getNamespace()),
      topics_(nh),
      image_(nh.resolveName("depth_registered/image_raw", /*remap=*/false)),
      info_(nh.resolveName("depth_registered/camera_info", /*remap=*/false)),
      cloud_(nh.resolveName("depth_registered/points", /*remap=*/false)),
      transforms_(nh),
      points_(nh, pnh, topics_)
  {
    readParam(pnh, "always_subscribe", always_subscribe_);
  }

  void configure(const DepthRegistrationConfig& config)
  {
    cameras_.configure({filled<RegistrationParams>(config), config.depth_rectified, config.color_rectified});
    color_ = config.color;
  }

  void advertise(LazyOutputs& outputs)
  {
    outputs_ = &outputs;
    outputs.advertiseImages(image_);
    pool_.addTopic(outputs.shared(image_));
    outputs.advertise<sensor_msgs::CameraInfo>(info_);
    outputs.advertise<sensor_msgs::PointCloud2>(cloud_);
    points_.setPublish([this](const sensor_msgs::PointCloud2Ptr& cloud) { outputs_->publish(cloud_, cloud); });
  }

  void listen(bool listens)
  {
    transforms_.listen(listens);
    since_ = std::chrono::steady_clock::now();
    frames_ = 0;
    points_.listen(listens && needsColors());
  }

  /// Returns whether anything was published.
  bool process(const RegistrationFrame& frame, LazyOutputs& outputs)
  {
    const bool info = outputs.isWanted(info_), image = outputs.isWanted(image_), points = outputs.isWanted(cloud_);
    points_.listen(needsColors());
    if (!prepare(frame)) return false;
    std_msgs::Header header = frame.depth->header;
    header.frame_id = frame.color_info->header.frame_id;
    if (info) publishInfo(*frame.color_info, header, outputs);
    if (!image && !points) return info;
    const sensor_msgs::ImagePtr seen = registered(frame, header);
    if (image) outputs.publishImage(image_, seen);
    const bool is_counted = info || image;
    return (points && points_.add(seen, cameras_.points(), *frame.statistics, !is_counted)) || is_counted;
  }

private:
  bool needsColors() const { return color_ && (always_subscribe_ || outputs_->isWanted(cloud_)); }

  /// Whether the frame can be registered; not as long as its transform may be on its way. Throws std::invalid_argument
  /// to refuse it.
  bool prepare(const RegistrationFrame& frame)
  {
    checkDepth(frame.image, frame.depth->encoding);
    const std::string &from = frame.depth->header.frame_id, &to = frame.color_info->header.frame_id;
    const auto depth_to_color = transforms_.find(to, from);
    if (!depth_to_color && std::chrono::steady_clock::now() - since_ < kTransformGrace) return false;
    if (!depth_to_color)
      throw std::invalid_argument("no transform from its frame '" + printable(from) + "' to '" + printable(to) +
                                  "' of " + topics_.color_info + ", expected on /tf_static or /tf");
    cameras_.set(frame, topics_, *depth_to_color);
    if (frames_++ % kFramesPerLook == 0) lookAt(frame);
    return true;
  }

  sensor_msgs::ImagePtr registered(const RegistrationFrame& frame, const std_msgs::Header& header)
  {
    const std::string& encoding = frame.depth->encoding;
    const sensor_msgs::ImagePtr message = pool_.take(cameras_.colorSize(), DepthRegistration::outputEncoding(encoding));
    cv::Mat pixels = writablePixels(*message);
    cameras_.registration().apply(frame.image, encoding, pixels);
    message->header = header;
    return message;
  }

  /// Warns of depths that are none, or probably in another unit.
  void lookAt(const RegistrationFrame& frame)
  {
    const std::string odd = oddDepth(frame.image, frame.depth->encoding);
    if (!odd.empty() && throttle_.due())
      ROS_WARN("%s: %s: %s", name_.c_str(), topics_.depth_image.c_str(), odd.c_str());
  }

  void publishInfo(const sensor_msgs::CameraInfo& color_info, const std_msgs::Header& header, LazyOutputs& outputs)
  {
    const auto info = boost::make_shared<sensor_msgs::CameraInfo>(color_info);
    info->header = header;
    outputs.publish(info_, info);
  }

  std::string name_;
  RegistrationTopics topics_;
  std::string image_, info_, cloud_;  // topics of the results
  bool always_subscribe_ = false;     // also to the color images
  bool color_ = true;                 // whether points have colors
  LazyOutputs* outputs_ = nullptr;
  RegistrationCameras cameras_;
  ImagePool pool_;
  std::chrono::steady_clock::time_point since_;  // when it began to listen
  int frames_ = 0;                               // since then
  Throttle throttle_;
  FrameTransforms transforms_;
  RegisteredPoints points_;
};

using DepthRegistrationNodelet = ImageNodelet<DepthRegistrationConfig, DepthRegistrationWork, RegistrationInput>;

boost::shared_ptr<nodelet::Nodelet> makeDepthRegistration()
{
  return boost::make_shared<DepthRegistrationNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::DepthRegistrationNodelet, nodelet::Nodelet)
