#include "haar_search.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr int kRowQuantum = 128;        // integers: a layout serves images of about the same width
constexpr int kRowOffset = 16;          // integers, so that a column's integers do not all share one set of the cache
constexpr int kBandRows = 32;           // even: what is looked at stays in the cache meanwhile
constexpr double kStripeWidth = 32.0;   // px
constexpr float kMinStep1Scale = 2.0F;  // from which on all windows are looked at, not every other one

cv::Size shrunk(const cv::Size& size, float scale)
{
  return {cvRound(static_cast<float>(size.width) / scale), cvRound(static_cast<float>(size.height) / scale)};
}

}  // namespace

HaarSearch::HaarSearch(std::shared_ptr<const HaarCascade> cascade) : cascade_(std::move(cascade))
{
}

std::vector<cv::Rect> HaarSearch::find(const cv::Mat& gray, const std::vector<double>& factors,
                                       const std::atomic<bool>* stop)
{
  std::vector<cv::Rect> found;
  int stripes = 0;
  for (const double factor : factors)
  {
    if (stop && *stop) return {};
    const auto scale = static_cast<float>(factor);
    if (stripes == 0)
      stripes = std::max(cvCeil((shrunk(gray.size(), scale).width + 1 - cascade_->window.width) / kStripeWidth), 1);
    findAtScale(gray, scale, stripes, found);
  }
  return found;
}

/// Looks at the windows of one scale. OpenCV divides the rows into stripes, of which the last one may end one row too
/// early.
void HaarSearch::findAtScale(const cv::Mat& gray, float scale, int stripes, std::vector<cv::Rect>& found)
{
  const cv::Size window = cascade_->window, size = shrunk(gray.size(), scale);
  const int step = scale >= kMinStep1Scale ? 1 : 2;
  const int columns = size.width + 1 - window.width, rows = size.height + 1 - window.height;
  if (columns <= 0 || rows <= 0) return;
  const int stripe = std::max((rows / step + stripes - 1) / stripes, 1) * step;
  cv::resize(gray, scaled_, size, 0.0, 0.0, cv::INTER_LINEAR_EXACT);
  PlacedCascade& placed = step == 1 ? whole_ : split_;
  const int row = (size.width + 1 + kHaarMargin) / kRowQuantum * kRowQuantum + kRowQuantum + kRowOffset;
  if (placed.layout.row < row) placed = PlacedCascade(*cascade_, {row, step == 1 ? 0 : row / 2});
  integrate(placed.layout);

  const int count = (columns + step - 1) / step, end = std::min(stripes * stripe, rows);
  const cv::Size side(cvRound(static_cast<float>(window.width) * scale),
                      cvRound(static_cast<float>(window.height) * scale));
  for (int y = 0; y < end; y += kBandRows)
  {
    const int left = look(placed, y, {count, std::min(kBandRows, end - y)});
    for (int i = 0; i < left; ++i)
    {
      const std::int32_t at = windows_[static_cast<std::size_t>(i)];
      const auto column = static_cast<float>(at % placed.layout.row * step);
      const auto line = static_cast<float>(y + at / placed.layout.row);
      found.emplace_back(cv::Point(cvRound(column * scale), cvRound(line * scale)), side);
    }
  }
}

/// Looks at the windows of a band of rows, so many in each: of those that no stage rejects windows_ has the indices
/// in the band. Returns how many these are.
int HaarSearch::look(const PlacedCascade& placed, int first_row, const cv::Size& windows)
{
  const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(first_row) * placed.layout.row;
  const Band band{placed.layout, sums_.data() + at, squares_.data() + at};
  const HaarKernels& kernel = kernels<HaarKernels>();
  int left = list(placed, band, windows);
  for (std::size_t stage = 1; stage < placed.stages.size() && left > 0; ++stage)
    left = kernel.keep(placed.stages[stage], band.sums, factors_.data(), windows_.data(), left, verdicts_.data());
  const auto rejected = [&](std::int32_t window)
  { return verdicts_[static_cast<std::size_t>(window)] == kUnsure && !passes(band, window); };
  return static_cast<int>(std::remove_if(windows_.begin(), windows_.begin() + left, rejected) - windows_.begin());
}

/// Lists the windows that the first stage does not reject; returns how many.
int HaarSearch::list(const PlacedCascade& placed, const Band& band, const cv::Size& windows)
{
  const cv::Size window = cascade_->window;
  const auto corner = [&](int x, int y) { return band.layout.indexOf(x, y); };
  const HaarCorners inner = {corner(1, 1), corner(window.width - 1, 1), corner(1, window.height - 1),
                             corner(window.width - 1, window.height - 1)};
  const double area = (window.width - 2.0) * (window.height - 2.0);
  const HaarKernels& kernel = kernels<HaarKernels>();
  int listed = 0;
  const int step = band.layout.half == 0 ? 1 : 2;
  for (int y = 0; y < windows.height; y += step)
  {
    const int at = y * band.layout.row;
    float* const factors = factors_.data() + at;
    if (kernel.contrasts(band.sums + at, band.squares + at, inner, area, windows.width, factors) == 0) continue;
    kernel.judge(placed.stages.front(), band.sums + at, factors, windows.width, verdicts_.data() + at);
    listed = visit(band, at, windows.width, listed);
  }
  return listed;
}

/// Lists the windows of a row, from an index on, behind those that are listed. The one behind a window that the first
/// stage rejects is not looked at.
int HaarSearch::visit(const Band& band, int first, int count, int listed)
{
  windows_.resize(std::max(windows_.size(), static_cast<std::size_t>(listed + count + 1)));
  for (int at = first; at < first + count; ++at)
  {
    std::int32_t verdict = verdicts_[static_cast<std::size_t>(at)];
    if (verdict == kUnsure)
    {
      const HaarStage& stage = cascade_->stages.front();
      verdict = votes(band, stage, at) < static_cast<double>(stage.threshold) ? kRejected : kPassed;
    }
    windows_[static_cast<std::size_t>(listed)] = at;
    listed += verdict == kPassed ? 1 : 0;
    at += verdict == kRejected ? 1 : 0;
  }
  return listed;
}

/// A stage's votes for a window, added in OpenCV's order.
double HaarSearch::votes(const Band& band, const HaarStage& stage, std::int32_t window) const
{
  const std::int32_t* const sums = band.sums + window;
  const auto sum = [&](int x, int y) { return sums[band.layout.indexOf(x, y)]; };
  double votes = 0.0;
  for (const HaarStump& stump : stage.stumps)
  {
    float feature = 0.0F;  // a whole number, which a float has exactly
    for (const HaarRectangle& rectangle : stump.rectangles)
    {
      const cv::Point begin = rectangle.box.tl(), end = rectangle.box.br();
      const int pixels = sum(begin.x, begin.y) - sum(end.x, begin.y) - sum(begin.x, end.y) + sum(end.x, end.y);
      feature += rectangle.weight * static_cast<float>(pixels);
    }
    const bool below = feature * factors_[static_cast<std::size_t>(window)] < stump.threshold;
    votes += static_cast<double>(below ? stump.below : stump.above);
  }
  return votes;
}

/// Whether no stage rejects a window, without any rounding.
bool HaarSearch::passes(const Band& band, std::int32_t window) const
{
  const auto rejects = [&](const HaarStage& stage)
  { return votes(band, stage, window) < static_cast<double>(stage.threshold); };
  return std::none_of(cascade_->stages.begin(), cascade_->stages.end(), rejects);
}

/// Sets the integral images of the scaled image. Those of the squares overflow.
void HaarSearch::integrate(const HaarLayout& layout)
{
  const auto row = static_cast<std::size_t>(layout.row);
  const std::size_t needed = row * static_cast<std::size_t>(scaled_.rows + 1) + kHaarMargin;
  if (sums_.size() < needed)
  {
    sums_.assign(needed, 0);
    squares_.assign(needed, 0);
  }
  factors_.resize(std::max(factors_.size(), row * kBandRows + kHaarMargin));
  verdicts_.resize(factors_.size());
  std::fill_n(sums_.begin(), row, 0);
  std::fill_n(squares_.begin(), row, 0);
  for (int y = 0; y < scaled_.rows; ++y)
  {
    const std::uint8_t* pixels = scaled_.ptr(y);
    std::int32_t* const sums = sums_.data() + row * static_cast<std::size_t>(y + 1);
    std::int32_t* const squares = squares_.data() + row * static_cast<std::size_t>(y + 1);
    std::uint32_t sum = 0, square = 0;
    sums[0] = squares[0] = 0;
    const auto put = [&](int x, int index)
    {
      const std::uint32_t pixel = pixels[x];
      sum += pixel;
      square += pixel * pixel;
      sums[index] = static_cast<std::int32_t>(static_cast<std::uint32_t>(sums[index - layout.row]) + sum);
      squares[index] = static_cast<std::int32_t>(static_cast<std::uint32_t>(squares[index - layout.row]) + square);
    };
    if (layout.half == 0)
      for (int x = 0; x < scaled_.cols; ++x)
        put(x, x + 1);
    else
      for (int x = 0; x < scaled_.cols; ++x)
        put(x, layout.indexOf(x + 1, 0));
  }
}

}  // namespace robot_vision
