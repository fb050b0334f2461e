#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// The two cameras of a Kinect; in place of colors the first may give the infrared image.
enum class KinectCamera : std::size_t
{
  kColor,
  kDepth,
};

constexpr double kKinectTickRate = 60e6;  // Hz, of the clock that stamps the images of both cameras

/// What two images may be apart in time to belong together: a little more than half the time from one to the next, so
/// that there is always one such image at 30 Hz.
constexpr std::int32_t kMaxKinectGap = static_cast<std::int32_t>(0.02 * kKinectTickRate);  // ticks

/// What a Kinect has sent of one moment: the wanted ones of both images, valid until the next take().
struct KinectFrame
{
  cv::Mat color;
  cv::Mat depth;                  // shifts, see kinectDepths()
  std::int64_t sequence = 0;      // gaps are frames that nobody has taken
  std::int64_t monotonic_ns = 0;  // of its arrival; of two images it is the time between both
};

/// Images on their way from the thread that has them written to memory to the one that takes the newest. The cameras of
/// a Kinect run freely: images of both belong together that are the first ones within kMaxKinectGap of each other.
class KinectFrames
{
public:
  /// The images are of these sizes and types.
  KinectFrames(cv::Size color_size, int color_type, cv::Size depth_size);

  /// The memory for the next image of a camera, for the thread that has it written to.
  void* memory(KinectCamera camera) { return at(camera).images[kFilling].data; }

  /// There is an image in that memory, sent at this time on the Kinect's clock (it wraps) and arrived at this one.
  /// After that another memory is the next one.
  void arrived(KinectCamera camera, std::uint32_t ticks, std::int64_t monotonic_ns);

  /// No more images will arrive.
  void end(const std::string& reason);

  /// Which images are wanted; both before the first call. Thread-safe.
  void want(bool color, bool depth);
  bool wanted(KinectCamera camera);

  /// Waits for a frame that has not been taken; returns false if none comes in time. Throws SourceUnavailable with the
  /// reason of the end when all have been taken.
  bool take(std::chrono::milliseconds timeout, KinectFrame& frame);

private:
  /// Where an image is: being written, arrived alone, part of the newest frame, or in the one taken last.
  enum Place
  {
    kFilling,
    kWaiting,
    kReady,
    kTaken,
    kPlaces,
  };

  struct Camera
  {
    std::array<cv::Mat, kPlaces> images;
    bool wanted = true;
    bool waits = false;       // whether there is an image that waits for one of the other camera
    bool ready = false;       // whether the newest frame has one of this camera
    std::uint32_t ticks = 0;  // of the image that waits
  };

  Camera& at(KinectCamera camera) { return cameras_[static_cast<std::size_t>(camera)]; }
  void complete(std::int64_t monotonic_ns);

  std::array<Camera, 2> cameras_;  // the memory being filled is of the one thread, all else is guarded
  bool ready_ = false;
  std::int64_t next_sequence_ = 0;
  std::int64_t monotonic_ns_ = 0;  // of the newest frame
  bool ended_ = false;
  std::string reason_;
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace robot_vision
