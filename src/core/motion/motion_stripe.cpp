#include "motion_stripe.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr int kBlockWidth = kWordBits;  // px; a row is blurred by whole blocks
static_assert(kBlockWidth % GaussianFilterRows::kColumns == 0, "spans consist of blocks");

constexpr int kUncomparedRows = 16;  // after rows in which most blocks differ, where comparing would save no work

void prefetch(const std::uint8_t* bytes, int count)
{
  constexpr int kCacheLine = 64;  // bytes
  for (int i = 0; i < count; i += kCacheLine)
    __builtin_prefetch(bytes + i);
}

}  // namespace

cv::Rect MotionStripe::run(const MotionComparison& comparison, const cv::Range& rows, cv::Mat& mask)
{
  const int dilate = comparison.dilate;
  begin(comparison, std::max(rows.start - dilate, 0));
  cv::Rect part;
  for (int y = rows.start; y < rows.end; ++y)
  {
    const int end = std::min(y + dilate + 1, mask.rows);
    while (next_ < end)
      makeNext(comparison);
    united_.clear();
    for (int i = std::max(y - dilate, 0); i < end; ++i)
      united_.push_back(dilated(i));
    kernels<BitKernels>().unite(united_.data(), static_cast<int>(united_.size()), words_, mask_.data());
    kernels<BitKernels>().spread_bits(mask_.data(), mask.cols, mask.ptr(y));
    const auto is_white = [](BitWord word) { return word != 0; };
    const auto first = std::find_if(mask_.begin(), mask_.end(), is_white);
    if (first == mask_.end()) continue;
    const auto last = std::find_if(mask_.rbegin(), mask_.rend(), is_white).base();
    const auto column = [&](auto word)
    { return std::min(static_cast<int>(word - mask_.begin()) * kBlockWidth, mask.cols); };
    part |= cv::Rect({column(first), y}, cv::Point(column(last), y + 1));
  }
  return part;
}

/// Prepares for rows of `dilated_` from `first` on.
void MotionStripe::begin(const MotionComparison& comparison, int first)
{
  const cv::Mat& image = comparison.image.pixels;
  const int window = GaussianFilterRows::window(*comparison.blur);
  next_ = first;
  compared_ = assumed_ = std::max(first - comparison.blur->half(), 0);
  gray_.begin(image, comparison.image.encoding, compared_, window);
  blurred_.begin(gray_, *comparison.blur);
  if (comparison.reference.blurred.empty())
  {
    reference_gray_.begin(comparison.reference.gray, "mono8", compared_, window);
    reference_blurred_.begin(reference_gray_, *comparison.blur);
  }
  words_ = (image.cols + kBlockWidth - 1) / kBlockWidth;
  changed_.assign(static_cast<std::size_t>(words_), std::numeric_limits<int>::min());
  window_ = 2 * comparison.dilate + kRowsAtOnce;
  marked_.resize(2, words_);
  marked_.fill(0);
  dilated_.resize(window_, words_);
  mask_.resize(static_cast<std::size_t>(words_));
}

/// Makes kRowsAtOnce of `dilated_`.
void MotionStripe::makeNext(const MotionComparison& comparison)
{
  const int height = comparison.reference.gray.rows;
  compareTo(comparison, std::min(next_ + kRowsAtOnce + comparison.blur->half(), height));
  findSpans(comparison);
  if (!spans_.empty()) blurred_.begin(next_, spans_);
  if (!spans_.empty() && comparison.reference.blurred.empty()) reference_blurred_.begin(next_, spans_);
  for (int i = 0; i < kRowsAtOnce && next_ < height; ++i, ++next_)
    mark(comparison, i);
}

/// Notes in `changed_` which blocks differ in the rows before `end`.
void MotionStripe::compareTo(const MotionComparison& comparison, int end)
{
  if (end <= assumed_)
  {
    std::fill(changed_.begin(), changed_.end(), end - 1);
    compared_ = end;
    return;
  }
  const cv::Mat& reference = comparison.reference.gray;
  BitWord* const different = marked_[0];
  int blocks = 0;
  for (int y = compared_; y < end; ++y)
  {
    kernels<BitKernels>().mark_differences(gray_.row(y), reference.ptr(y), comparison.threshold, reference.cols,
                                           different);
    for (int block = 0; block < words_; ++block)
    {
      int& changed = changed_[static_cast<std::size_t>(block)];
      if (different[block] == 0) continue;
      if (changed < compared_) ++blocks;
      changed = y;
    }
  }
  compared_ = end;
  if (2 * blocks > words_) assumed_ = end + kUncomparedRows;
}

/// Finds the spans of columns in which the next rows can differ once they are blurred: those for which the Gaussian has
/// pixels that differ by more than the threshold in its window. Elsewhere the blurred pixels, as rounded means of such
/// that differ by no more than a whole number, do not differ by more than that either.
void MotionStripe::findSpans(const MotionComparison& comparison)
{
  const auto is_changed = [&](int block)
  {
    return block >= 0 && block < words_ && changed_[static_cast<std::size_t>(block)] >= next_ - comparison.blur->half();
  };
  spans_.clear();
  for (int block = 0; block < words_; ++block)
  {
    if (!is_changed(block - 1) && !is_changed(block) && !is_changed(block + 1)) continue;
    const cv::Range span(block * kBlockWidth, std::min((block + 1) * kBlockWidth, comparison.reference.gray.cols));
    if (!spans_.empty() && span.start - spans_.back().end <= kBlockWidth)
      spans_.back().end = span.end;  // the blur of both needs what is between them
    else
      spans_.push_back(span);
  }
}

/// Marks the pixels that differ in row `i` of those that were blurred at once, and dilates the marks along the row.
void MotionStripe::mark(const MotionComparison& comparison, int i)
{
  const cv::Mat& kept = comparison.reference.blurred;
  BitWord* from = marked_[0];
  BitWord* to = marked_[1];
  std::fill_n(from, words_, 0);
  if (!spans_.empty())
  {
    for (const cv::Range& span : spans_)  // the reference comes into the cache while the image is blurred
      if (!kept.empty()) prefetch(kept.ptr(next_, span.start), span.size());
    const std::uint8_t* const image = blurred_.row(i);
    const std::uint8_t* const reference = kept.empty() ? reference_blurred_.row(i) : kept.ptr(next_);
    for (const cv::Range& span : spans_)
      kernels<BitKernels>().mark_differences(image + span.start, reference + span.start, comparison.threshold,
                                             span.size(), from + span.start / kBlockWidth);
  }
  for (int reach = 0; reach < comparison.dilate;)
  {
    const int places = std::min(reach + 1, comparison.dilate - reach);
    kernels<BitKernels>().unite_neighbours(from, words_, places, to);
    std::swap(from, to);
    reach += places;
  }
  std::copy_n(from, words_, dilated(next_));
}

}  // namespace robot_vision
