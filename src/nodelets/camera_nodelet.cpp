#include <nodelet/nodelet.h>
#include <robot_vision/CameraConfig.h>

#include <boost/make_shared.hpp>
#include <memory>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>

#include "factories.hpp"
#include "robot_vision/range.hpp"
#include "ros/camera_outputs.hpp"
#include "ros/capture_loop.hpp"
#include "ros/frame_statistics.hpp"
#include "ros/live_params.hpp"
#include "ros/monotonic_clock.hpp"
#include "ros/throttle.hpp"

namespace robot_vision
{
namespace
{

using diagnostic_msgs::DiagnosticStatus;

CaptureParams loadCaptureParams(const ros::NodeHandle& pnh)
{
  CaptureParams params;
  readParam(pnh, "source", params.source);
  readParam(pnh, "video_device", params.video_device);
  readParam(pnh, "image_width", params.image_width);
  readParam(pnh, "image_height", params.image_height);
  readParam(pnh, "pixel_format", params.pixel_format);
  readParam(pnh, "io_method", params.io_method);
  readParam(pnh, "framerate", params.framerate);
  readParam(pnh, "poster", params.poster);
  return params;
}

CameraOutputs::Params loadOutputParams(const ros::NodeHandle& pnh)
{
  CameraOutputs::Params params;
  readParam(pnh, "camera_frame_id", params.frame_id);
  readParam(pnh, "camera_name", params.camera_name);
  readParam(pnh, "camera_info_url", params.camera_info_url);
  return params;
}

}  // namespace

/// Publishes the frames of a source (see CaptureParams::source) while somebody subscribes.
class CameraNodelet : public nodelet::Nodelet, private CaptureListener
{
public:
  using EndCallback = std::function<void(int)>;
  CameraNodelet() = default;
  explicit CameraNodelet(EndCallback on_end) : on_end_(std::move(on_end)) {}

  ~CameraNodelet() override { stop(); }

private:
  void onInit() override
  try
  {
    const ros::NodeHandle& pnh = getPrivateNodeHandle();
    readParam(pnh, "always_subscribe", always_subscribe_);
    diagnostics_ = std::make_unique<FrameDiagnostics>(getNodeHandle(), pnh, getName());
    params_ = std::make_unique<LiveParams<CameraConfig>>(pnh, [this](const CameraConfig& config) { apply(config); });
    const CaptureParams capture = loadCaptureParams(pnh);
    validate(capture);
    outputs_ = std::make_unique<CameraOutputs>(pnh, loadOutputParams(pnh), [this] { updateWanted(); });
    CaptureListener& listener = *this;
    auto loop = std::make_unique<CaptureLoop>(capture, listener);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      loop_ = std::move(loop);
      loop_->setPace(config_.framerate, config_.loop);
    }
    updateWanted();
  }
  catch (const std::exception& e)
  {
    NODELET_FATAL("%s: %s", getName().c_str(), e.what());
    stop();  // the loader takes the callback queues away before the nodelet
    throw;   // the loader then reports failure instead of keeping a dead nodelet
  }

  void stop()
  {
    std::unique_ptr<CaptureLoop> loop;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      loop.swap(loop_);  // connections no longer find it
    }
    loop.reset();  // waits for its thread, which uses all the others
    params_.reset();
    outputs_.reset();
    diagnostics_.reset();
  }

  void apply(const CameraConfig& config)
  {
    requireRange("framerate", config.framerate, 0.0, 1000.0);
    const std::lock_guard<std::mutex> lock(mutex_);
    config_ = config;
    if (loop_) loop_->setPace(config.framerate, config.loop);
  }

  void updateWanted()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (loop_) loop_->setWanted(always_subscribe_ || outputs_->wanted());
  }

  void onOpened(const FrameSource& source) override
  {
    outputs_->setModel(source.cameraModel());
    diagnostics_->statistics().resumed();
    const bool news = description_ != source.description();
    description_ = source.description();
    diagnostics_->statistics().setState(DiagnosticStatus::OK, description_);
    if (!news) return;
    NODELET_INFO("%s: %s", getName().c_str(), description_.c_str());
    if (!source.warning().empty()) NODELET_WARN("%s: %s", getName().c_str(), source.warning().c_str());
  }

  void prepare(Frame& frame) override { outputs_->prepare(frame); }

  void onFrame(const Frame& frame) override
  {
    const auto begin = FrameStatistics::Clock::now();
    const ros::Time stamp = toRosTime(frame.monotonic_ns);
    diagnostics_->statistics().received(static_cast<std::uint32_t>(frame.sequence));
    outputs_->publish(frame, stamp);
    diagnostics_->statistics().setState(DiagnosticStatus::OK, description_);
    if (lost_) NODELET_INFO("%s: streaming again", getName().c_str());
    lost_ = false;
    unavailable_.reset();
    diagnostics_->statistics().published(begin, stamp);
  }

  void onRefused(const std::string& why) override
  {
    diagnostics_->statistics().refused(why);
    if (refused_.due()) NODELET_ERROR("%s: refused a frame: %s", getName().c_str(), why.c_str());
  }

  void onUnavailable(const std::string& why) override
  {
    diagnostics_->statistics().setState(DiagnosticStatus::ERROR, why);
    lost_ = true;
    if (unavailable_.due()) NODELET_ERROR("%s: %s; trying again every second", getName().c_str(), why.c_str());
  }

  void onIdle() override { diagnostics_->statistics().setIdle(); }

  void onEnd(const std::string& error) override
  {
    const bool good = error.empty();
    diagnostics_->statistics().setState(good ? DiagnosticStatus::OK : DiagnosticStatus::ERROR,
                                        good ? "the source has ended" : error);
    if (good)
      NODELET_INFO("%s: the source has ended", getName().c_str());
    else
      NODELET_FATAL("%s: %s", getName().c_str(), error.c_str());
    if (on_end_) on_end_(good ? 0 : 1);
  }

  EndCallback on_end_;
  bool always_subscribe_ = false;
  Throttle refused_;
  Throttle unavailable_;
  std::string description_;
  bool lost_ = false;  // since the last frame
  std::unique_ptr<FrameDiagnostics> diagnostics_;
  std::unique_ptr<CameraOutputs> outputs_;
  std::mutex mutex_;  // guards config_ and loop_ against connections and reconfiguring while they are being set up
  CameraConfig config_;
  std::unique_ptr<CaptureLoop> loop_;
  std::unique_ptr<LiveParams<CameraConfig>> params_;
};

boost::shared_ptr<nodelet::Nodelet> makeCamera(const std::function<void(int exit_code)>& on_end)
{
  return boost::make_shared<CameraNodelet>(on_end);
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CameraNodelet, nodelet::Nodelet)
