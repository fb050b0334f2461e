#include "image_files_source.hpp"

#include <glob.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "core/codecs/opencv_codecs.hpp"
#include "robot_vision/codecs/image_file.hpp"
#include "robot_vision/common/regular_file.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxFile = std::size_t{256} << 20;  // bytes; more than the largest uncompressed image has

std::vector<std::string> globbed(const std::string& pattern)
{
  glob_t found;
  std::vector<std::string> paths;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0) paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  globfree(&found);
  return paths;
}

/// A glob pattern that matches this path only.
std::string escaped(const std::string& path)
{
  std::string pattern;
  for (const char c : path)
  {
    if (std::string("*?[\\").find(c) != std::string::npos) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

cv::Mat decodeFile(const std::string& path, int flags)
{
  cv::Mat image;
  try
  {
    const std::string bytes = readFile(path, kMaxFile);
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    if (isJpeg(data, bytes.size()) && !isCompleteJpeg(data, bytes.size()))
      throw SourceError(path + ": the JPEG is damaged or truncated");
    image = decodeImageFile(data, bytes.size(), flags);
  }
  catch (const std::invalid_argument& e)
  {
    throw SourceError(path + ": " + e.what());
  }
  catch (const std::runtime_error& e)
  {
    throw SourceError(e.what());
  }
  if (image.empty()) throw SourceError(path + ": not an image that OpenCV can read, or damaged");
  return image;
}

}  // namespace

bool isImageFile(const std::string& path)
{
  struct stat info;
  return stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && isReadByOpenCv(path);
}

cv::Mat readImage(const std::string& path)
{
  return decodeFile(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

cv::Mat readUpright(const std::string& path)
{
  return decodeFile(path, cv::IMREAD_COLOR);
}

cv::Mat readDepths(const std::string& path, double scale)
{
  const cv::Mat depths = decodeFile(path, cv::IMREAD_UNCHANGED);
  if (depths.type() != CV_16UC1)
    throw SourceError(path + ": no depths: expected pixels of " + describePixels(CV_16UC1) + ", got " +
                      describePixels(depths.type()));
  if (scale == kMillimetres) return depths;
  cv::Mat millimetres;
  depths.convertTo(millimetres, CV_16U, kMillimetres / scale);
  millimetres.setTo(0, millimetres == std::numeric_limits<std::uint16_t>::max());  // what is beyond ends there
  return millimetres;
}

std::vector<std::string> listImageFiles(const std::string& path)
{
  struct stat info;
  const bool exists = stat(path.c_str(), &info) == 0;
  if (exists && !S_ISDIR(info.st_mode)) return {path};

  std::vector<std::string> found = globbed(exists ? escaped(path) + "/*" : path);
  found.erase(std::remove_if(found.begin(), found.end(), [](const std::string& f) { return !isImageFile(f); }),
              found.end());
  if (found.empty()) throw SourceError(path + ": no images that OpenCV can read are there");
  return found;
}

ImageFilesSource::ImageFilesSource(const std::string& path, double depth_scale)
  : path_(path), depth_scale_(depth_scale), files_(path, listImageFiles(path))
{
  if (files_.all().front() == path) only_ = readOne(path);
}

ReadResult ImageFilesSource::read(Frame& frame)
{
  frame.encoding = ofDepths() ? "16UC1" : "bgr8";
  if (!only_.empty())
  {
    frame.image = only_;
    frame.sequence = times_of_only_++;
    return ReadResult::kFrame;
  }
  return files_.read(frame, [this, &frame](const std::string& file) { frame.image = readOne(file); });
}

std::string ImageFilesSource::description() const
{
  return (only_.empty() ? std::to_string(files_.all().size()) + " images" : std::string("image")) + " from " + path_;
}

}  // namespace robot_vision
