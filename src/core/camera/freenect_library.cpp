#include "freenect_library.hpp"

#include <dlfcn.h>

#include <stdexcept>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr const char* kName = FREENECT_LIBRARY;  // libfreenect.so.0.5

std::shared_ptr<void> load()
{
  void* const handle = dlopen(kName, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr)
    throw std::runtime_error(std::string("libfreenect cannot be loaded: ") + dlerror() +
                             "; install the version that robot_vision was built with");
  return {handle, [](void* library) { dlclose(library); }};
}

/// The functions of a library, by their whole names.
class Functions
{
public:
  explicit Functions(std::shared_ptr<void> library) : library_(std::move(library)) {}

  template <class Signature>
  void take(const char* name, std::function<Signature>& function, bool required = true) const
  {
    auto* const found = reinterpret_cast<Signature*>(dlsym(library_.get(), name));
    if (found == nullptr && required) throw std::runtime_error(std::string(kName) + " has no function " + name);
    function = found;
  }

private:
  std::shared_ptr<void> library_;
};

}  // namespace

std::shared_ptr<const FreenectLibrary> loadFreenect()
{
  const std::shared_ptr<void> handle = load();
  const Functions functions(handle);
  // Its deleter holds the library until the functions are gone.
  const std::shared_ptr<FreenectLibrary> library(new FreenectLibrary,
                                                 [handle](const FreenectLibrary* made) { delete made; });
  functions.take("freenect_init", library->init);
  functions.take("freenect_shutdown", library->shutdown);
  functions.take("freenect_set_log_level", library->set_log_level);
  functions.take("freenect_set_log_callback", library->set_log_callback);
  functions.take("freenect_select_subdevices", library->select_subdevices);
  functions.take("freenect_num_devices", library->num_devices);
  functions.take("freenect_open_device", library->open_device);
  functions.take("freenect_open_device_by_camera_serial", library->open_device_by_camera_serial);
  functions.take("freenect_close_device", library->close_device);
  functions.take("freenect_find_video_mode", library->find_video_mode);
  functions.take("freenect_set_video_mode", library->set_video_mode);
  functions.take("freenect_set_video_callback", library->set_video_callback);
  functions.take("freenect_set_video_buffer", library->set_video_buffer);
  functions.take("freenect_start_video", library->start_video);
  functions.take("freenect_stop_video", library->stop_video);
  functions.take("freenect_find_depth_mode", library->find_depth_mode);
  functions.take("freenect_set_depth_mode", library->set_depth_mode);
  functions.take("freenect_set_depth_callback", library->set_depth_callback);
  functions.take("freenect_set_depth_buffer", library->set_depth_buffer);
  functions.take("freenect_start_depth", library->start_depth);
  functions.take("freenect_stop_depth", library->stop_depth);
  functions.take("freenect_process_events_timeout", library->process_events_timeout);
  functions.take("freenect_list_device_attributes", library->list_device_attributes, false);
  functions.take("freenect_free_device_attributes", library->free_device_attributes, false);
  functions.take("freenect_copy_registration", library->copy_registration, false);
  functions.take("freenect_destroy_registration", library->destroy_registration, false);
  return library;
}

}  // namespace robot_vision
