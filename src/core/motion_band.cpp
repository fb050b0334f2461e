#include "motion_band.hpp"

#include <algorithm>

#include "kernels/kernels.hpp"
#include "rects.hpp"

namespace robot_vision
{
namespace
{

int rowsOfDilation(int dilate)
{
  return 2 * dilate + 1;
}

}  // namespace

void MotionBand::run(const MotionComparison& comparison, const cv::Range& rows, cv::Mat& mask)
{
  const cv::Size size = comparison.picture.pixels.size();
  const int dilate = comparison.dilate;
  grown_ = grown(comparison.part, dilate, size);
  const int bottom = comparison.part.br().y;
  const int begin_y = grown_.y + rows.start;
  const int end_y = grown_.y + rows.end;
  begin(comparison, std::max(begin_y - dilate, comparison.part.y));
  for (int y = begin_y; y < end_y; ++y)
  {
    const int first = std::max(y - dilate, comparison.part.y);
    const int end = std::min(y + dilate + 1, bottom);
    while (next_ < end)
      dilateNext(comparison);
    united_.clear();
    for (int i = first; i < end; ++i)
      united_.push_back(dilatedRow(dilate, i));
    kernels().unite(united_.data(), end - first, grown_.width, mask.ptr(y, grown_.x));
  }
}

void MotionBand::begin(const MotionComparison& comparison, int first)
{
  const int half = comparison.blur->half();
  outer_ = grown(comparison.part, half, comparison.picture.pixels.size());
  const int inner = first - outer_.y;  // the same row of the outer part
  const int window = GaussRows::window(*comparison.blur);
  gray_.begin(comparison.picture.pixels(outer_), comparison.picture.encoding, std::max(inner - half, 0), window);
  blurred_.begin(gray_, *comparison.blur, inner);
  if (comparison.reference.blurred.empty())
  {
    reference_gray_.begin(comparison.reference.gray(outer_), "mono8", std::max(inner - half, 0), window);
    reference_blurred_.begin(reference_gray_, *comparison.blur, inner);
  }
  next_ = first;
  marked_.resize(1, grown_.width + 2 * comparison.dilate);
  dilated_.resize(rowsOfDilation(comparison.dilate), grown_.width);
}

void MotionBand::dilateNext(const MotionComparison& comparison)
{
  const cv::Rect& part = comparison.part;
  const cv::Mat& kept = comparison.reference.blurred;
  const int in_outer = part.x - outer_.x;
  const std::uint8_t* const picture = blurred_.next() + in_outer;
  const std::uint8_t* const reference = kept.empty() ? reference_blurred_.next() + in_outer : kept.ptr(next_, part.x);
  // What is `dilate` px after a place here is at that place in the mask.
  marked_.fill(0);
  std::uint8_t* const marked = marked_[0] + part.x - grown_.x + comparison.dilate;
  kernels().mark_differences(picture, reference, comparison.threshold, part.width, marked);
  united_.clear();
  for (int i = 0; i < rowsOfDilation(comparison.dilate); ++i)
    united_.push_back(marked_[0] + i);
  kernels().unite(united_.data(), rowsOfDilation(comparison.dilate), grown_.width,
                  dilatedRow(comparison.dilate, next_));
  ++next_;
}

std::uint8_t* MotionBand::dilatedRow(int dilate, int y)
{
  return dilated_[y % rowsOfDilation(dilate)];
}

}  // namespace robot_vision
