#include "motion_band.hpp"

#include <algorithm>
#include <utility>

#include "kernels/kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBlock = 64;  // px, side by side, that are blurred or not
static_assert(kBlock % GaussRows::kColumns == 0, "spans are of blocks");

constexpr int kAssumed =
    16;  // rows after some of which most blocks differ: to look at them would cost more than it saves

void prefetch(const std::uint8_t* bytes, int count)
{
  constexpr int kLine = 64;  // of the cache
  for (int i = 0; i < count; i += kLine)
    __builtin_prefetch(bytes + i);
}

}  // namespace

void MotionBand::run(const MotionComparison& comparison, const cv::Range& rows, cv::Mat& mask)
{
  const cv::Rect& part = comparison.part;
  const int dilate = comparison.dilate;
  begin(comparison, std::max(rows.start - dilate, 0));
  for (int y = rows.start; y < rows.end; ++y)
  {
    const int end = std::min(y + dilate + 1, part.height);
    while (next_ < end)
      makeNext(comparison);
    united_.clear();
    for (int i = std::max(y - dilate, 0); i < end; ++i)
      united_.push_back(dilated(i));
    kernels().unite(united_.data(), static_cast<int>(united_.size()), words_, mask_.data());
    kernels().spread_bits(mask_.data(), part.width, mask.ptr(part.y + y, part.x));
  }
}

void MotionBand::begin(const MotionComparison& comparison, int first)
{
  const cv::Rect& part = comparison.part;
  const int window = GaussRows::window(*comparison.blur);
  next_ = first;
  compared_ = assumed_ = std::max(first - comparison.blur->half(), 0);
  gray_.begin(comparison.picture.pixels(part), comparison.picture.encoding, compared_, window);
  blurred_.begin(gray_, *comparison.blur);
  if (comparison.reference.blurred.empty())
  {
    reference_gray_.begin(comparison.reference.gray(part), "mono8", compared_, window);
    reference_blurred_.begin(reference_gray_, *comparison.blur);
  }
  words_ = (part.width + kBlock - 1) / kBlock;
  near_.assign(static_cast<std::size_t>(words_), 0);
  for (int x = comparison.near.x - part.x; x < comparison.near.br().x - part.x; ++x)
    near_[static_cast<std::size_t>(x / kBlock)] |= Word{1} << x % kBlock;
  changed_.assign(static_cast<std::size_t>(words_), -part.height);
  window_ = 2 * comparison.dilate + kWeighedRows;
  marked_.resize(2, words_);
  marked_.fill(0);
  dilated_.resize(window_, words_);
  mask_.resize(static_cast<std::size_t>(words_));
}

/// Makes kWeighedRows of `dilated_`.
void MotionBand::makeNext(const MotionComparison& comparison)
{
  const int height = comparison.part.height;
  compareTo(comparison, std::min(next_ + kWeighedRows + comparison.blur->half(), height));
  findSpans(comparison);
  if (!spans_.empty()) blurred_.begin(next_, spans_);
  if (!spans_.empty() && comparison.reference.blurred.empty()) reference_blurred_.begin(next_, spans_);
  for (int i = 0; i < kWeighedRows && next_ < height; ++i, ++next_)
    mark(comparison, i);
}

void MotionBand::compareTo(const MotionComparison& comparison, int end)
{
  const cv::Rect& part = comparison.part;
  if (end <= assumed_)
  {
    std::fill(changed_.begin(), changed_.end(), end - 1);
    compared_ = end;
    return;
  }
  int different = 0;
  for (int block = 0; block < words_; ++block)
  {
    const int x = block * kBlock;
    Word differences = 0;
    for (int y = end; y-- > compared_ && differences == 0;)  // the last is all that matters
    {
      kernels().mark_differences(gray_.row(y) + x, comparison.reference.gray.ptr(part.y + y, part.x + x),
                                 comparison.threshold, std::min(kBlock, part.width - x), &differences);
      if (differences != 0) changed_[static_cast<std::size_t>(block)] = y;
    }
    different += differences != 0 ? 1 : 0;
  }
  compared_ = end;
  if (2 * different > words_) assumed_ = end + kAssumed;
}

/// Where the next rows' blur looks at pixels that differ: means of bytes that differ by whole numbers up to the
/// threshold do so too, also when they are rounded.
void MotionBand::findSpans(const MotionComparison& comparison)
{
  const auto is_changed = [&](int block)
  {
    return block >= 0 && block < words_ && changed_[static_cast<std::size_t>(block)] >= next_ - comparison.blur->half();
  };
  spans_.clear();
  for (int block = 0; block < words_; ++block)
  {
    if (!is_changed(block - 1) && !is_changed(block) && !is_changed(block + 1)) continue;
    const cv::Range span(block * kBlock, std::min((block + 1) * kBlock, comparison.part.width));
    if (!spans_.empty() && span.start - spans_.back().end <= kBlock)
      spans_.back().end = span.end;  // what is between them is looked at for both
    else
      spans_.push_back(span);
  }
}

/// Marks what differs in a row, number `i` of those that are blurred, and dilates that along the row.
void MotionBand::mark(const MotionComparison& comparison, int i)
{
  const cv::Rect& part = comparison.part;
  const cv::Mat& kept = comparison.reference.blurred;
  Word* from = marked_[0];
  Word* to = marked_[1];
  std::fill_n(from, words_, 0);
  const int y = part.y + next_;
  const bool is_near = y >= comparison.near.y && y < comparison.near.br().y;
  if (is_near && !spans_.empty())
  {
    if (!kept.empty()) prefetch(kept.ptr(y, part.x), part.width);  // it comes while the other is blurred
    const std::uint8_t* const picture = blurred_.row(i);
    const std::uint8_t* const reference = kept.empty() ? reference_blurred_.row(i) : kept.ptr(y, part.x);
    for (const cv::Range& span : spans_)
      kernels().mark_differences(picture + span.start, reference + span.start, comparison.threshold, span.size(),
                                 from + span.start / kBlock);
    for (int word = 0; word < words_; ++word)
      from[word] &= near_[static_cast<std::size_t>(word)];  // other pixels' blur looks beyond the part
  }
  for (int reach = 0; reach < comparison.dilate;)
  {
    const int places = std::min(reach + 1, comparison.dilate - reach);
    kernels().unite_neighbours(from, words_, places, to);
    std::swap(from, to);
    reach += places;
  }
  std::copy_n(from, words_, dilated(next_));
}

}  // namespace robot_vision
