#include <robot_vision/CameraConfig.h>
#include <std_srvs/Empty.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <memory>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>

#include "factories.hpp"
#include "robot_vision/camera/capture_loop.hpp"
#include "robot_vision/common/monotonic.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/throttle.hpp"
#include "ros/camera/camera_outputs.hpp"
#include "ros/camera/capture_status.hpp"
#include "ros/camera/control_params.hpp"
#include "ros/camera/control_server.hpp"
#include "ros/camera/steady_stamps.hpp"
#include "ros/camera/usb_cam_params.hpp"
#include "ros/images/advertising_lock.hpp"
#include "ros/images/frame_statistics.hpp"
#include "ros/images/gated_nodelet.hpp"
#include "ros/images/registration.hpp"
#include "ros/params/fields.hpp"
#include "ros/params/live_params.hpp"
#include "ros/params/unknown_params.hpp"

namespace robot_vision
{
namespace
{

using std_srvs::Empty;

CaptureParams loadCaptureParams(const ros::NodeHandle& pnh)
{
  CaptureParams params;
  readFields(pnh, params);
  params.kind = sourceKind(params);
  return params;
}

CameraOutputs::Params loadOutputParams(const ros::NodeHandle& pnh, const CaptureParams& capture)
{
  CameraOutputs::Params params;
  params.views = capture.views;
  const bool has_pixel_format =
      capture.kind == SourceKind::kDevice || capture.kind == SourceKind::kKinect || capture.kind == SourceKind::kImages;
  params.depths = has_pixel_format && capture.pixel_format == "z16";
  readParam(pnh, "camera_frame_id", params.frame_id);
  readParam(pnh, "right_frame", params.right_frame);
  readParam(pnh, "second_frame_id", params.second_frame_id);
  readParam(pnh, "publish_tf", params.publish_tf);
  readParam(pnh, "camera_name", params.camera_name);
  readParam(pnh, "camera_info_url", params.camera_info_url);
  readParam(pnh, "output_encoding", params.output_encoding);
  return params;
}

}  // namespace

/// Publishes the frames of a source (see CaptureParams::source) while somebody subscribes.
class CameraNodelet : public GatedNodelet, private CaptureListener
{
public:
  using EndCallback = std::function<void(int)>;
  CameraNodelet() = default;
  explicit CameraNodelet(EndCallback on_end) : on_end_(std::move(on_end)) {}

  ~CameraNodelet() override { stop(); }

private:
  void begin() final
  {
    const AdvertisingLock advertising;
    ros::NodeHandle& pnh = getPrivateNodeHandle();
    bool keep_streaming = false;
    readParam(pnh, "always_subscribe", always_wanted_);
    readParam(pnh, "keep_streaming", keep_streaming);
    always_wanted_ = always_wanted_ || keep_streaming;
    bool suspended = false;
    readParam(pnh, "create_suspended", suspended);
    stopped_ = suspended;
    acceptUsbCamParams(pnh);
    diagnostics_ = std::make_unique<FrameDiagnostics>(getNodeHandle(), pnh, getName());
    status_ = std::make_unique<CaptureStatus>(diagnostics_->statistics());
    params_ = std::make_unique<LiveParams<CameraConfig>>(
        pnh, [this](const CameraConfig& config) { apply(config); },
        [this] {
          return controls_ ? ParamMaps{{"controls", controls_->settings()}} : ParamMaps();
        });
    const CaptureParams capture = loadCaptureParams(pnh);
    validate(capture);
    const std::vector<ControlSetting> controls = readControlSettings(pnh);
    if (capture.kind == SourceKind::kDevice)
      controls_ = std::make_unique<ControlServer>(pnh, ControlDevice(capture), controls);
    const CameraOutputs::Params published = loadOutputParams(pnh, capture);
    outputs_ = std::make_unique<CameraOutputs>(pnh, published, [this] { updateDemand(); });
    diagnostics_->statistics().countUnshared([topics = outputs_->sharedTopics()] { return droppedOf(topics); });
    reviewParams(pnh);
    CaptureListener& listener = *this;
    auto loop = std::make_unique<CaptureLoop>(capture, listener, [this](const CaptureParams& of) { return open(of); });
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      loop_ = std::move(loop);
      loop_->setPace(config_.framerate, config_.loop);
    }
    updateDemand();
    start_ = pnh.advertiseService<Empty::Request, Empty::Response>(
        "start_capture", [this](Empty::Request&, Empty::Response&) { return setStopped(false); });
    stop_ = pnh.advertiseService<Empty::Request, Empty::Response>(
        "stop_capture", [this](Empty::Request&, Empty::Response&) { return setStopped(true); });
    registration_ = std::make_unique<Registration>(pnh.getNamespace());
  }

  bool setStopped(bool stopped)
  {
    stopped_ = stopped;
    updateDemand();
    return true;
  }

  void stop() final
  {
    registration_.reset();
    gate_.close();
    start_.shutdown();
    stop_.shutdown();
    loop_.reset();  // waits for its thread, which uses all that is destroyed below
    const AdvertisingLock advertising;
    params_.reset();
    controls_.reset();
    outputs_.reset();
    status_.reset();
    diagnostics_.reset();
  }

  void apply(const CameraConfig& config)
  {
    checkFields(filled<CaptureParams>(config));
    const std::lock_guard<std::mutex> lock(mutex_);
    config_ = config;
    if (loop_) loop_->setPace(config.framerate, config.loop);
  }

  void updateDemand()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!loop_) return;
    const bool wanted = always_wanted_ || outputs_->wanted();
    loop_->setDemand(stopped_ ? Demand::kStopped : wanted ? Demand::kFrames : Demand::kIdle);
  }

  std::unique_ptr<FrameSource> open(const CaptureParams& params)
  {
    const auto open_source = [&params] { return openSource(params); };
    return controls_ ? controls_->open(open_source) : open_source();
  }

  void onOpened(const FrameSource& source) override
  {
    outputs_->setCameras(source.cameraModel(), source.secondCamera(), source.housing());
    if (!status_->opened(source.description())) return;
    NODELET_INFO("%s: %s", getName().c_str(), logLine(source.description()).c_str());
    if (!source.warning().empty()) NODELET_WARN("%s: %s", getName().c_str(), logLine(source.warning()).c_str());
  }

  WantedViews wantedViews() override { return outputs_->wantedViews(); }
  void prepare(Frame& frame) override { outputs_->prepare(frame); }

  void onFrame(const Frame& frame) override
  {
    const auto begin = FrameStatistics::Clock::now();
    const ros::Time stamp = stampOf(frame);
    diagnostics_->statistics().received(static_cast<std::uint32_t>(frame.sequence));
    outputs_->publish(frame, stamp);
    if (status_->streaming()) NODELET_INFO("%s: streaming again", getName().c_str());
    unavailable_.reset();
    diagnostics_->statistics().published(begin, stamp);
  }

  ros::Time stampOf(const Frame& frame)
  {
    const ros::Time time = toRosTime(frame.monotonic_ns);
    if (ros::Time::isSimTime()) return time;  // simulated time may start again
    const ros::Time stamp = stamps_.next(frame.monotonic_ns != 0 ? frame.monotonic_ns : monotonicNow(), time);
    const double ahead = (stamp - time).toSec();
    if (ahead > 0.001 && ahead_.due())
      NODELET_WARN("%s: the clock was set back: stamps are %.3f s ahead, and at half speed until it has caught up",
                   getName().c_str(), ahead);
    return stamp;
  }

  void onRefused(const std::string& reason) override
  {
    diagnostics_->statistics().refused(reason);
    if (refused_.due()) NODELET_ERROR("%s: refused a frame: %s", getName().c_str(), logLine(reason).c_str());
  }

  void onUnavailable(const std::string& reason) override
  {
    status_->lost(reason);
    if (unavailable_.due()) NODELET_ERROR("%s: %s; trying again", getName().c_str(), logLine(reason).c_str());
  }

  void onIdle() override
  {
    if (stopped_) return status_->stopped();
    unavailable_.reset();
    if (status_->idle()) NODELET_INFO("%s: the source is there again", getName().c_str());
  }

  void onEnd(const std::string& error) override
  {
    const bool good = error.empty();
    status_->ended(error);
    if (good)
      NODELET_INFO("%s: the source has ended", getName().c_str());
    else
      NODELET_FATAL("%s: %s", getName().c_str(), logLine(error).c_str());
    if (on_end_) on_end_(good ? 0 : 1);
  }

  EndCallback on_end_;
  bool always_wanted_ = false;
  std::atomic<bool> stopped_{false};  // by ~stop_capture or by create_suspended
  Throttle refused_;
  Throttle unavailable_;
  Throttle ahead_;
  SteadyStamps stamps_;
  std::unique_ptr<FrameDiagnostics> diagnostics_;
  std::unique_ptr<CaptureStatus> status_;
  std::unique_ptr<CameraOutputs> outputs_;
  std::unique_ptr<ControlServer> controls_;  // null unless the source is a device
  std::mutex mutex_;  // guards config_ and loop_, as connections and reconfiguring come during the setup
  CameraConfig config_;
  std::unique_ptr<CaptureLoop> loop_;
  std::unique_ptr<LiveParams<CameraConfig>> params_;
  ros::ServiceServer start_;
  ros::ServiceServer stop_;
  std::unique_ptr<Registration> registration_;
};

boost::shared_ptr<nodelet::Nodelet> makeCamera(const std::function<void(int exit_code)>& on_end)
{
  return boost::make_shared<CameraNodelet>(on_end);
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CameraNodelet, nodelet::Nodelet)
