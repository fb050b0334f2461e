#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/camera/freenect_library.hpp"
#include "core/camera/kinect_frames.hpp"

namespace robot_vision
{

/// A fake Kinect whose images and faults a test chooses; it answers as libfreenect does, whose functions it has. Each
/// call that processes events takes the next one of those that are to come.
class FakeKinect
{
public:
  /// What the Kinect sends: an image whose bytes (of the color camera) or shifts are all `value`, or its loss.
  struct Event
  {
    KinectCamera camera = KinectCamera::kColor;
    std::uint32_t ticks = 0;
    int value = 0;
    int error = 0;  // what libfreenect returns, which logs `log` then; 0: it is an image
    std::string log;
  };

  // Its properties and the faults to come.
  std::vector<std::string> serials = {"A00363A05643046A"};  // one for each Kinect that is plugged in
  int init_error = 0;
  int open_error = 0;
  std::string open_log;  // what libfreenect logs then
  bool starts = true;    // whether its cameras can be started
  bool tells_registration = true;
  double const_shift = 200.0;
  float reference_distance = 120.0F;  // cm

  // What has been done to it; under the lock of send() while its source reads.
  int contexts = 0;  // now
  int devices = 0;
  int registrations = 0;
  std::string opened;  // the number or serial number
  freenect_frame_mode video_mode{};
  freenect_frame_mode depth_mode{};
  bool video_runs = false;
  bool depth_runs = false;

  /// Events to come.
  void send(const std::vector<Event>& events);
  /// Whether the images of a camera are sent now.
  bool runs(KinectCamera camera);

  std::shared_ptr<const FreenectLibrary> library();

private:
  void addStart(FreenectLibrary& functions);
  void addDevices(FreenectLibrary& functions);
  void addVideo(FreenectLibrary& functions);
  void addDepth(FreenectLibrary& functions);
  void addRegistration(FreenectLibrary& functions);
  int open(freenect_device** device, const std::string& name, bool there);
  int process();
  void write(const Event& event);
  void log(const std::string& text);

  std::mutex mutex_;
  std::deque<Event> events_;
  freenect_log_cb on_log_ = nullptr;
  freenect_video_cb on_video_ = nullptr;
  freenect_depth_cb on_depth_ = nullptr;
  void* video_memory_ = nullptr;
  void* depth_memory_ = nullptr;
};

}  // namespace robot_vision
