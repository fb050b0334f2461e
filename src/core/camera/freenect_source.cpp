#include "freenect_source.hpp"

#include <utility>

#include "robot_vision/common/monotonic.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr std::chrono::milliseconds kReadTimeout{100};
constexpr std::chrono::milliseconds kEventTimeout{50};  // after which the thread looks whether it is to end
const cv::Size kDepthSize(kKinectDepthWidth, kKinectDepthHeight);

const cv::Size kInfraredSize(640, 488);

bool isInfrared(const std::string& encoding)
{
  return encoding == "mono8" || encoding == "mono10";
}

}  // namespace

FreenectSource::Gives FreenectSource::givesFor(const CaptureParams& params)
{
  const bool both = params.views == "rgbd", depth = params.pixel_format == "z16";
  return {both || !depth, both || depth};
}

/// All names of colors mean the same but that of the sensor's pattern: the Kinect has no others.
FreenectSource::Mode FreenectSource::modeFor(const CaptureParams& params)
{
  const std::string& wanted = params.pixel_format;
  Mode mode{FREENECT_VIDEO_RGB, FREENECT_RESOLUTION_MEDIUM, {640, 480}, "rgb8", 30};
  if (wanted == "bayer_grbg8")
    mode = {FREENECT_VIDEO_BAYER, FREENECT_RESOLUTION_MEDIUM, {640, 480}, "bayer_grbg8", 30};
  else if (wanted == "grey")
    mode = {FREENECT_VIDEO_IR_8BIT, FREENECT_RESOLUTION_MEDIUM, kInfraredSize, "mono8", 30};
  else if (wanted == "y10" || wanted == "y10b")
    mode = {FREENECT_VIDEO_IR_10BIT, FREENECT_RESOLUTION_MEDIUM, kInfraredSize, "mono10", 30};
  if (params.image_width <= 640 || !givesFor(params).color) return mode;
  mode.resolution = FREENECT_RESOLUTION_HIGH;
  mode.size = {1280, 1024};
  mode.rate = 10;
  return mode;
}

FreenectSource::FreenectSource(std::shared_ptr<const FreenectLibrary> library, const CaptureParams& params)
  : name_(sourceName(params)),
    gives_(givesFor(params)),
    mode_(modeFor(params)),
    frames_(mode_.size, matType(mode_.encoding), kDepthSize),
    device_(std::move(library), name_, [this](KinectCamera camera, std::uint32_t ticks) { onImage(camera, ticks); }),
    optics_(device_.optics()),
    depths_(kinectDepths(optics_)),
    color_(kinectColorCamera(mode_.size)),
    depth_{kinectDepthCamera(optics_), kinectDepthPose()},
    housing_(kinectHousing())
{
  const cv::Size asked(params.image_width, params.image_height), given = gives_.color ? mode_.size : kDepthSize;
  const bool usual = given == kInfraredSize && asked == kDepthSize;
  if (asked != given && !usual) warning_ = name_ + ": gives " + toText(given) + " instead of " + toText(asked);
}

FreenectSource::~FreenectSource()
{
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

ReadResult FreenectSource::read(Frame& frame)
{
  const bool all = !frame.wanted.first && !frame.wanted.second;  // somebody wants frames all the same
  const bool both = gives_.color && gives_.depth;
  frames_.want(gives_.color && (!both || all || frame.wanted.first),
               gives_.depth && (!both || all || frame.wanted.second));
  if (!thread_.joinable()) thread_ = std::thread(&FreenectSource::run, this);
  KinectFrame taken;
  if (!frames_.take(kReadTimeout, taken)) return ReadResult::kTimeout;
  if (!taken.depth.empty()) toKinectDepth(taken.depth, depths_, gives_.color ? frame.second.pixels : frame.image);
  (gives_.color ? frame.second.encoding : frame.encoding) = "16UC1";
  if (gives_.color)
  {
    frame.image = taken.color;
    frame.encoding = mode_.encoding;
    // What has been wanted since this frame was put together comes with the next one.
    frame.wanted = {frame.wanted.first && !taken.color.empty(), frame.wanted.second && !taken.depth.empty()};
  }
  frame.sequence = taken.sequence;
  frame.monotonic_ns = taken.monotonic_ns;
  return ReadResult::kFrame;
}

void FreenectSource::run()
{
  try
  {
    while (!stop_)
    {
      startWanted();
      device_.processEvents(kEventTimeout);
    }
  }
  catch (const std::exception& e)
  {
    frames_.end(e.what());
  }
}

/// A camera that has been started goes on: starting takes a moment, in which the other one may lose images.
void FreenectSource::startWanted()
{
  if (!color_runs_ && frames_.wanted(KinectCamera::kColor))
  {
    device_.startVideo(mode_.resolution, mode_.format, frames_.memory(KinectCamera::kColor));
    color_runs_ = true;
  }
  if (!depth_runs_ && frames_.wanted(KinectCamera::kDepth))
  {
    device_.startDepth(frames_.memory(KinectCamera::kDepth));
    depth_runs_ = true;
  }
}

void FreenectSource::onImage(KinectCamera camera, std::uint32_t ticks)
{
  frames_.arrived(camera, ticks, monotonicNow());
  device_.setMemory(camera, frames_.memory(camera));
}

double FreenectSource::period() const
{
  return 1.0 / mode_.rate;
}

std::string FreenectSource::description() const
{
  const std::string color =
      gives_.color ? toText(mode_.size) + (isInfrared(mode_.encoding) ? " infrared" : " color") : "";
  const std::string depth = gives_.depth ? toText(kDepthSize) + " depth" : "";
  return color + (color.empty() || depth.empty() ? "" : " and ") + depth + " at " + std::to_string(mode_.rate) +
         " Hz from the Kinect " + name_;
}

/// Nobody has measured which pixels the infrared camera's images have, which are a little higher.
const CameraModel* FreenectSource::cameraModel() const
{
  if (!gives_.color) return &depth_.model;
  return isInfrared(mode_.encoding) ? nullptr : &color_;
}

std::unique_ptr<FrameSource> openFreenect(const CaptureParams& params)
{
  std::shared_ptr<const FreenectLibrary> library;
  try
  {
    library = loadFreenect();
  }
  catch (const std::runtime_error& e)
  {
    throw SourceUnavailable(sourceName(params) + ": " + e.what());
  }
  return std::make_unique<FreenectSource>(std::move(library), params);
}

}  // namespace robot_vision
