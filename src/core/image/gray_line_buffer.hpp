#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "aligned_rows.hpp"

namespace robot_vision
{

/// The gray rows of a picture, as toGray() makes them, from top to bottom. Only a window of them is kept, which stays
/// in the processor's cache; of a gray picture they are its own.
class GrayLineBuffer
{
public:
  /// Whether rows of this encoding can be converted by themselves.
  static bool takes(const std::string& encoding);

  /// Of `image`, which has to stay, from row `first` on; `window` rows above the newest can be asked for again.
  void begin(const cv::Mat& image, const std::string& encoding, int first, int window);

  cv::Size size() const { return image_.size(); }

  /// Row `y`, valid while it is in the window.
  const std::uint8_t* row(int y);

  /// The same of a row that may be beyond the picture, as cv::BORDER_REFLECT_101 continues it.
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
  cv::Mat ring_;  // in the memory, row y in row y % ring_.rows; empty if the picture is gray
  int next_ = 0;  // the first row that is not converted
};

/// Continues a row by `reach` numbers beyond both of its ends in the same way.
template <class T>
void mirrorEnds(T* row, int width, int reach)
{
  for (int i = 1; i <= reach; ++i)
  {
    const int mirrored = i < width ? i : cv::borderInterpolate(-i, width, cv::BORDER_REFLECT_101);  // is a call
    row[-i] = row[mirrored];
    row[width - 1 + i] = row[width - 1 - mirrored];
  }
}

}  // namespace robot_vision
