#pragma once

#include <string>
#include <vector>

#include "file_sequence.hpp"
#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

constexpr double kMaxRgbdGap = 0.02;  // s, between the stamps of two images that belong together

/// The file of a color image and that of the depths that belong to it.
struct RgbdFiles
{
  std::string color;
  std::string depth;
  double stamp = 0.0;  // s, of the color image; 0 if the names of the files tell none
};

/// Which of the files in the folders rgb and depth of a folder belong together. If the names of all are numbers with a
/// point, 1305031102.175304.png, these are stamps in s, as in the TUM RGB-D benchmark: the two nearest ones belong
/// together, then the nearest of the others, up to kMaxRgbdGap, as by the benchmark's associate.py. Else it is the
/// order of their names. Throws SourceError that says what is wrong with the folder.
std::vector<RgbdFiles> listRgbdFiles(const std::string& path);

/// Gives the image files of the folders rgb (colors) and depth (16 bits) in a folder, those of one moment together.
class RgbdFilesSource : public FrameSource
{
public:
  /// In the files of depths the number `depth_scale` stands for 1 m. Throws as listRgbdFiles() does.
  RgbdFilesSource(const std::string& path, double depth_scale);
  ReadResult read(Frame& frame) override;
  void rewind() override { files_.rewind(); }
  double rate() const override { return rate_; }
  bool fillsMemory() const override { return false; }
  std::string description() const override;

private:
  std::string path_;
  double depth_scale_;
  FileSequence<RgbdFiles> files_;
  double rate_;
};

}  // namespace robot_vision
