#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/common/starts_with.hpp"
#include "image_files_source.hpp"
#include "robot_vision/camera/open_source.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

#ifdef FREENECT_LIBRARY
constexpr bool kHasFreenect = true;
#else
constexpr bool kHasFreenect = false;
#endif

constexpr int kMaxLinks = 40;  // symbolic links that are followed one after another, as in the kernel

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

/// Checks the limits of the scene, but names the camera's parameters in the error message.
void validateScene(const CaptureParams& params)
{
  requireRange("image_width", params.image_width, 64, 4096);
  requireRange("image_height", params.image_height, 64, 4096);
  require(params.image_width <= 3 * params.image_height && params.image_height <= 3 * params.image_width, "image_width",
          params.image_width, "from a third to three times image_height, " + toText(params.image_height));
}

void validateKinect(const CaptureParams& params)
{
  require(kHasFreenect, "source", "'" + sourceName(params) + "'",
          "another one, as this build has no libfreenect: install libfreenect-dev and build again");
  require(params.views != "stereo", "views", "'stereo'", "one or rgbd for a Kinect");
  const std::string& format = params.pixel_format;
  const bool colors = format != "z16" && format != "grey" && format != "y10" && format != "y10b";
  require(params.views == "one" || colors, "pixel_format", "'" + format + "'",
          "one of colors, such as rgb24, with the views rgbd");
}

}  // namespace

void validate(const CaptureParams& params)
{
  checkFields(params);
  const SourceKind kind = sourceKind(params);
  if (kind == SourceKind::kSynthetic) validateScene(params);
  if (kind == SourceKind::kKinect) validateKinect(params);
  require(params.views != "rgbd" || (kind != SourceKind::kDevice && kind != SourceKind::kUrl), "views", "'rgbd'",
          "one or stereo, as a V4L2 camera or a stream has no depths beside its colors");
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
  if (startsWith(source, "freenect:")) return SourceKind::kKinect;
  if (source.find("://") != std::string::npos) return SourceKind::kUrl;
  struct stat info;
  if (stat(source.c_str(), &info) != 0) return params.source.empty() ? SourceKind::kDevice : kindOfMissing(source);
  if (S_ISCHR(info.st_mode)) return SourceKind::kDevice;
  return S_ISDIR(info.st_mode) || isImageFile(source) ? SourceKind::kImages : SourceKind::kVideo;
}

bool mayComeLater(SourceKind kind)
{
  return kind == SourceKind::kDevice || kind == SourceKind::kKinect || kind == SourceKind::kUrl;
}

}  // namespace robot_vision
