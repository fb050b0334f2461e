#include "side_by_side_source.hpp"

#include <stdexcept>

#include "core/common/starts_with.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// How many columns of an image go together: two of them share their chroma, or are different in a Bayer pattern.
int columnsTogether(const std::string& encoding)
{
  const bool shares_chroma = startsWith(encoding, "yuv422") || startsWith(encoding, "nv") || encoding == "yu12";
  return shares_chroma || startsWith(encoding, "bayer") ? 2 : 1;
}

/// Half of a yu12 image. In each row of its chroma there are two rows of a plane, one beside the other.
void copyHalf(const cv::Mat& image, int side, cv::Mat& copy)
{
  const int width = image.cols / 2, luma_rows = image.rows * 2 / 3;
  copy.create(image.rows, width, CV_8UC1);
  image(cv::Rect(side * width, 0, width, luma_rows)).copyTo(copy.rowRange(0, luma_rows));
  const cv::Mat chroma = image.rowRange(luma_rows, image.rows);
  cv::Mat half_chroma = copy.rowRange(luma_rows, image.rows);
  const int half_row = width / 2;
  for (int row = 0; row < 2; ++row)  // of the two that are side by side
  {
    const int begin = row * width + side * half_row;
    chroma.colRange(begin, begin + half_row).copyTo(half_chroma.colRange(row * half_row, (row + 1) * half_row));
  }
}

}  // namespace

cv::Mat halfOf(const cv::Mat& image, const std::string& encoding, int side, cv::Mat& copy)
{
  const int multiple = 2 * columnsTogether(encoding);
  const cv::Size size = imageSize(image, encoding);
  if (size.width % multiple != 0)
    throw std::invalid_argument(
        "a " + encoding + " image of " + toText(size) +
        " cannot be divided into a left and a right one: expected its width to be a multiple of " +
        std::to_string(multiple));
  if (encoding != "yu12") return image.colRange(side * image.cols / 2, (side + 1) * image.cols / 2);
  copyHalf(image, side, copy);
  return copy;
}

ReadResult SideBySideSource::read(Frame& frame)
{
  frame.image = memory_;
  const ReadResult result = frames_->read(frame);
  if (result != ReadResult::kFrame) return result;
  if (frames_->fillsMemory()) memory_ = frame.image;
  try
  {
    divide(frame);
  }
  catch (const std::invalid_argument&)
  {
    ++refused_;  // whose number is taken out of the sequence, so that it does not count as lost as well
    throw;
  }
  frame.sequence -= refused_;
  return result;
}

void SideBySideSource::divide(Frame& frame)
{
  const bool wanted = frame.wanted.first || frame.wanted.second;
  if (wanted && frame.encoding == "jpeg")
  {
    toBgr(frame.image, frame.encoding, decoded_);
    frame.image = decoded_;
    frame.encoding = "bgr8";
  }
  const cv::Mat both = frame.image;
  const auto half = [&](bool is_wanted, int side)
  { return is_wanted ? halfOf(both, frame.encoding, side, halves_[static_cast<std::size_t>(side)]) : cv::Mat(); };
  frame.image = half(frame.wanted.first, 0);
  frame.second = {half(frame.wanted.second, 1), frame.encoding};
}

}  // namespace robot_vision
