#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "aligned_rows.hpp"

namespace robot_vision
{

/// Converts the rows of an image to gray as toGray() does, from top to bottom. Only a window of them is kept, which
/// stays in the processor's cache. The rows of a gray image are not copied.
class GrayLineBuffer
{
public:
  /// Whether the encoding can be converted row by row.
  static bool takes(const std::string& encoding);

  /// Begins an image at row `first`. `image` must outlive the calls that follow. The newest row and `window` rows above
  /// it can be asked for.
  void begin(const cv::Mat& image, const std::string& encoding, int first, int window);

  cv::Size size() const { return image_.size(); }

  /// Row `y`; the pointer is valid while the row is in the window.
  const std::uint8_t* row(int y);

  /// Row `y`, which may be outside of the image, as cv::BORDER_REFLECT_101 continues it.
  const std::uint8_t* mirroredRow(int y)
  {
    const bool is_beyond = y < 0 || y >= size().height;
    return row(is_beyond ? cv::borderInterpolate(y, size().height, cv::BORDER_REFLECT_101) : y);
  }

private:
  void convertNext();

  cv::Mat image_;
  std::string encoding_;
  AlignedRows<std::uint8_t> memory_;
  cv::Mat ring_;  // shares memory_; row y is in row y % ring_.rows; empty if the image is gray
  int next_ = 0;  // the first row that is not converted yet
};

/// Continues a row by `reach` numbers beyond both of its ends, as cv::BORDER_REFLECT_101 does.
template <class T>
void mirrorEnds(T* row, int width, int reach)
{
  for (int i = 1; i <= reach; ++i)
  {
    const int mirrored = i < width ? i : cv::borderInterpolate(-i, width, cv::BORDER_REFLECT_101);  // a slow call
    row[-i] = row[mirrored];
    row[width - 1 + i] = row[width - 1 - mirrored];
  }
}

/// The rows of a GrayLineBuffer, continued as cv::BORDER_REFLECT_101 does, for BoxFilterRows. The window of the buffer
/// must have one row more than the box, and the buffer must outlive this.
struct MirroredRows
{
  GrayLineBuffer* gray = nullptr;

  int width() const { return gray->size().width; }
  int channels() const { return 1; }
  const std::uint8_t* row(int y) const { return gray->mirroredRow(y); }

  template <class T>
  void extend(T* row, int margin) const
  {
    mirrorEnds(row, width(), margin);
  }
};

}  // namespace robot_vision
