#include "robot_vision/camera/open_source.hpp"

#include <sys/stat.h>

#include <filesystem>

#include "image_files_source.hpp"
#include "rgbd_files_source.hpp"
#include "robot_vision/common/range.hpp"
#include "scene_source.hpp"
#include "side_by_side_source.hpp"
#include "v4l2_cameras.hpp"
#include "v4l2_source.hpp"
#include "video_decoders.hpp"
#ifdef FREENECT_LIBRARY
#include "freenect_source.hpp"
#endif

namespace robot_vision
{
namespace
{

/// Text for an error message that names the folder of a relative path: a node's working folder is seldom the one that
/// its user has in mind.
std::string inWorkingFolder(const std::string& path)
{
  std::error_code error;
  const std::string folder = std::filesystem::current_path(error).string();
  return error || path.front() == '/' ? "" : " in " + folder;
}

/// A name may belong to another device each time.
std::unique_ptr<FrameSource> openCamera(const std::string& name, const CaptureParams& params)
{
  const FoundCamera found = findV4l2Camera(name);
  return std::make_unique<V4l2Source>(openV4l2Device(found.path), params, found.warning);
}

std::unique_ptr<FrameSource> openKinect(const CaptureParams& params)
{
#ifdef FREENECT_LIBRARY
  return openFreenect(params);
#else
  throw SourceError(sourceName(params) + ": this build has no libfreenect");  // validate() has said so already
#endif
}

std::unique_ptr<FrameSource> openImages(const std::string& path, const CaptureParams& params)
{
  if (params.views == "rgbd") return std::make_unique<RgbdFilesSource>(path, params.depth_scale);
  if (params.pixel_format == "z16") return std::make_unique<ImageFilesSource>(path, params.depth_scale);
  return std::make_unique<ImageFilesSource>(path);
}

std::unique_ptr<FrameSource> openVideoFile(const std::string& path, const CaptureParams& params)
{
  struct stat info;
  if (stat(path.c_str(), &info) != 0) throw SourceError(path + ": no such file or folder" + inWorkingFolder(path));
  if (!S_ISREG(info.st_mode)) throw SourceError(path + " cannot be read: it is no file");  // reading a pipe would block
  if (info.st_size == 0) throw SourceError(path + ": the file is empty");
  if (params.views == "rgbd") throw SourceError(path + ": a video has no depths: views must be one or stereo");
  return openVideo(path, params.timeout);
}

std::unique_ptr<FrameSource> openFrames(const CaptureParams& params)
{
  const std::string source = sourceName(params);
  switch (sourceKind(params))
  {
    case SourceKind::kSynthetic:
      return openScene(params);
    case SourceKind::kDevice:
      return openCamera(source, params);
    case SourceKind::kKinect:
      return openKinect(params);
    case SourceKind::kUrl:
      return openVideo(source, params.timeout);
    case SourceKind::kImages:
      return openImages(source, params);
    case SourceKind::kVideo:
      break;
  }
  return openVideoFile(source, params);
}

}  // namespace

std::unique_ptr<FrameSource> openSource(const CaptureParams& params)
{
  validate(params);
  std::unique_ptr<FrameSource> frames = openFrames(params);
  if (params.views != "stereo" || sourceKind(params) == SourceKind::kSynthetic) return frames;
  return std::make_unique<SideBySideSource>(std::move(frames));
}

}  // namespace robot_vision
