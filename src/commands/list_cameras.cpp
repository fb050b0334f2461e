#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "core/camera/camera_report.hpp"
#include "core/camera/v4l2_cameras.hpp"
#include "robot_vision/camera/frame_source.hpp"

namespace
{

constexpr const char* kHelp = R"(usage: list_cameras [NAME]

Prints the V4L2 cameras that are plugged in: the names by which camera_node finds
them, their formats, sizes and rates, and their controls.

NAME selects one camera in the same way as the parameter video_device:
  /dev/video0                       its path, which may change with each start
  /dev/v4l/by-id/usb-046d_HD_...    a symbolic link to it; below /dev, the link's name is enough
  "HD Pro Webcam C920", c920        its card name, or a part of that
  usb-0000:00:14.0-1                the bus to which it is connected
  1A2B3C4D                          its serial number

examples:
  rosrun robot_vision list_cameras
  rosrun robot_vision camera_node _video_device:=c920 _pixel_format:=mjpeg _image_width:=1280 _image_height:=720

exit code: 0, 1 if there is no such camera or none can be opened, 2 for wrong arguments
)";

using namespace robot_vision;

/// Prints a camera; returns false if it could not be queried.
bool print(const V4l2Camera& camera)
{
  const CameraReport report = reportCamera(camera);
  std::fputs(report.text.c_str(), stdout);
  return report.complete;
}

int printOne(const std::string& name)
{
  const FoundCamera found = findV4l2Camera(name);
  if (!found.warning.empty()) std::fprintf(stderr, "%s\n", found.warning.c_str());
  for (const V4l2Camera& camera : listV4l2Cameras())
    if (isSameFile(camera.path, found.path)) return print(camera) ? 0 : 1;
  std::fprintf(stderr, "%s is no camera\n", found.path.c_str());
  return 1;
}

int printAll()
{
  const std::vector<V4l2Camera> cameras = listV4l2Cameras();
  if (cameras.empty()) std::fprintf(stderr, "no camera is plugged in: no /dev/videoN gives images\n");
  bool any = false;
  for (const V4l2Camera& camera : cameras)
    any = print(camera) || any;
  return any ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv)
try
{
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 1 && (arguments[0] == "-h" || arguments[0] == "--help"))
  {
    std::fputs(kHelp, stdout);
    return 0;
  }
  if (arguments.size() > 1 || (arguments.size() == 1 && arguments[0].compare(0, 1, "-") == 0))
  {
    std::fprintf(stderr, "list_cameras takes the name of one camera, or nothing; --help tells more\n");
    return 2;
  }
  return arguments.empty() ? printAll() : printOne(arguments[0]);
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
