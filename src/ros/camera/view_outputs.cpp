#include "view_outputs.hpp"

#include <image_transport/camera_common.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "robot_vision/camera/output_encoding.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/transports/compression.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxFrameId = 255;  // bytes
const std::string kPluginPrefix = "image_transport/";
const std::string kCompressed = "compressed";
const std::string kDepth = "compressedDepth";
const std::string kTheora = "theora";
/// Stands before what is not the user's in a list of plugins, as a node that is killed leaves that behind.
const std::string kOwnFromHere = "robot_vision/own_from_here";

std::string parameterOf(const std::string& topic)
{
  return topic + "/disable_pub_plugins";
}

/// The plugins that the user has disabled. `has_left`: whether a node that was killed has left others in the list.
std::vector<std::string> disabledPlugins(const ros::NodeHandle& nh, const std::string& topic, bool* has_left = nullptr)
{
  std::vector<std::string> names;
  nh.getParam(parameterOf(topic), names);
  const auto own = std::find(names.begin(), names.end(), kOwnFromHere);
  if (has_left) *has_left = own != names.end();
  names.erase(own, names.end());
  return names;
}

/// Advertises the topic over all transports but these. image_transport reads the parameter while it advertises.
/// Afterwards the parameter is as it was, as the next node of this name may be that of another camera.
image_transport::Publisher advertiseWithout(const std::vector<std::string>& transports, ros::NodeHandle& nh,
                                            const std::string& topic,
                                            const image_transport::SubscriberStatusCallback& on_connection)
{
  const std::string parameter = parameterOf(topic);
  XmlRpc::XmlRpcValue before;  // also one that is no list
  const bool is_set = nh.getParam(parameter, before);
  bool has_left = false;
  const std::vector<std::string> of_user = disabledPlugins(nh, topic, &has_left);
  std::vector<std::string> disabled = of_user;
  disabled.push_back(kOwnFromHere);
  for (const std::string& transport : transports)
    disabled.push_back(kPluginPrefix + transport);
  nh.setParam(parameter, disabled);
  const auto publisher = image_transport::ImageTransport(nh).advertise(topic, 1, on_connection, on_connection);
  if (!is_set || (has_left && of_user.empty()))
    nh.deleteParam(parameter);
  else if (has_left)
    nh.setParam(parameter, of_user);
  else
    nh.setParam(parameter, before);
  return publisher;
}

/// The topic of a transport that is no plugin here, or null if the user has disabled it as if it were one.
template <class Output, class... Arguments>
std::shared_ptr<Output> advertiseEncoded(ros::NodeHandle& nh, const std::string& topic, const std::string& transport,
                                         const Arguments&... arguments)
{
  const std::vector<std::string> disabled = disabledPlugins(nh, topic);
  if (std::find(disabled.begin(), disabled.end(), kPluginPrefix + transport) != disabled.end()) return nullptr;
  return std::make_shared<Output>(nh, topic + "/" + transport, arguments...);
}

template <class Publisher>
bool hasSubscribers(const Publisher& publisher)
{
  return publisher.getNumSubscribers() > 0;
}

template <class Config, class Params>
bool hasSubscribers(const std::shared_ptr<EncodedOutput<Config, Params>>& output)
{
  return output && output->wanted();
}

}  // namespace

ViewOutputs::ViewOutputs(const ros::NodeHandle& nh, const Params& params, const std::function<void()>& on_connection)
  : name_(nh.getNamespace()),
    frame_id_(params.frame_id),
    output_encoding_(params.output_encoding),
    calibration_(nh, params.camera_name, params.camera_info_url)
{
  validateOutputEncoding(output_encoding_);
  require(shortened(frame_id_, kMaxFrameId) == frame_id_, params.frame_parameter, "'" + frame_id_ + "'",
          "a name of at most " + std::to_string(kMaxFrameId) + " printable letters");
  advertise(nh, params.depths, on_connection);
}

/// Adds a topic, to be published after those before.
template <class Publisher, class Publish>
void ViewOutputs::add(const Publisher& publisher, const Publish& publish)
{
  outputs_.push_back({[publisher] { return hasSubscribers(publisher); },
                      [publisher, publish](FrameView& view) { publish(publisher, view); }});
}

void ViewOutputs::advertise(ros::NodeHandle nh, bool depths, const std::function<void()>& on_connection)
{
  const auto on_image = [on_connection](const image_transport::SingleSubscriberPublisher&) { on_connection(); };
  const auto on_other = [on_connection](const ros::SingleSubscriberPublisher&) { on_connection(); };
  const std::string topic = nh.resolveName("image_raw");
  std::vector<std::string> not_by_plugins = {kCompressed, kDepth};
  if (depths) not_by_plugins.push_back(kTheora);
  raw_ = advertiseWithout(not_by_plugins, nh, topic, on_image);
  makers_.addTopic(SharedTopic::of(raw_.getTopic()));
  // What is not advertised of these has no subscribers, and is never published.
  image_transport::Publisher mono;
  std::shared_ptr<CompressedOutput> compressed;
  std::shared_ptr<CompressedDepthOutput> of_depth;
  if (!depths)
  {
    mono = advertiseWithout({kDepth}, nh, nh.resolveName("image_mono"), on_image);
    makers_.addTopic(SharedTopic::of(mono.getTopic()), "mono8");
    compressed =
        advertiseEncoded<CompressedOutput>(nh, topic, kCompressed, toCompressionParams, compressMessage, on_other);
  }
  if (depths || output_encoding_ == "native")
    of_depth = advertiseEncoded<CompressedDepthOutput>(nh, topic, kDepth, toDepthCompressionParams,
                                                       compressDepthMessage, on_other);
  const std::string info_topic = image_transport::getCameraInfoTopic(topic);
  const auto info = nh.advertise<sensor_msgs::CameraInfo>(info_topic, 1, on_other, on_other);

  // camera_info follows as soon as it is known whether a JPEG is damaged, and waits neither for what is compressed nor
  // for a second conversion.
  add(raw_, [this](const auto& publisher, FrameView& view) { publisher.publish(rawImage(view)); });
  add(compressed,
      [](const auto& output, FrameView& view)
      {
        if (view.isJpeg()) output->passOn(view.jpeg());
      });
  add(info, [this](const auto& publisher, FrameView& view)
      { publisher.publish(calibration_.info(view.size(), view.header())); });
  add(of_depth,
      [](const auto& output, FrameView& view)
      {
        if (isDepth(view.rawEncoding())) output->publish(view.raw());
      });
  add(compressed,
      [](const auto& output, FrameView& view)
      {
        if (!view.isJpeg()) output->publish(view.raw());
      });
  add(mono, [this](const auto& publisher, FrameView& view) { publishGray(publisher, view); });
}

bool ViewOutputs::wanted() const
{
  return std::any_of(outputs_.begin(), outputs_.end(), [](const Output& output) { return output.wanted(); });
}

void ViewOutputs::prepare(cv::Mat& image)
{
  const bool as_it_is = outputEncoding(output_encoding_, given_encoding_) == given_encoding_;
  if (as_it_is && hasSubscribers(raw_)) image = makers_.of(given_encoding_, true).lend();
}

void ViewOutputs::publish(const EncodedImage& image, std_msgs::Header header)
{
  given_encoding_ = image.encoding;
  header.frame_id = frame_id_;
  FrameView view(image, header, outputEncoding(output_encoding_, image.encoding), makers_);
  std::exception_ptr error;
  for (const Output& output : outputs_)
    try
    {
      if (output.wanted()) output.publish(view);
    }
    catch (const std::exception&)  // which must cost no other topic its message
    {
      if (!error) error = std::current_exception();
    }
  if (!view.knownSize().empty()) calibration_.setImageSize(view.knownSize());
  if (error) std::rethrow_exception(error);
}

sensor_msgs::ImageConstPtr ViewOutputs::rawImage(FrameView& view)
{
  const std::string& given = view.givenEncoding();
  if (output_encoding_ == "native" && view.rawEncoding() != given && !told_)
    ROS_INFO("%s: sensor_msgs has no name for %s: it is published as %s", name_.c_str(), given.c_str(),
             view.rawEncoding().c_str());
  told_ = true;
  return view.raw();
}

void ViewOutputs::publishGray(const image_transport::Publisher& publisher, FrameView& view)
{
  if (!isDepthEncoding(view.rawEncoding())) return publisher.publish(view.image("mono8"));
  if (!std::exchange(told_gray_, true))
    ROS_INFO("%s: the camera gives depths: there is no gray for image_mono", name_.c_str());
}

}  // namespace robot_vision
