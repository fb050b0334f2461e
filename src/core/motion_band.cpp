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

/// Writes to `spread` for each pixel the largest of itself and those up to `reach` after it; `row` is used up.
void spreadRow(std::uint8_t* row, int reach, int count, std::uint8_t* spread)
{
  int done = 0;  // after a pixel
  do
  {
    const int step = std::min(done + 1, reach - done);
    done += step;
    kernels().unite(row, row + step, count + reach - done, done == reach ? spread : row);
  } while (done < reach);
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
    std::uint8_t* const out = mask.ptr(y, grown_.x);
    const std::uint8_t* united = dilatedRow(dilate, first);
    for (int i = std::min(first + 1, end - 1); i < end; ++i)  // of a single row with itself
    {
      kernels().unite(united, dilatedRow(dilate, i), grown_.width, out);
      united = out;
    }
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
  marked_.resize(static_cast<std::size_t>(grown_.width + 2 * comparison.dilate));
  dilated_.resize(static_cast<std::size_t>(grown_.width * rowsOfDilation(comparison.dilate)));
}

void MotionBand::dilateNext(const MotionComparison& comparison)
{
  const cv::Rect& part = comparison.part;
  const cv::Mat& kept = comparison.reference.blurred;
  const int in_outer = part.x - outer_.x;
  const std::uint8_t* const picture = blurred_.next() + in_outer;
  const std::uint8_t* const reference = kept.empty() ? reference_blurred_.next() + in_outer : kept.ptr(next_, part.x);
  // What is `dilate` px after a place here is at that place in the mask.
  std::fill(marked_.begin(), marked_.end(), std::uint8_t{0});
  std::uint8_t* const marked = marked_.data() + part.x - grown_.x + comparison.dilate;
  kernels().mark_differences(picture, reference, comparison.threshold, part.width, marked);
  spreadRow(marked_.data(), 2 * comparison.dilate, grown_.width, dilatedRow(comparison.dilate, next_));
  ++next_;
}

std::uint8_t* MotionBand::dilatedRow(int dilate, int y)
{
  return dilated_.data() + static_cast<std::ptrdiff_t>(y % rowsOfDilation(dilate)) * grown_.width;
}

}  // namespace robot_vision
