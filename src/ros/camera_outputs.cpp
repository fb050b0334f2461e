#include "camera_outputs.hpp"

#include <boost/make_shared.hpp>
#include <stdexcept>

#include "robot_vision/encoding.hpp"
#include "scene_messages.hpp"

namespace robot_vision
{
namespace
{

/// The encoding of ~image_raw for a frame of this encoding.
std::string rawEncoding(const std::string& encoding)
{
  return encoding == "mono8" ? "mono8" : "bgr8";
}

}  // namespace

CameraOutputs::CameraOutputs(const ros::NodeHandle& pnh, const Params& params,
                             const std::function<void()>& on_connection)
  : name_(pnh.getNamespace()), frame_id_(params.frame_id), calibration_(pnh), it_(pnh)
{
  if (!calibration_.setCameraName(params.camera_name))
    throw std::invalid_argument("camera_name is '" + params.camera_name + "', must be letters, digits and _");
  if (!calibration_.validateURL(params.camera_info_url))
    throw std::invalid_argument("camera_info_url is '" + params.camera_info_url +
                                "', must be empty, file:///... or package://...");
  calibration_.loadCameraInfo(params.camera_info_url);

  const auto on_image = [on_connection](const image_transport::SingleSubscriberPublisher&) { on_connection(); };
  const auto on_other = [on_connection](const ros::SingleSubscriberPublisher&) { on_connection(); };
  raw_ = it_.advertiseCamera("image_raw", 1, on_image, on_image, on_other, on_other);
  mono_ = it_.advertise("image_mono", 1, on_image, on_image);
  ros::NodeHandle nh(pnh);
  truth_ = nh.advertise<GroundTruth>("ground_truth", 1, on_other, on_other);
}

bool CameraOutputs::wanted() const
{
  return raw_.getNumSubscribers() > 0 || mono_.getNumSubscribers() > 0 || truth_.getNumSubscribers() > 0;
}

void CameraOutputs::setModel(const CameraModel* model)
{
  model_ = model == nullptr ? nullptr : std::make_unique<sensor_msgs::CameraInfo>(toCameraInfo(*model));
}

void CameraOutputs::prepare(Frame& frame)
{
  prepared_ = size_.empty() || raw_.getNumSubscribers() == 0 ? nullptr : raw_pool_.take(size_, "bgr8");
  if (prepared_) frame.image = writablePixels(*prepared_);
}

void CameraOutputs::publish(const Frame& frame, const ros::Time& stamp)
{
  std_msgs::Header header;
  header.seq = static_cast<std::uint32_t>(frame.sequence);
  header.stamp = stamp;
  header.frame_id = frame_id_;

  if (raw_.getNumSubscribers() > 0)
  {
    const bool in_place = prepared_ && frame.image.data == prepared_->data.data();
    const sensor_msgs::ImagePtr image = in_place ? prepared_ : convert(frame, rawEncoding(frame.encoding));
    image->header = header;
    raw_.publish(image, cameraInfo(*image));
  }
  if (mono_.getNumSubscribers() > 0)
  {
    const sensor_msgs::ImagePtr image = convert(frame, "mono8");
    image->header = header;
    mono_.publish(sensor_msgs::ImageConstPtr(image));
  }
  if (frame.truth) publishTruth(*frame.truth, header);
  prepared_.reset();
}

sensor_msgs::ImagePtr CameraOutputs::convert(const Frame& frame, const std::string& encoding)
{
  const auto fill = encoding == "mono8" ? toGray : toBgr;
  ImagePool& pool = encoding == "mono8" ? mono_pool_ : raw_pool_;
  const sensor_msgs::ImagePtr guess = size_.empty() ? nullptr : pool.take(size_, encoding);
  cv::Mat pixels = guess ? writablePixels(*guess) : cv::Mat();
  fill(frame.image, frame.encoding, pixels);
  size_ = pixels.size();
  if (guess && pixels.data == guess->data.data()) return guess;
  const sensor_msgs::ImagePtr image = pool.take(pixels.size(), encoding);
  cv::Mat target = writablePixels(*image);
  pixels.copyTo(target);
  return image;
}

sensor_msgs::CameraInfoPtr CameraOutputs::cameraInfo(const sensor_msgs::Image& image)
{
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(calibration_.getCameraInfo());
  const auto fits = [&image](const sensor_msgs::CameraInfo& of)
  { return of.width == image.width && of.height == image.height; };
  const bool calibrated = info->K[0] != 0.0;
  if (calibrated && !fits(*info) && throttle_.due())
    ROS_WARN("%s: the calibration is for %ux%u, the picture has %ux%u: it is not used", name_.c_str(), info->width,
             info->height, image.width, image.height);
  if (!calibrated || !fits(*info)) *info = model_ && fits(*model_) ? *model_ : sensor_msgs::CameraInfo();
  info->width = image.width;
  info->height = image.height;
  info->header = image.header;
  return info;
}

void CameraOutputs::publishTruth(const SceneTruth& truth, const std_msgs::Header& header)
{
  if (truth_.getNumSubscribers() > 0) truth_.publish(toMessage(truth, header));
  if (!tf_) tf_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  tf_->sendTransform(toTransforms(truth, header));
}

}  // namespace robot_vision
