#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "freenect_library.hpp"
#include "kinect_depth.hpp"
#include "kinect_frames.hpp"

namespace robot_vision
{

/// An open Kinect. Functions that fail throw SourceUnavailable, which names the source, what failed, what libfreenect
/// says of it, and what helps. It is not thread-safe.
class FreenectDevice
{
public:
  /// Is told that the memory of a camera's next image has been filled, and when by the Kinect's clock.
  using OnImage = std::function<void(KinectCamera camera, std::uint32_t ticks)>;

  /// Opens the Kinect of a source such as freenect:0 (the first one), freenect:#1 (likewise) or
  /// freenect:A00363A05643046A (its serial number), without its motor and microphones.
  FreenectDevice(std::shared_ptr<const FreenectLibrary> library, const std::string& source, OnImage on_image);
  ~FreenectDevice();
  FreenectDevice(const FreenectDevice&) = delete;
  FreenectDevice& operator=(const FreenectDevice&) = delete;

  /// What the Kinect tells of how it measures depth, or what is usual if it tells nothing.
  KinectOptics optics() const;

  /// Starts a camera, whose images are written to `memory`. The depth camera sends shifts, see kinectDepths().
  void startVideo(freenect_resolution resolution, freenect_video_format format, void* memory);
  void startDepth(void* memory);

  /// Sets the memory for the next image of a camera; on_image may call it.
  void setMemory(KinectCamera camera, void* memory);

  /// Waits for what the Kinect sends, at most so long, and calls on_image with it.
  void processEvents(std::chrono::milliseconds timeout);

private:
  class Listening;

  void open();
  int openNamed();
  std::string serialNumbers() const;
  void check(int result, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const;
  void close();

  // C calls them, through which no exception gets.
  static void onLog(freenect_context* context, freenect_loglevel level, const char* text) noexcept;
  static void onVideo(freenect_device* device, void* memory, std::uint32_t ticks) noexcept;
  static void onDepth(freenect_device* device, void* memory, std::uint32_t ticks) noexcept;

  std::shared_ptr<const FreenectLibrary> library_;
  std::string source_;
  OnImage on_image_;
  std::string log_;  // the first error that libfreenect has logged in the call under way
  freenect_context* context_ = nullptr;
  freenect_device* device_ = nullptr;
  bool video_runs_ = false;
  bool depth_runs_ = false;
};

}  // namespace robot_vision
