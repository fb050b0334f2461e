#pragma once

#include <memory>
#include <optional>
#include <string>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

enum class SourceKind
{
  kSynthetic,
  kDevice,
  kKinect,
  kUrl,
  kImages,
  kVideo,
};

struct CaptureParams
{
  std::string source;
  std::optional<SourceKind> kind;  // of the source, as sourceKind() told it; none: decided at each opening
  std::string video_device = "/dev/video0";
  int image_width = 640;
  int image_height = 480;
  std::string pixel_format = "yuyv";
  std::string io_method = "mmap";
  double framerate = 0.0;
  double timeout = 3.0;
  std::string scene = "room";
  std::string poster;
  std::string meshes;
  std::string views = "one";
  std::string depth_encoding = "16UC1";
  std::string depth_noise = "none";
  double depth_scale = 1000.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("source", &CaptureParams::source, Anything{}, "",
          "synthetic, or a camera, video, URL, image or folder of images; freenect:0: a Kinect, by its number or "
          "serial number; empty: video_device");
    visit("video_device", &CaptureParams::video_device, Anything{}, "",
          "a V4L2 camera: path, card, bus or serial number");
    visit("image_width", &CaptureParams::image_width, Range{16, 8192}, "px",
          "of a device, or of the scene: 64 to 4096; files keep their own size; a Kinect: more than 640 is 1280x1024");
    visit("image_height", &CaptureParams::image_height, Range{16, 8192}, "px",
          "of a device, or of the scene: 64 to 4096, a third to three times the width");
    visit("pixel_format", &CaptureParams::pixel_format,
          OneOf{"yuyv, uyvy, nv12, nv21, yu12, bgr24, rgb24, mjpeg, bayer_rggb8, bayer_bggr8, bayer_gbrg8, "
                "bayer_grbg8, h264, grey, y16, y10, y10b, z16, yuv or yuvmono10",
                "'"},
          "",
          "asked of a device; what comes nearest is taken, with a warning. yuvmono10: 10 bits that the camera calls "
          "YUYV; z16: depths in mm, also of image files of 16 bits");
    visit("io_method", &CaptureParams::io_method, OneOf{"mmap, read or userptr", "'"}, "",
          "for usb_cam's launch files; always mmap");
    visit("framerate", &CaptureParams::framerate, Range{0, 1000}, "Hz",
          "frames per second; 0: a video's own rate, 30 for all else");
    visit("timeout", &CaptureParams::timeout, Range{0.1, 3600}, "s",
          "a device or stream that gives no good frame for so long is opened anew; cameras slower than that have "
          "three of their periods or exposures, to 30 s, and a stream has 30 s to its next keyframe");
    visit("scene", &CaptureParams::scene, OneOf{"room, calibration, road or tabletop", "'"}, "",
          "what synthetic shows: the room, a checkerboard in many poses, a road that a robot drives on, or meshes on a "
          "table");
    visit("poster", &CaptureParams::poster, Anything{}, "",
          "image file on the wall of the scene; empty or pattern: a pattern; auto: the portrait of python3-skimage "
          "if that is installed, else the pattern");
    visit("meshes", &CaptureParams::meshes, Anything{}, "",
          "on the table of the scene, with commas between them: mesh files (stl, obj, dae, ply, gltf, ...) and bottle, "
          "box, bracket, can, drill, duck, mug and nut; empty: all of these eight");
    visit("views", &CaptureParams::views, OneOf{"one, stereo or rgbd", "'"}, "",
          "one image, a stereo pair, or color and depth: of the scene, a Kinect or the folders rgb and depth in a "
          "folder; each frame of a stereo source but the scene is both images side by side, the left one left");
    visit("depth_encoding", &CaptureParams::depth_encoding, OneOf{"16UC1 or 32FC1", "'"}, "",
          "of the scene's depths: mm, 0 where there is none, or m, NaN where there is none");
    visit("depth_noise", &CaptureParams::depth_noise, OneOf{"none, kinect, stereo or tof", "'"}, "",
          "of the scene's depths: none, or as such a sensor has it");
    visit("depth_scale", &CaptureParams::depth_scale, Range{1, 1e6}, "1/m",
          "of image files of depths: the number that stands for 1 m; 5000 in files of the TUM RGB-D benchmark");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const CaptureParams& params);

/// The name of the source to open: `source`, or `video_device` if that is empty. A leading file:// is removed.
std::string sourceName(const CaptureParams& params);

/// The kind of the source, also of one that is not there now: `params.kind` if that is set, else the kind that the name
/// looks like and leads to now. A caller who will open the source again should keep the result in `params.kind`,
/// because the link to a camera leads nowhere while the camera is unplugged.
SourceKind sourceKind(const CaptureParams& params);

/// True for a device, a Kinect or a URL: if it is not there now, it may appear later.
bool mayComeLater(SourceKind kind);

/// The rate in Hz at which a source without a rate of its own is to run.
double wantedRate(const CaptureParams& params);

/// Opens the source that `params` name. Throws std::invalid_argument for a parameter out of range, SourceError for a
/// source that is wrong and SourceUnavailable for one that may come later; each message names the source.
std::unique_ptr<FrameSource> openSource(const CaptureParams& params);

}  // namespace robot_vision
