#include "camera_outputs.hpp"

#include <robot_vision/GroundTruth.h>

#include <algorithm>
#include <array>
#include <exception>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/images/advertising_lock.hpp"
#include "scene_messages.hpp"

namespace robot_vision
{
namespace
{

const std::string kName = "${NAME}";  // in camera_info_url, see calibrationPath()

/// The names of the views, which are their namespaces; an empty one if there is only one view.
std::vector<std::string> viewNames(const std::string& views)
{
  if (views == "stereo") return {"left", "right"};
  if (views == "rgbd") return {"rgb", "depth"};
  return {""};
}

/// The optical frame of the second camera, of this view.
std::string secondFrame(const CameraOutputs::Params& camera, const std::string& view)
{
  return camera.second_frame_id.empty() ? camera.camera_name + "_" + view + "_optical_frame" : camera.second_frame_id;
}

/// The parameters of a view of this name. With one view, they are those of the camera.
ViewOutputs::Params paramsOf(const std::string& view, bool is_first, const CameraOutputs::Params& camera)
{
  const std::string name = view.empty() ? camera.camera_name : camera.camera_name + "_" + view;
  const bool same = is_first || (view == "right" && camera.right_frame == "left");
  return {same ? camera.frame_id : secondFrame(camera, view),
          name,
          camera.output_encoding,
          camera.camera_info_url,
          view == "depth" || (view.empty() && camera.depths),
          same ? "camera_frame_id" : "second_frame_id"};
}

/// Two views cannot have the same file.
void requireTwoFiles(const CameraOutputs::Params& params, const std::vector<std::string>& views)
{
  const std::string& url = params.camera_info_url;
  require(url.empty() || url.find(kName) != std::string::npos, "camera_info_url", "'" + url + "'",
          "empty or have " + kName + " in it, which becomes " + params.camera_name + "_" + views.front() + " and " +
              params.camera_name + "_" + views.back());
}

/// A broadcaster of transforms, made while frames flow.
template <class Broadcaster>
std::unique_ptr<Broadcaster> advertised()
{
  const AdvertisingLock advertising;
  return std::make_unique<Broadcaster>();
}

/// The transforms from a frame to that of a camera with z up and x forward, and from there to its optical frame.
std::array<geometry_msgs::TransformStamped, 2> mountingOf(const cv::Affine3d& optical_pose,
                                                          const std_msgs::Header& header, const std::string& camera,
                                                          const std::string& optical_frame)
{
  const cv::Affine3d optical(cv::Matx33d(0, 0, 1, -1, 0, 0, 0, -1, 0));  // REP 103
  std_msgs::Header of_camera = header;
  of_camera.frame_id = camera + "_frame";
  return {toTransform(optical_pose * optical.inv(), header, of_camera.frame_id),
          toTransform(optical, of_camera, optical_frame)};
}

}  // namespace

CameraOutputs::CameraOutputs(const ros::NodeHandle& pnh, const Params& params,
                             const std::function<void()>& on_connection)
  : params_(params)
{
  checkField("right_frame", params.right_frame, OneOf{"left or own", "'"});
  const std::vector<std::string> names = viewNames(params.views);
  if (names.size() > 1)
  {
    requireTwoFiles(params, names);
    second_frame_ = secondFrame(params, names.back());
  }
  for (const std::string& name : names)
  {
    const ros::NodeHandle nh = name.empty() ? pnh : ros::NodeHandle(pnh, name);
    views_.push_back(std::make_unique<ViewOutputs>(nh, paramsOf(name, views_.empty(), params), on_connection));
  }
  const auto on_truth = [on_connection](const ros::SingleSubscriberPublisher&) { on_connection(); };
  truth_ = ros::NodeHandle(pnh).advertise<GroundTruth>("ground_truth", 1, on_truth, on_truth);
}

bool CameraOutputs::wanted() const
{
  const auto is_wanted = [](const std::unique_ptr<ViewOutputs>& view) { return view->wanted(); };
  return truth_.getNumSubscribers() > 0 || std::any_of(views_.begin(), views_.end(), is_wanted);
}

std::vector<std::shared_ptr<SharedTopic>> CameraOutputs::sharedTopics() const
{
  std::vector<std::shared_ptr<SharedTopic>> all;
  for (const std::unique_ptr<ViewOutputs>& view : views_)
    all.insert(all.end(), view->sharedTopics().begin(), view->sharedTopics().end());
  return all;
}

WantedViews CameraOutputs::wantedViews() const
{
  if (views_.size() == 1) return {true, false};
  return {views_.front()->wanted(), views_.back()->wanted()};
}

void CameraOutputs::setCameras(const CameraModel* first, const SecondCamera* second, const Housing* housing)
{
  using Info = sensor_msgs::CameraInfo;
  const bool exact = housing == nullptr;
  views_.front()->setModel(first == nullptr ? nullptr : std::make_unique<Info>(toCameraInfo(*first)), exact);
  if (views_.size() == 1) return;
  const bool is_pair = params_.views == "stereo" && first != nullptr && second != nullptr;
  std::unique_ptr<Info> info;
  if (second != nullptr)
    info = std::make_unique<Info>(is_pair ? toRightCameraInfo(*first, *second) : toCameraInfo(second->model));
  views_.back()->setModel(std::move(info), exact);
  if (second != nullptr && params_.publish_tf) broadcastSecond(second->pose, housing);
}

void CameraOutputs::prepare(Frame& frame)
{
  views_.front()->prepare(frame.image);
  if (views_.size() > 1) views_.back()->prepare(frame.second.pixels);
}

void CameraOutputs::publish(const Frame& frame, const ros::Time& stamp)
{
  std_msgs::Header header;
  header.seq = static_cast<std::uint32_t>(frame.sequence);
  header.stamp = stamp;
  header.frame_id = views_.front()->frameId();
  std::exception_ptr error;
  const auto publish_view = [&](ViewOutputs& view, const EncodedImage& image)
  {
    try
    {
      view.publish(image, header);
    }
    catch (const std::exception&)  // which must not keep the other view from being published
    {
      if (!error) error = std::current_exception();
    }
  };
  if (frame.wanted.first) publish_view(*views_.front(), {frame.image, frame.encoding});
  if (frame.wanted.second && views_.size() > 1) publish_view(*views_.back(), frame.second);
  if (frame.truth && truth_.getNumSubscribers() > 0) truth_.publish(toMessage(*frame.truth, header));
  if (frame.truth && params_.publish_tf) broadcast(*frame.truth, header);
  if (error) std::rethrow_exception(error);
}

void CameraOutputs::broadcast(const SceneTruth& truth, const std_msgs::Header& header)
{
  if (!tf_) tf_ = advertised<tf2_ros::TransformBroadcaster>();
  tf_->sendTransform(toTransforms(truth, header));
}

/// Where the second view's optical frame is in the first's, or where both are in their housing.
void CameraOutputs::broadcastSecond(const cv::Affine3d& pose, const Housing* housing)
{
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = views_.front()->frameId();
  std::vector<geometry_msgs::TransformStamped> transforms;
  if (housing == nullptr)
    transforms.push_back(toTransform(pose, header, second_frame_));
  else
  {
    const std::vector<std::string> names = viewNames(params_.views);
    header.frame_id = params_.camera_name + "_link";
    for (const bool is_first : {true, false})
    {
      const std::string camera = params_.camera_name + "_" + (is_first ? names.front() : names.back());
      const ViewOutputs& view = is_first ? *views_.front() : *views_.back();
      const cv::Affine3d in_housing = is_first ? housing->first_camera : housing->first_camera * pose;
      for (const auto& transform : mountingOf(in_housing, header, camera, view.frameId()))
        transforms.push_back(transform);
    }
  }
  if (!static_tf_) static_tf_ = advertised<tf2_ros::StaticTransformBroadcaster>();
  static_tf_->sendTransform(transforms);
}

}  // namespace robot_vision
