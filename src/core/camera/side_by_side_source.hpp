#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// The left (0) or the right (1) half of an image of any encoding but jpeg. It shares the image's pixels, but for yu12,
/// whose half is written to `copy`. Throws std::invalid_argument naming the size and what was expected if the image has
/// no two halves of the same layout: its width must be even, or a multiple of 4 where pixels go in pairs.
cv::Mat halfOf(const cv::Mat& image, const std::string& encoding, int side, cv::Mat& copy);

/// A stereo camera that gives both of its images in one frame, the left one in the left half. What is JPEG is decoded
/// to bgr8. Frames that cannot be divided are refused.
class SideBySideSource : public FrameSource
{
public:
  explicit SideBySideSource(std::unique_ptr<FrameSource> frames) : frames_(std::move(frames)) {}

  ReadResult read(Frame& frame) override;
  void rewind() override { frames_->rewind(); }
  double rate() const override { return frames_->rate(); }
  double period() const override { return frames_->period(); }
  bool fillsMemory() const override { return false; }
  std::shared_ptr<V4l2Device> device() const override { return frames_->device(); }
  std::string description() const override { return frames_->description() + ", two images side by side"; }
  std::string warning() const override { return frames_->warning(); }

private:
  void divide(Frame& frame);

  std::unique_ptr<FrameSource> frames_;
  std::int64_t refused_ = 0;       // number of frames that could not be divided
  cv::Mat memory_;                 // for a source that fills what it is given
  cv::Mat decoded_;                // the pixels of a JPEG
  std::array<cv::Mat, 2> halves_;  // that share no pixels with the frame
};

}  // namespace robot_vision
