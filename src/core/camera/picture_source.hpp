#pragma once

#include <string>
#include <vector>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// True if the file begins like a picture that OpenCV reads.
bool isPictureFile(const std::string& path);

/// The pixels of a picture file, in BGR: as the sensor has them, whatever side of the camera was up, for so does its
/// calibration; or turned by EXIF, as people look at it. Throws SourceError naming the path if it is missing, damaged
/// or truncated.
cv::Mat readPicture(const std::string& path);
cv::Mat readUpright(const std::string& path);

/// One picture again and again, or the pictures of a folder or glob in the order of their names.
class PictureSource : public FrameSource
{
public:
  explicit PictureSource(const std::string& path);
  ReadResult read(Frame& frame) override;
  void rewind() override { next_ = 0; }
  double rate() const override { return kDefaultRate; }
  bool fillsMemory() const override { return false; }
  std::string description() const override;

private:
  std::string path_;
  std::vector<std::string> files_;
  std::size_t next_ = 0;
  std::size_t failed_in_a_row_ = 0;
  std::int64_t sequence_ = 0;
  cv::Mat only_;  // the decoded picture if the source is a single file
};

}  // namespace robot_vision
