#include "gray_line_buffer.hpp"

#include <algorithm>

#include "core/common/starts_with.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kRowsPerBatch = 16;  // few enough for the cache, many enough for the cost of a call not to matter

}  // namespace

bool GrayLineBuffer::takes(const std::string& encoding)
{
  // What only cameras give is planar, compressed or rare, and a row of a mosaic depends on the rows around it.
  return isMessageEncoding(encoding) && !startsWith(encoding, "bayer");
}

void GrayLineBuffer::begin(const cv::Mat& image, const std::string& encoding, int first, int window)
{
  image_ = cv::Mat(image.size(), image.type(), image.data, image.step);  // does not keep the memory alive
  encoding_ = encoding;
  ring_ = cv::Mat();
  if (encoding != "mono8")
  {
    const int rows = ((window + kRowsPerBatch - 1) / kRowsPerBatch + 1) * kRowsPerBatch;
    memory_.resize(rows, image.cols);
    ring_ = cv::Mat(rows, image.cols, CV_8UC1, memory_[0], memory_.stride());
  }
  next_ = first / kRowsPerBatch * kRowsPerBatch;
}

const std::uint8_t* GrayLineBuffer::row(int y)
{
  if (ring_.empty()) return image_.ptr(y);
  while (y >= next_)
    convertNext();
  return ring_.ptr(y % ring_.rows);
}

void GrayLineBuffer::convertNext()
{
  const int end = std::min(next_ + kRowsPerBatch, image_.rows);
  const int at = next_ % ring_.rows;
  cv::Mat band = ring_.rowRange(at, at + end - next_);
  toGray(image_.rowRange(next_, end), encoding_, band);
  next_ = end;
}

}  // namespace robot_vision
