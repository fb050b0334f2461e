#include "robot_vision/camera/open_source.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "image_files_source.hpp"
#include "robot_vision/common/range.hpp"
#include "scene_source.hpp"
#include "side_by_side_source.hpp"
#include "v4l2_cameras.hpp"
#include "v4l2_source.hpp"
#include "video_source.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxLinks = 40;  // symbolic links that are followed one after another, as in the kernel

bool startsWith(const std::string& text, const std::string& start)
{
  return text.compare(0, start.size(), start) == 0;
}

/// True for a path, and for a name that ends like a file's: .mp4, .3gp, .jpeg.
bool looksLikeFile(const std::string& name)
{
  const auto is_alnum = [](unsigned char c) { return std::isalnum(c) != 0; };
  const auto is_alpha = [](unsigned char c) { return std::isalpha(c) != 0; };
  const std::size_t dot = name.rfind('.');
  if (name.find('/') != std::string::npos) return true;
  if (dot == std::string::npos) return false;
  const std::string ending = name.substr(dot + 1);
  return ending.size() >= 2 && ending.size() <= 4 && std::all_of(ending.begin(), ending.end(), is_alnum) &&
         std::any_of(ending.begin(), ending.end(), is_alpha);
}

/// The path to which symbolic links lead, even if nothing is there: links to a camera outlive its unplugging.
std::filesystem::path followLinks(std::filesystem::path path)
{
  std::error_code error;
  for (int i = 0; i < kMaxLinks && std::filesystem::is_symlink(path, error); ++i)
    path = path.parent_path() / std::filesystem::read_symlink(path, error);
  return path.lexically_normal();
}

/// True for a path where a camera may appear. /dev/shm holds files.
bool isDevicePath(const std::string& path)
{
  return startsWith(path, "/dev/") && !startsWith(path, "/dev/shm/");
}

SourceKind kindOfMissing(const std::string& source)
{
  if (isDevicePath(followLinks(source).string())) return SourceKind::kDevice;
  if (source.find_first_of("*?[") != std::string::npos) return SourceKind::kImages;
  return looksLikeFile(source) ? SourceKind::kVideo : SourceKind::kDevice;
}

/// Text for an error message that names the folder of a relative path: a node's working folder is seldom the one that
/// its user has in mind.
std::string inWorkingFolder(const std::string& path)
{
  std::error_code error;
  const std::string folder = std::filesystem::current_path(error).string();
  return error || path.front() == '/' ? "" : " in " + folder;
}

/// Checks the limits of the scene, but names the camera's parameters in the error message.
void validateScene(const CaptureParams& params)
{
  requireRange("image_width", params.image_width, 64, 4096);
  requireRange("image_height", params.image_height, 64, 4096);
  require(params.image_width <= 3 * params.image_height && params.image_height <= 3 * params.image_width, "image_width",
          params.image_width, "from a third to three times image_height, " + toText(params.image_height));
}

/// A name may belong to another device each time.
std::unique_ptr<FrameSource> openCamera(const std::string& name, const CaptureParams& params)
{
  const FoundCamera found = findV4l2Camera(name);
  return std::make_unique<V4l2Source>(openV4l2Device(found.path), params, found.warning);
}

std::unique_ptr<FrameSource> openVideoFile(const std::string& path)
{
  struct stat info;
  if (stat(path.c_str(), &info) != 0) throw SourceError(path + ": no such file or folder" + inWorkingFolder(path));
  if (!S_ISREG(info.st_mode)) throw SourceError(path + " cannot be read: it is no file");  // reading a pipe would block
  if (info.st_size == 0) throw SourceError(path + ": the file is empty");
  return std::make_unique<VideoSource>(path);
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
    case SourceKind::kUrl:
      return std::make_unique<VideoSource>(source);
    case SourceKind::kImages:
      return std::make_unique<ImageFilesSource>(source, params.pixel_format == "z16");
    case SourceKind::kVideo:
      break;
  }
  return openVideoFile(source);
}

}  // namespace

void validate(const CaptureParams& params)
{
  checkFields(params);
  if (params.source == "synthetic")
    validateScene(params);
  else
    require(params.views != "rgbd", "views", "'rgbd'",
            "one or stereo, as only the source synthetic has depths as well");
  require(!params.source.empty() || !params.video_device.empty(), "video_device", "''",
          "a device such as /dev/video0, or its name");
}

double wantedRate(const CaptureParams& params)
{
  return params.framerate > 0.0 ? params.framerate : kDefaultRate;
}

std::string sourceName(const CaptureParams& params)
{
  const std::string& source = params.source.empty() ? params.video_device : params.source;
  return startsWith(source, "file://") ? source.substr(7) : source;
}

SourceKind sourceKind(const CaptureParams& params)
{
  if (params.kind) return *params.kind;
  const std::string source = sourceName(params);
  if (source == "synthetic") return SourceKind::kSynthetic;
  if (source.find("://") != std::string::npos) return SourceKind::kUrl;
  struct stat info;
  if (stat(source.c_str(), &info) != 0) return params.source.empty() ? SourceKind::kDevice : kindOfMissing(source);
  if (S_ISCHR(info.st_mode)) return SourceKind::kDevice;
  return S_ISDIR(info.st_mode) || isImageFile(source) ? SourceKind::kImages : SourceKind::kVideo;
}

bool mayComeLater(SourceKind kind)
{
  return kind == SourceKind::kDevice || kind == SourceKind::kUrl;
}

std::unique_ptr<FrameSource> openSource(const CaptureParams& params)
{
  validate(params);
  std::unique_ptr<FrameSource> frames = openFrames(params);
  if (params.views != "stereo" || sourceKind(params) == SourceKind::kSynthetic) return frames;
  return std::make_unique<SideBySideSource>(std::move(frames));
}

}  // namespace robot_vision
