#include "robot_vision/frame_source.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "picture_source.hpp"
#include "robot_vision/range.hpp"
#include "scene_source.hpp"
#include "v4l2_format.hpp"
#include "v4l2_source.hpp"
#include "video_source.hpp"

namespace robot_vision
{
namespace
{

enum class Kind
{
  kSynthetic,
  kDevice,
  kUrl,
  kPictures,
  kVideo,
};

bool startsWith(const std::string& text, const std::string& start)
{
  return text.compare(0, start.size(), start) == 0;
}

/// The source that is meant, a file without its file://.
std::string nameOf(const CaptureParams& params)
{
  const std::string& source = params.source.empty() ? params.video_device : params.source;
  return startsWith(source, "file://") ? source.substr(7) : source;
}

/// What a source is, or would be if it were there.
Kind kindOf(const std::string& source)
{
  if (source == "synthetic") return Kind::kSynthetic;
  if (source.find("://") != std::string::npos) return Kind::kUrl;
  struct stat info;
  if (stat(source.c_str(), &info) != 0)
  {
    if (startsWith(source, "/dev/")) return Kind::kDevice;
    return source.find_first_of("*?[") != std::string::npos ? Kind::kPictures : Kind::kVideo;
  }
  if (S_ISCHR(info.st_mode)) return Kind::kDevice;
  return S_ISDIR(info.st_mode) || isPictureFile(source) ? Kind::kPictures : Kind::kVideo;
}

/// Where a relative path was looked for: a node's folder is seldom the one that its user sees.
std::string lookedIn(const std::string& path)
{
  char* folder = path.front() == '/' ? nullptr : getcwd(nullptr, 0);
  const std::string text = folder == nullptr ? "" : std::string(" in ") + folder;
  std::free(folder);
  return text;
}

/// What the scene can draw, under the names that a camera's user knows.
void validateScene(const CaptureParams& params)
{
  requireRange("image_width", params.image_width, 64, 4096);
  requireRange("image_height", params.image_height, 64, 4096);
  require(params.image_width <= 3 * params.image_height && params.image_height <= 3 * params.image_width, "image_width",
          params.image_width, "from a third to three times image_height, " + toText(params.image_height));
}

std::unique_ptr<FrameSource> openVideoFile(const std::string& path)
{
  struct stat info;
  if (stat(path.c_str(), &info) != 0) throw SourceError(path + ": no such file or folder" + lookedIn(path));
  if (info.st_size == 0) throw SourceError(path + ": the file is empty");
  return std::make_unique<VideoSource>(path);
}

}  // namespace

void validate(const CaptureParams& params)
{
  requireRange("image_width", params.image_width, 16, 8192);
  requireRange("image_height", params.image_height, 16, 8192);
  if (params.source == "synthetic") validateScene(params);
  requireRange("framerate", params.framerate, 0.0, 1000.0);
  const std::string& format = params.pixel_format;
  require(findV4l2Format(format) != nullptr, "pixel_format", "'" + format + "'", "yuyv, uyvy, grey, nv12 or mjpeg");
  const std::string& io = params.io_method;
  require(io == "mmap" || io == "read" || io == "userptr", "io_method", "'" + io + "'", "mmap, read or userptr");
  require(!params.source.empty() || !params.video_device.empty(), "video_device", "''", "a device such as /dev/video0");
}

double wantedRate(const CaptureParams& params)
{
  return params.framerate > 0.0 ? params.framerate : kDefaultRate;
}

bool mayComeLater(const CaptureParams& params)
{
  const Kind kind = kindOf(nameOf(params));
  return kind == Kind::kDevice || kind == Kind::kUrl;
}

std::unique_ptr<FrameSource> openSource(const CaptureParams& params)
{
  validate(params);
  const std::string source = nameOf(params);
  switch (kindOf(source))
  {
    case Kind::kSynthetic:
      return std::make_unique<SceneSource>(params);
    case Kind::kDevice:
      return std::make_unique<V4l2Source>(source, params);
    case Kind::kUrl:
      return std::make_unique<VideoSource>(source);
    case Kind::kPictures:
      return std::make_unique<PictureSource>(source);
    case Kind::kVideo:
      break;
  }
  return openVideoFile(source);
}

}  // namespace robot_vision
