#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "v4l2_device.hpp"

namespace robot_vision
{

/// Where the system describes devices and how they are opened. Tests have their own.
struct V4l2System
{
  std::string devices = "/dev";                    // videoN, and links to them
  std::string classes = "/sys/class/video4linux";  // videoN/name, videoN/device
  std::function<std::unique_ptr<V4l2Device>(const std::string& path)> open = openV4l2Device;
};

/// A capture device and the names by which it can be found.
struct V4l2Camera
{
  std::string path;                // /dev/video0; after a restart it may belong to another camera
  std::string card;                // "HD Pro Webcam C920"
  std::string driver;              // "uvcvideo"
  std::string bus;                 // "usb-0000:00:14.0-1"
  std::string serial;              // empty unless it is a USB device that has one
  std::vector<std::string> links;  // symbolic links below /dev: by-id, by-path, those of udev's rules
  std::string problem;             // the reason why it cannot be queried, if so; then driver and bus are unknown
};

/// All cameras in the order of their numbers, without device files that give metadata instead of images.
std::vector<V4l2Camera> listV4l2Cameras(const V4l2System& system = {});

struct FoundCamera
{
  std::string path;
  std::string warning;  // empty if the name matches one camera only
};

/// Finds the camera that has this serial number, bus or link name; else this card name; else a card name that contains
/// this name. Card names are compared regardless of case. A path is returned as it is. Throws SourceUnavailable that
/// lists the cameras if none matches.
FoundCamera findV4l2Camera(const std::string& name, const V4l2System& system = {});

/// True if both paths lead to the same file, which may be a device: std::filesystem::equivalent() refuses devices.
bool isSameFile(const std::string& a, const std::string& b);

/// "/dev/video0 (HD Pro Webcam C920, usb-0000:00:14.0-1, serial 1A2B3C4D)"
std::string describe(const V4l2Camera& camera);

}  // namespace robot_vision
