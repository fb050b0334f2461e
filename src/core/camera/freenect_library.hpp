#pragma once

#include <libfreenect.h>
#include <libfreenect_registration.h>

#include <functional>
#include <memory>
#include <string>

namespace robot_vision
{

/// The functions of libfreenect by their names without freenect_. The library is loaded when a Kinect is opened: so
/// nobody else needs it, and it may be fakenect, which plays recordings. Tests have functions of their own.
struct FreenectLibrary
{
  std::function<decltype(freenect_init)> init;
  std::function<decltype(freenect_shutdown)> shutdown;
  std::function<decltype(freenect_set_log_level)> set_log_level;
  std::function<decltype(freenect_set_log_callback)> set_log_callback;
  std::function<decltype(freenect_select_subdevices)> select_subdevices;
  std::function<decltype(freenect_num_devices)> num_devices;
  std::function<decltype(freenect_open_device)> open_device;
  std::function<decltype(freenect_open_device_by_camera_serial)> open_device_by_camera_serial;
  std::function<decltype(freenect_close_device)> close_device;
  std::function<decltype(freenect_find_video_mode)> find_video_mode;
  std::function<decltype(freenect_set_video_mode)> set_video_mode;
  std::function<decltype(freenect_set_video_callback)> set_video_callback;
  std::function<decltype(freenect_set_video_buffer)> set_video_buffer;
  std::function<decltype(freenect_start_video)> start_video;
  std::function<decltype(freenect_stop_video)> stop_video;
  std::function<decltype(freenect_find_depth_mode)> find_depth_mode;
  std::function<decltype(freenect_set_depth_mode)> set_depth_mode;
  std::function<decltype(freenect_set_depth_callback)> set_depth_callback;
  std::function<decltype(freenect_set_depth_buffer)> set_depth_buffer;
  std::function<decltype(freenect_start_depth)> start_depth;
  std::function<decltype(freenect_stop_depth)> stop_depth;
  std::function<decltype(freenect_process_events_timeout)> process_events_timeout;

  // What fakenect does not have, or not in all versions; empty then.
  std::function<decltype(freenect_list_device_attributes)> list_device_attributes;
  std::function<decltype(freenect_free_device_attributes)> free_device_attributes;
  std::function<decltype(freenect_copy_registration)> copy_registration;
  std::function<decltype(freenect_destroy_registration)> destroy_registration;
};

/// Loads the library of the version that this was built with; it is unloaded with the last pointer. Throws
/// std::runtime_error that names it if it is not there, or lacks a function.
std::shared_ptr<const FreenectLibrary> loadFreenect();

}  // namespace robot_vision
