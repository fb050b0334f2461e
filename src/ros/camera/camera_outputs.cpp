#include "camera_outputs.hpp"

#include <image_transport/camera_common.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <exception>
#include <stdexcept>
#include <vector>

#include "core/camera/output_encoding.hpp"
#include "robot_vision/codecs/compressed_depth.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/jpeg.hpp"
#include "scene_messages.hpp"

namespace robot_vision
{
namespace
{

cv::Size sizeOf(const sensor_msgs::Image& image)
{
  return {static_cast<int>(image.width), static_cast<int>(image.height)};
}

constexpr std::size_t kMaxFrameId = 255;  // bytes
const std::string kCompressed = "image_transport/compressed";
const std::string kDepth = "image_transport/compressedDepth";

/// What a camera gives as JPEG, as it is, and the size that it has.
sensor_msgs::CompressedImage passedOn(const Frame& frame, const std_msgs::Header& header, cv::Size& size)
{
  sensor_msgs::CompressedImage compressed;
  const JpegInfo info = copyJpeg(frame.image.data, frame.image.total(), compressed.data);
  compressed.header = header;
  compressed.format = jpegFormat(info.color);
  size = info.size;
  return compressed;
}

std::vector<std::string> disabledPlugins(const ros::NodeHandle& nh, const std::string& topic)
{
  std::vector<std::string> names;
  nh.getParam(topic + "/disable_pub_plugins", names);
  return names;
}

/// The topic over all transports but these. The parameter is image_transport's, which reads it while it advertises;
/// afterwards it is as it was: the next node of this name may be another camera's.
image_transport::Publisher advertiseWithout(const std::vector<std::string>& plugins, ros::NodeHandle& nh,
                                            image_transport::ImageTransport& it, const std::string& topic,
                                            const image_transport::SubscriberStatusCallback& on_connection)
{
  const std::string parameter = topic + "/disable_pub_plugins";
  const bool is_set = nh.hasParam(parameter);
  const std::vector<std::string> before = disabledPlugins(nh, topic);
  std::vector<std::string> disabled = before;
  disabled.insert(disabled.end(), plugins.begin(), plugins.end());
  nh.setParam(parameter, disabled);
  image_transport::Publisher publisher = it.advertise(topic, 1, on_connection, on_connection);
  if (is_set)
    nh.setParam(parameter, before);
  else
    nh.deleteParam(parameter);
  return publisher;
}

/// Does one thing after the other, also if one of them fails.
class Attempts
{
public:
  template <class Work>
  void operator()(Work work)
  try
  {
    work();
  }
  catch (const std::exception&)
  {
    if (!first_) first_ = std::current_exception();
  }

  /// What the first that failed has thrown.
  void rethrow() const
  {
    if (first_) std::rethrow_exception(first_);
  }

private:
  std::exception_ptr first_;
};

}  // namespace

CameraOutputs::CameraOutputs(const ros::NodeHandle& pnh, const Params& params,
                             const std::function<void()>& on_connection)
  : name_(pnh.getNamespace()),
    frame_id_(params.frame_id),
    output_encoding_(params.output_encoding),
    calibration_(pnh, params.camera_name, params.camera_info_url),
    chosen_(!params.camera_info_url.empty()),
    it_(pnh)
{
  validateOutputEncoding(output_encoding_);
  require(shortened(frame_id_, kMaxFrameId) == frame_id_, "camera_frame_id", "'" + frame_id_ + "'",
          "a name of at most " + std::to_string(kMaxFrameId) + " printable letters");
  const auto on_image = [on_connection](const image_transport::SingleSubscriberPublisher&) { on_connection(); };
  const auto on_other = [on_connection](const ros::SingleSubscriberPublisher&) { on_connection(); };
  ros::NodeHandle nh(pnh);
  const std::string topic = nh.resolveName("image_raw");
  raw_ = advertiseWithout({kCompressed, kDepth}, nh, it_, topic, on_image);
  mono_ = advertiseWithout({kDepth}, nh, it_, nh.resolveName("image_mono"), on_image);
  const std::vector<std::string> disabled = disabledPlugins(nh, topic);
  const auto enabled = [&disabled](const std::string& plugin)  // as one would be
  { return std::find(disabled.begin(), disabled.end(), plugin) == disabled.end(); };
  if (enabled(kCompressed))
    compressed_ =
        std::make_unique<CompressedOutput>(nh, topic + "/compressed", toCompressionParams, compressMessage, on_other);
  if (output_encoding_ == "native" && enabled(kDepth))
    depth_ = std::make_unique<CompressedDepthOutput>(nh, topic + "/compressedDepth", toDepthCompressionParams,
                                                     compressDepthMessage, on_other);
  info_ = nh.advertise<sensor_msgs::CameraInfo>(image_transport::getCameraInfoTopic(topic), 1, on_other, on_other);
  truth_ = nh.advertise<GroundTruth>("ground_truth", 1, on_other, on_other);
}

bool CameraOutputs::wanted() const
{
  return raw_.getNumSubscribers() > 0 || mono_.getNumSubscribers() > 0 || (compressed_ && compressed_->wanted()) ||
         (depth_ && depth_->wanted()) || info_.getNumSubscribers() > 0 || truth_.getNumSubscribers() > 0;
}

void CameraOutputs::setModel(const CameraModel* model)
{
  model_ = model == nullptr ? nullptr : std::make_unique<sensor_msgs::CameraInfo>(toCameraInfo(*model));
  if (!model_) return;
  calibration_.setPictureSize({model->width, model->height});
  if (chosen_)
    ROS_INFO("%s: camera_info is that of camera_info_url, if it has one, else the scene's own", name_.c_str());
  else
    ROS_INFO("%s: camera_info is the scene's own, exact; camera_info_url can name another", name_.c_str());
}

void CameraOutputs::prepare(Frame& frame)
{
  const bool as_it_is = outputEncoding(output_encoding_, "bgr8") == "bgr8";
  const bool fits = as_it_is && !size_.empty() && raw_.getNumSubscribers() > 0;
  prepared_ = fits ? prepared_pool_.take(size_, "bgr8") : nullptr;
  if (prepared_) frame.image = writablePixels(*prepared_);
}

void CameraOutputs::publish(const Frame& frame, const ros::Time& stamp)
{
  std_msgs::Header header;
  header.seq = static_cast<std::uint32_t>(frame.sequence);
  header.stamp = stamp;
  header.frame_id = frame_id_;

  Attempts attempt;
  attempt([&] { publishPictures(frame, header); });
  if (frame.truth) attempt([&] { publishTruth(*frame.truth, header); });
  prepared_.reset();
  attempt.rethrow();
}

/// A JPEG is decoded for those alone who want pixels. Subscribers come and go meanwhile: each topic is asked once.
/// Nothing that fails may cost the others their message, above all not a picture its camera_info.
void CameraOutputs::publishPictures(const Frame& frame, const std_msgs::Header& header)
{
  const bool raw_wanted = raw_.getNumSubscribers() > 0;
  const bool compressed_wanted = compressed_ && compressed_->wanted();
  const bool depth_wanted = depth_ && depth_->wanted() && isDepth(outputEncoding(output_encoding_, frame.encoding));
  const bool jpeg = frame.encoding == "jpeg";
  const bool passed_on = compressed_wanted && jpeg;
  const bool pixels_wanted = raw_wanted || depth_wanted || (compressed_wanted && !jpeg);
  cv::Size size;  // empty: nobody has looked yet
  sensor_msgs::ImagePtr raw;
  Attempts attempt;
  if (pixels_wanted)
    attempt(
        [&]
        {
          raw = rawImage(frame);
          raw->header = header;
          size = sizeOf(*raw);
        });
  if (raw && raw_wanted) attempt([&] { raw_.publish(sensor_msgs::ImageConstPtr(raw)); });
  if (passed_on) attempt([&] { compressed_->passOn(passedOn(frame, header, size)); });
  const bool damaged = pixels_wanted && !raw && !passed_on;
  if (info_.getNumSubscribers() > 0 && !damaged) attempt([&] { publishInfo(frame, size, header); });
  if (raw && depth_wanted) attempt([&] { depth_->publish(raw); });
  if (raw && compressed_wanted && !jpeg) attempt([&] { compressed_->publish(raw); });
  if (mono_.getNumSubscribers() > 0) attempt([&] { size = publishMono(frame, raw, header); });
  if (!size.empty()) calibration_.setPictureSize(size);
  attempt.rethrow();
}

/// Sets `size` if it is not known yet.
void CameraOutputs::publishInfo(const Frame& frame, cv::Size& size, const std_msgs::Header& header)
{
  if (size.empty()) size = pictureSize(frame.image, frame.encoding);
  const sensor_msgs::CameraInfoPtr info = cameraInfo(size);
  info->header = header;
  info_.publish(info);
}

/// Its size.
cv::Size CameraOutputs::publishMono(const Frame& frame, const sensor_msgs::ImagePtr& raw,
                                    const std_msgs::Header& header)
{
  sensor_msgs::ImagePtr mono = raw;
  if (!mono || mono->encoding != "mono8")
  {
    mono = convert(frame, "mono8");
    mono->header = header;
  }
  mono_.publish(sensor_msgs::ImageConstPtr(mono));
  return sizeOf(*mono);
}

std::string CameraOutputs::rawEncoding(const Frame& frame)
{
  const std::string encoding = outputEncoding(output_encoding_, frame.encoding);
  if (output_encoding_ == "native" && encoding != frame.encoding && !told_)
    ROS_INFO("%s: sensor_msgs has no name for %s: it is published as %s", name_.c_str(), frame.encoding.c_str(),
             encoding.c_str());
  told_ = true;
  return encoding;
}

sensor_msgs::ImagePtr CameraOutputs::rawImage(const Frame& frame)
{
  const bool in_place = prepared_ && frame.image.data == prepared_->data.data();
  return in_place ? prepared_ : convert(frame, rawEncoding(frame));
}

sensor_msgs::ImagePtr CameraOutputs::convert(const Frame& frame, const std::string& encoding)
{
  ImageMaker& maker = encoding == "mono8" ? mono_maker_ : raw_maker_;
  const sensor_msgs::ImagePtr image = maker.make(
      [&](cv::Mat& pixels)
      {
        toEncoding(frame.image, frame.encoding, encoding, pixels);
        return encoding;
      });
  size_ = sizeOf(*image);
  return image;
}

sensor_msgs::CameraInfoPtr CameraOutputs::cameraInfo(cv::Size size)
{
  const auto width = static_cast<std::uint32_t>(size.width);
  const auto height = static_cast<std::uint32_t>(size.height);
  const bool exact = model_ && !chosen_;
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(exact ? *model_ : calibration_.info());
  const auto fits = [=](const sensor_msgs::CameraInfo& of) { return of.width == width && of.height == height; };
  const bool calibrated = info->K[0] != 0.0;
  if (calibrated && !fits(*info) && throttle_.due())
    ROS_WARN("%s: the calibration is for %ux%u, the picture has %ux%u: it is not used", name_.c_str(), info->width,
             info->height, width, height);
  if (!calibrated || !fits(*info)) *info = model_ && fits(*model_) ? *model_ : sensor_msgs::CameraInfo();
  info->width = width;
  info->height = height;
  return info;
}

void CameraOutputs::publishTruth(const SceneTruth& truth, const std_msgs::Header& header)
{
  if (truth_.getNumSubscribers() > 0) truth_.publish(toMessage(truth, header));
  if (!tf_) tf_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  tf_->sendTransform(toTransforms(truth, header));
}

}  // namespace robot_vision
