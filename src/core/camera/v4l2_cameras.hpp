#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "v4l2_device.hpp"

namespace robot_vision
{

/// Where devices are described and how they are opened; tests have machines of their own.
struct V4l2System
{
  std::string devices = "/dev";                    // videoN, and links to them
  std::string classes = "/sys/class/video4linux";  // videoN/name, videoN/device
  std::function<std::unique_ptr<V4l2Device>(const std::string& path)> open = openV4l2Device;
};

/// A device that captures, and the names by which it can be found.
struct V4l2Camera
{
  std::string path;                // /dev/video0; at another start it may be another camera's
  std::string card;                // "HD Pro Webcam C920"
  std::string driver;              // "uvcvideo"
  std::string bus;                 // "usb-0000:00:14.0-1"
  std::string serial;              // of a USB device that has one
  std::vector<std::string> links;  // below /dev: by-id, by-path, those of udev's rules
  std::string problem;             // why it cannot be asked; then driver and bus are unknown
};

/// All cameras, in the order of their numbers. Nodes of a camera that give no pictures but only data are left out.
std::vector<V4l2Camera> listV4l2Cameras(const V4l2System& system = {});

struct FoundCamera
{
  std::string path;
  std::string warning;  // empty if only one fits
};

/// The camera with this serial, bus, or name of a link; else of this card; else with this in the card's name, upper or
/// lower case. A path is taken as it is. Throws SourceUnavailable listing the cameras if none fits.
FoundCamera findV4l2Camera(const std::string& name, const V4l2System& system = {});

/// True if both paths lead to one file; std::filesystem::equivalent() knows no devices.
bool isSameFile(const std::string& a, const std::string& b);

/// "/dev/video0 (HD Pro Webcam C920, usb-0000:00:14.0-1, serial 1A2B3C4D)"
std::string describe(const V4l2Camera& camera);

}  // namespace robot_vision
