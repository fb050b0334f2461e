#pragma once

#include <string>
#include <vector>

#include "file_sequence.hpp"
#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// True if the file begins like an image file that OpenCV can read.
bool isImageFile(const std::string& path);

/// Reads an image file as BGR. readImage() ignores the EXIF orientation and gives the pixels as the sensor had them,
/// because the camera's calibration does, too; readUpright() turns the image as EXIF says. Both throw SourceError
/// naming the path if the file is missing, damaged or truncated.
cv::Mat readImage(const std::string& path);
cv::Mat readUpright(const std::string& path);

constexpr double kMillimetres = 1000.0;  // the number that stands for 1 m

/// Reads an image file of depths, in which the number `scale` stands for 1 m, as 16UC1: in mm, 0 where there is none.
/// Of another scale than kMillimetres it is 0 beyond 65.534 m, too. Throws as readImage() does, also if its pixels are
/// not gray of 16 bits.
cv::Mat readDepths(const std::string& path, double scale = kMillimetres);

/// The image files of a folder or glob pattern in the order of their names, or the one file that it names. Throws
/// SourceError if there are none.
std::vector<std::string> listImageFiles(const std::string& path);

/// Gives one image file again and again, or the image files of a folder or glob pattern in the order of their names.
class ImageFilesSource : public FrameSource
{
public:
  /// The images are depths of 16 bits, in which the number `depth_scale` stands for 1 m, unless that is 0.
  explicit ImageFilesSource(const std::string& path, double depth_scale = 0.0);
  ReadResult read(Frame& frame) override;
  void rewind() override { files_.rewind(); }
  double rate() const override { return kDefaultRate; }
  bool fillsMemory() const override { return false; }
  std::string description() const override;

private:
  bool ofDepths() const { return depth_scale_ > 0.0; }
  cv::Mat readOne(const std::string& path) const
  {
    return ofDepths() ? readDepths(path, depth_scale_) : readImage(path);
  }

  std::string path_;
  double depth_scale_;
  FileSequence<std::string> files_;
  cv::Mat only_;                    // the decoded image if the source is a single file
  std::int64_t times_of_only_ = 0;  // that it was given
};

}  // namespace robot_vision
