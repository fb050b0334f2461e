#include "motion_stripe.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr int kBlock = kWordBits;  // px, side by side, that are blurred or not
static_assert(kBlock % GaussianFilterRows::kColumns == 0, "spans are of blocks");

constexpr int kAssumed = 16;  // rows that are not compared after some in which most blocks differ: it would not pay

void prefetch(const std::uint8_t* bytes, int count)
{
  constexpr int kLine = 64;  // of the cache
  for (int i = 0; i < count; i += kLine)
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
    const auto is_white = [](Word word) { return word != 0; };
    const auto first = std::find_if(mask_.begin(), mask_.end(), is_white);
    if (first == mask_.end()) continue;
    const auto last = std::find_if(mask_.rbegin(), mask_.rend(), is_white).base();
    const auto column = [&](auto word) { return std::min(static_cast<int>(word - mask_.begin()) * kBlock, mask.cols); };
    part |= cv::Rect({column(first), y}, cv::Point(column(last), y + 1));
  }
  return part;
}

void MotionStripe::begin(const MotionComparison& comparison, int first)
{
  const cv::Mat& picture = comparison.picture.pixels;
  const int window = GaussianFilterRows::window(*comparison.blur);
  next_ = first;
  compared_ = assumed_ = std::max(first - comparison.blur->half(), 0);
  gray_.begin(picture, comparison.picture.encoding, compared_, window);
  blurred_.begin(gray_, *comparison.blur);
  if (comparison.reference.blurred.empty())
  {
    reference_gray_.begin(comparison.reference.gray, "mono8", compared_, window);
    reference_blurred_.begin(reference_gray_, *comparison.blur);
  }
  words_ = (picture.cols + kBlock - 1) / kBlock;
  changed_.assign(static_cast<std::size_t>(words_), std::numeric_limits<int>::min());
  window_ = 2 * comparison.dilate + kWeighedRows;
  marked_.resize(2, words_);
  marked_.fill(0);
  dilated_.resize(window_, words_);
  mask_.resize(static_cast<std::size_t>(words_));
}

/// Makes kWeighedRows of `dilated_`.
void MotionStripe::makeNext(const MotionComparison& comparison)
{
  const int height = comparison.reference.gray.rows;
  compareTo(comparison, std::min(next_ + kWeighedRows + comparison.blur->half(), height));
  findSpans(comparison);
  if (!spans_.empty()) blurred_.begin(next_, spans_);
  if (!spans_.empty() && comparison.reference.blurred.empty()) reference_blurred_.begin(next_, spans_);
  for (int i = 0; i < kWeighedRows && next_ < height; ++i, ++next_)
    mark(comparison, i);
}

void MotionStripe::compareTo(const MotionComparison& comparison, int end)
{
  if (end <= assumed_)
  {
    std::fill(changed_.begin(), changed_.end(), end - 1);
    compared_ = end;
    return;
  }
  const cv::Mat& reference = comparison.reference.gray;
  Word* const different = marked_[0];
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
  if (2 * blocks > words_) assumed_ = end + kAssumed;
}

/// Where the next rows' blur looks at pixels that differ: means of bytes that differ by whole numbers up to the
/// threshold do so too, also when they are rounded.
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
    const cv::Range span(block * kBlock, std::min((block + 1) * kBlock, comparison.reference.gray.cols));
    if (!spans_.empty() && span.start - spans_.back().end <= kBlock)
      spans_.back().end = span.end;  // what is between them is looked at for both
    else
      spans_.push_back(span);
  }
}

/// Marks what differs in a row, number `i` of those that are blurred, and dilates that along the row.
void MotionStripe::mark(const MotionComparison& comparison, int i)
{
  const cv::Mat& kept = comparison.reference.blurred;
  Word* from = marked_[0];
  Word* to = marked_[1];
  std::fill_n(from, words_, 0);
  if (!spans_.empty())
  {
    for (const cv::Range& span : spans_)  // it comes while the other is blurred
      if (!kept.empty()) prefetch(kept.ptr(next_, span.start), span.size());
    const std::uint8_t* const picture = blurred_.row(i);
    const std::uint8_t* const reference = kept.empty() ? reference_blurred_.row(i) : kept.ptr(next_);
    for (const cv::Range& span : spans_)
      kernels<BitKernels>().mark_differences(picture + span.start, reference + span.start, comparison.threshold,
                                             span.size(), from + span.start / kBlock);
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
