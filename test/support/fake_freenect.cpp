#include "fake_freenect.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace robot_vision
{
namespace
{

/// The modes that libfreenect 0.5 has of those that are asked for.
freenect_frame_mode videoMode(freenect_resolution resolution, freenect_video_format format)
{
  const bool high = resolution == FREENECT_RESOLUTION_HIGH;
  const bool infrared = format == FREENECT_VIDEO_IR_8BIT || format == FREENECT_VIDEO_IR_10BIT;
  const int bytes = format == FREENECT_VIDEO_RGB ? 3 : format == FREENECT_VIDEO_IR_10BIT ? 2 : 1;
  freenect_frame_mode mode{};
  mode.resolution = resolution;
  mode.video_format = format;
  mode.width = high ? 1280 : 640;
  mode.height = high ? 1024 : infrared ? 488 : 480;
  mode.bytes = mode.width * mode.height * bytes;
  mode.is_valid = 1;
  return mode;
}

}  // namespace

void FakeKinect::send(const std::vector<Event>& events)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  events_.insert(events_.end(), events.begin(), events.end());
}

bool FakeKinect::runs(KinectCamera camera)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return camera == KinectCamera::kColor ? video_runs : depth_runs;
}

std::shared_ptr<const FreenectLibrary> FakeKinect::library()
{
  const auto functions = std::make_shared<FreenectLibrary>();
  addStart(*functions);
  addDevices(*functions);
  addVideo(*functions);
  addDepth(*functions);
  if (tells_registration) addRegistration(*functions);
  return functions;
}

void FakeKinect::addStart(FreenectLibrary& functions)
{
  functions.init = [this](freenect_context** context, freenect_usb_context*)
  {
    if (init_error == 0) ++contexts;
    *context = init_error == 0 ? reinterpret_cast<freenect_context*>(this) : nullptr;
    return init_error;
  };
  functions.shutdown = [this](freenect_context*)
  {
    events_.clear();
    return --contexts, 0;
  };
  functions.set_log_level = [](freenect_context*, freenect_loglevel) {};
  functions.set_log_callback = [this](freenect_context*, freenect_log_cb callback) { on_log_ = callback; };
  functions.select_subdevices = [](freenect_context*, freenect_device_flags) {};
  functions.process_events_timeout = [this](freenect_context*, timeval*) { return process(); };
}

void FakeKinect::addDevices(FreenectLibrary& functions)
{
  functions.num_devices = [this](freenect_context*) { return static_cast<int>(serials.size()); };
  functions.list_device_attributes = [this](freenect_context*, freenect_device_attributes** first)
  {
    *first = nullptr;
    for (auto serial = serials.rbegin(); serial != serials.rend(); ++serial)
      *first = new freenect_device_attributes{*first, serial->c_str()};
    return static_cast<int>(serials.size());
  };
  functions.free_device_attributes = [](freenect_device_attributes* first)
  {
    while (first != nullptr)
      delete std::exchange(first, first->next);
  };
  functions.open_device = [this](freenect_context*, freenect_device** device, int index)
  { return open(device, std::to_string(index), true); };
  functions.open_device_by_camera_serial = [this](freenect_context*, freenect_device** device, const char* serial)
  { return open(device, serial, std::find(serials.begin(), serials.end(), serial) != serials.end()); };
  functions.close_device = [this](freenect_device*) { return --devices, 0; };
}

void FakeKinect::addVideo(FreenectLibrary& functions)
{
  functions.find_video_mode = videoMode;
  functions.set_video_mode = [this](freenect_device*, freenect_frame_mode mode) { return video_mode = mode, 0; };
  functions.set_video_callback = [this](freenect_device*, freenect_video_cb callback) { on_video_ = callback; };
  functions.set_video_buffer = [this](freenect_device*, void* memory) { return video_memory_ = memory, 0; };
  functions.start_video = [this](freenect_device*)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    video_runs = starts;
    return starts ? 0 : -1;
  };
  functions.stop_video = [this](freenect_device*) { return video_runs = false, 0; };
}

void FakeKinect::addDepth(FreenectLibrary& functions)
{
  functions.find_depth_mode = [](freenect_resolution resolution, freenect_depth_format format)
  {
    freenect_frame_mode mode{};
    mode.resolution = resolution;
    mode.depth_format = format;
    mode.is_valid = 1;
    return mode;
  };
  functions.set_depth_mode = [this](freenect_device*, freenect_frame_mode mode) { return depth_mode = mode, 0; };
  functions.set_depth_callback = [this](freenect_device*, freenect_depth_cb callback) { on_depth_ = callback; };
  functions.set_depth_buffer = [this](freenect_device*, void* memory) { return depth_memory_ = memory, 0; };
  functions.start_depth = [this](freenect_device*)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    depth_runs = starts;
    return starts ? 0 : -1;
  };
  functions.stop_depth = [this](freenect_device*) { return depth_runs = false, 0; };
}

void FakeKinect::addRegistration(FreenectLibrary& functions)
{
  functions.copy_registration = [this](freenect_device*)
  {
    ++registrations;
    freenect_registration told{};
    told.zero_plane_info = {7.5F, 2.4F, reference_distance, 0.1042F};
    told.const_shift = const_shift;
    return told;
  };
  functions.destroy_registration = [this](freenect_registration*) { return --registrations, 0; };
}

int FakeKinect::open(freenect_device** device, const std::string& name, bool there)
{
  if (!there) log("freenect_open_device_by_camera_serial: Couldn't find a device with serial " + name + "\n");
  if (open_error != 0) log(open_log);
  if (!there || open_error != 0) return -1;
  ++devices;
  opened = name;
  *device = reinterpret_cast<freenect_device*>(this);
  return 0;
}

int FakeKinect::process()
{
  std::unique_lock<std::mutex> lock(mutex_);
  if (events_.empty())
  {
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return 0;
  }
  const Event event = events_.front();
  events_.pop_front();
  const bool is_sent = event.error == 0 && (event.camera == KinectCamera::kColor ? video_runs : depth_runs);
  lock.unlock();
  if (!event.log.empty()) log(event.log);
  if (is_sent) write(event);
  return event.error;
}

void FakeKinect::write(const Event& event)
{
  auto* const device = reinterpret_cast<freenect_device*>(this);
  if (event.camera == KinectCamera::kColor)
  {
    std::memset(video_memory_, event.value, static_cast<std::size_t>(video_mode.bytes));
    return on_video_(device, video_memory_, event.ticks);
  }
  auto* const shifts = static_cast<std::uint16_t*>(depth_memory_);
  std::fill(shifts, shifts + std::size_t{640} * 480, static_cast<std::uint16_t>(event.value));
  on_depth_(device, depth_memory_, event.ticks);
}

void FakeKinect::log(const std::string& text)
{
  if (on_log_ != nullptr) on_log_(reinterpret_cast<freenect_context*>(this), FREENECT_LOG_ERROR, text.c_str());
}

}  // namespace robot_vision
