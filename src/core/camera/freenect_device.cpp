#include "freenect_device.hpp"

#include <sys/time.h>

#include <utility>
#include <vector>

#include "freenect_names.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

const std::string kPrefix = "freenect:";
constexpr int kInterrupted = -10;        // LIBUSB_ERROR_INTERRUPTED: a signal came, and nothing is wrong
constexpr std::size_t kMaxListed = 100;  // Kinects, so that no faulty list is endless

// The device whose library works in this thread. What it calls back is given no other way to know it in each version.
thread_local FreenectDevice* current = nullptr;

}  // namespace

/// Has the library's callbacks reach the device while it lives.
class FreenectDevice::Listening
{
public:
  explicit Listening(FreenectDevice& device)
  {
    device.log_.clear();
    current = &device;
  }
  ~Listening() { current = nullptr; }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
};

FreenectDevice::FreenectDevice(std::shared_ptr<const FreenectLibrary> library, const std::string& source,
                               OnImage on_image)
  : library_(std::move(library)), source_(source), on_image_(std::move(on_image))
{
  try
  {
    open();
  }
  catch (...)
  {
    close();
    throw;
  }
}

FreenectDevice::~FreenectDevice()
{
  close();
}

void FreenectDevice::open()
{
  const Listening listening(*this);
  const int result = library_->init(&context_, nullptr);
  if (result < 0) context_ = nullptr;  // it may have been freed already
  check(result, "USB cannot be used");
  library_->set_log_level(context_, FREENECT_LOG_ERROR);
  library_->set_log_callback(context_, onLog);
  library_->select_subdevices(context_, FREENECT_DEVICE_CAMERA);
  if (library_->num_devices(context_) < 1) fail("no Kinect is plugged in; its cameras need its own power supply, too");
  check(openNamed(), "cannot be opened");
  library_->set_video_callback(device_, onVideo);
  library_->set_depth_callback(device_, onDepth);
}

int FreenectDevice::openNamed()
{
  const std::string name = source_.substr(kPrefix.size());
  const int index = freenectIndex(name), count = library_->num_devices(context_);
  if (index < 0 && (name.front() == '#' || name.find('@') != std::string::npos))
    fail("expected the number of a Kinect, such as freenect:0, or its serial number");
  if (index >= count) fail("there is no Kinect of this number, only " + std::to_string(count) + serialNumbers());
  if (index >= 0) return library_->open_device(context_, &device_, index);
  const int result = library_->open_device_by_camera_serial(context_, &device_, name.c_str());
  if (result >= 0 || log_.find("find a device with serial") == std::string::npos) return result;
  log_.clear();
  fail("no Kinect that may be opened has this serial number; there are " + std::to_string(count) + serialNumbers());
}

/// ", with the serial numbers A and B", as far as they can be read.
std::string FreenectDevice::serialNumbers() const
{
  if (!library_->list_device_attributes || !library_->free_device_attributes) return "";
  freenect_device_attributes* first = nullptr;
  if (library_->list_device_attributes(context_, &first) < 0) return "";
  std::vector<std::string> found;
  for (const freenect_device_attributes* each = first; each != nullptr && found.size() < kMaxListed; each = each->next)
    if (each->camera_serial != nullptr) found.emplace_back(each->camera_serial);
  library_->free_device_attributes(first);
  return found.empty() ? "" : ", with serial numbers " + joined(found);
}

KinectOptics FreenectDevice::optics() const
{
  if (!library_->copy_registration || !library_->destroy_registration) return {};
  freenect_registration told = library_->copy_registration(device_);
  KinectOptics optics;  // it tells all in cm
  optics.projector_baseline = told.zero_plane_info.dcmos_emitter_dist / 100.0;
  optics.reference_distance = told.zero_plane_info.reference_distance / 100.0;
  optics.reference_pixel = told.zero_plane_info.reference_pixel_size / 100.0;
  optics.zero_shift = told.const_shift;
  library_->destroy_registration(&told);
  return optics.valid() ? optics : KinectOptics();
}

void FreenectDevice::startVideo(freenect_resolution resolution, freenect_video_format format, void* memory)
{
  const Listening listening(*this);
  const freenect_frame_mode mode = library_->find_video_mode(resolution, format);
  check(mode.is_valid != 0 ? library_->set_video_mode(device_, mode) : -1, "its color camera has no such images");
  check(library_->set_video_buffer(device_, memory), "its color camera cannot be used");
  check(library_->start_video(device_), "its color camera cannot be started");
  video_runs_ = true;
}

void FreenectDevice::startDepth(void* memory)
{
  const Listening listening(*this);
  const freenect_frame_mode mode = library_->find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_11BIT);
  check(mode.is_valid != 0 ? library_->set_depth_mode(device_, mode) : -1, "its depth camera has no such images");
  check(library_->set_depth_buffer(device_, memory), "its depth camera cannot be used");
  check(library_->start_depth(device_), "its depth camera cannot be started");
  depth_runs_ = true;
}

void FreenectDevice::setMemory(KinectCamera camera, void* memory)
{
  if (camera == KinectCamera::kColor)
    library_->set_video_buffer(device_, memory);
  else
    library_->set_depth_buffer(device_, memory);
}

void FreenectDevice::processEvents(std::chrono::milliseconds timeout)
{
  const Listening listening(*this);
  timeval longest{0, static_cast<suseconds_t>(std::chrono::microseconds(timeout).count())};
  const int result = library_->process_events_timeout(context_, &longest);
  if (result < 0 && result != kInterrupted) fail("the Kinect is gone, or its recording has ended");
}

void FreenectDevice::check(int result, const std::string& what) const
{
  if (result < 0) fail(what + (log_.empty() ? ": libfreenect's error " + std::to_string(result) : ""));
}

void FreenectDevice::fail(const std::string& what) const
{
  throw SourceUnavailable(source_ + ": " + what + (log_.empty() ? "" : ": " + log_) + freenectAdvice(log_));
}

void FreenectDevice::close()
{
  const Listening listening(*this);
  if (video_runs_) library_->stop_video(device_);
  if (depth_runs_) library_->stop_depth(device_);
  if (device_ != nullptr) library_->close_device(device_);
  if (context_ != nullptr) library_->shutdown(context_);
}

void FreenectDevice::onLog(freenect_context* /*context*/, freenect_loglevel level, const char* text) noexcept
{
  if (current == nullptr || level > FREENECT_LOG_ERROR || !current->log_.empty()) return;
  const std::string line(text);
  current->log_ = line.substr(0, line.find_last_not_of(" \n") + 1);
}

void FreenectDevice::onVideo(freenect_device* /*device*/, void* /*memory*/, std::uint32_t ticks) noexcept
{
  if (current != nullptr) current->on_image_(KinectCamera::kColor, ticks);
}

void FreenectDevice::onDepth(freenect_device* /*device*/, void* /*memory*/, std::uint32_t ticks) noexcept
{
  if (current != nullptr) current->on_image_(KinectCamera::kDepth, ticks);
}

}  // namespace robot_vision
