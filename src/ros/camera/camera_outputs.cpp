#include "camera_outputs.hpp"

#include <robot_vision/GroundTruth.h>

#include <algorithm>
#include <exception>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/common/range.hpp"
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

std::string ownFrame(const std::string& camera_name, const std::string& view)
{
  return camera_name + "_" + view + "_optical_frame";
}

/// The parameters of a view of this name. With one view, they are those of the camera.
ViewOutputs::Params paramsOf(const std::string& view, bool is_first, const CameraOutputs::Params& camera)
{
  const std::string name = view.empty() ? camera.camera_name : camera.camera_name + "_" + view;
  const bool same = is_first || (view == "right" && camera.right_frame == "left");
  return {same ? camera.frame_id : ownFrame(camera.camera_name, view), name, camera.output_encoding,
          camera.camera_info_url, view == "depth" || (view.empty() && camera.depths)};
}

/// Two views cannot have the same file.
void requireTwoFiles(const CameraOutputs::Params& params, const std::vector<std::string>& views)
{
  const std::string& url = params.camera_info_url;
  require(url.empty() || url.find(kName) != std::string::npos, "camera_info_url", "'" + url + "'",
          "empty or have " + kName + " in it, which becomes " + params.camera_name + "_" + views.front() + " and " +
              params.camera_name + "_" + views.back());
}

}  // namespace

CameraOutputs::CameraOutputs(const ros::NodeHandle& pnh, const Params& params,
                             const std::function<void()>& on_connection)
  : stereo_(params.views == "stereo")
{
  checkField("right_frame", params.right_frame, OneOf{"left or own", "'"});
  const std::vector<std::string> names = viewNames(params.views);
  if (names.size() > 1)
  {
    requireTwoFiles(params, names);
    second_frame_ = ownFrame(params.camera_name, names.back());
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

WantedViews CameraOutputs::wantedViews() const
{
  if (views_.size() == 1) return {true, false};
  return {views_.front()->wanted(), views_.back()->wanted()};
}

void CameraOutputs::setCameras(const CameraModel* first, const SecondCamera* second)
{
  using Info = sensor_msgs::CameraInfo;
  views_.front()->setModel(first == nullptr ? nullptr : std::make_unique<Info>(toCameraInfo(*first)));
  if (views_.size() == 1) return;
  const bool is_pair = stereo_ && first != nullptr && second != nullptr;
  std::unique_ptr<Info> info;
  if (second != nullptr)
    info = std::make_unique<Info>(is_pair ? toRightCameraInfo(*first, *second) : toCameraInfo(second->model));
  views_.back()->setModel(std::move(info));
  if (second != nullptr) broadcastSecond(second->pose);
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
  if (frame.truth) broadcast(*frame.truth, header);
  if (error) std::rethrow_exception(error);
}

void CameraOutputs::broadcast(const SceneTruth& truth, const std_msgs::Header& header)
{
  if (!tf_) tf_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  tf_->sendTransform(toTransforms(truth, header));
}

/// Where the second camera's optical frame is in the first's.
void CameraOutputs::broadcastSecond(const cv::Affine3d& pose)
{
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = views_.front()->frameId();
  if (!static_tf_) static_tf_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
  static_tf_->sendTransform(toTransform(pose, header, second_frame_));
}

}  // namespace robot_vision
