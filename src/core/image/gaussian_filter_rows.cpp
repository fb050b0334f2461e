#include "gaussian_filter_rows.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

constexpr int kMargin = 64;      // px that kernels may touch beyond the end of a row
constexpr int kWeightSum = 256;  // sum of all weights
constexpr std::uint8_t kImpulse = 255;

}  // namespace

GaussWeights::GaussWeights(int size, double sigma) : size_(size), sigma_(sigma), half_(size / 2)
{
  // A row with a single white pixel (255) becomes 255/256 of each weight, rounded, which is the weight itself up to
  // 127. Only the middle one can be larger; it is what the others leave of the sum.
  cv::Mat row(1, 2 * size + 1, CV_8UC1, cv::Scalar(0));
  row.at<std::uint8_t>(size) = kImpulse;
  cv::GaussianBlur(row, row, {size, size}, sigma);
  std::vector<std::uint16_t> beside;  // the weights on one side of the middle
  for (int j = 1; j <= half_; ++j)
    beside.push_back(row.at<std::uint8_t>(size + j));
  while (!beside.empty() && beside.back() == 0)  // large windows end in weights of 0
    beside.pop_back();
  half_ = static_cast<int>(beside.size());
  words_.assign(static_cast<std::size_t>(2 * (kWeightMargin + half_) + 1), 0);
  const auto middle = words_.begin() + kWeightMargin + half_;
  std::copy(beside.begin(), beside.end(), middle + 1);
  std::reverse_copy(beside.begin(), beside.end(), middle - half_);
  *middle = static_cast<std::uint16_t>(std::accumulate(words_.begin(), words_.end(), kWeightSum, std::minus<>()));
  bytes_.assign(words_.begin(), words_.end());
}

bool GaussWeights::areExact() const
{
  cv::Mat image(100, 150, CV_8UC1);
  cv::RNG().fill(image, cv::RNG::UNIFORM, 0, 256);
  image.colRange(0, 50).setTo(255);  // stays white only if the weights add up
  cv::Mat expected;
  cv::GaussianBlur(image, expected, {size_, size_}, sigma_);
  GrayLineBuffer gray;
  gray.begin(image, "mono8", 0, GaussianFilterRows::window(*this));
  GaussianFilterRows rows;
  rows.begin(gray, *this);
  for (int y = 0; y < image.rows; ++y)
  {
    const int i = y % kRowsAtOnce;
    if (i == 0) rows.begin(y, {{0, image.cols}});
    const std::uint8_t* const row = rows.row(i);
    if (!std::equal(row, row + image.cols, expected.ptr(y))) return false;
  }
  return true;
}

void GaussianFilterRows::begin(GrayLineBuffer& rows, const GaussWeights& weights)
{
  rows_ = &rows;
  weights_ = &weights;
  sums_.resize(kRowsAtOnce, rows.size().width + 2 * weights.half() + 2 * kMargin);
  means_.resize(1, rows.size().width + kMargin);
}

void GaussianFilterRows::begin(int y, const std::vector<cv::Range>& spans)
{
  window_.clear();
  for (int i = 0; i < window(*weights_); ++i)
    window_.push_back(rows_->mirroredRow(y - weights_->half() + i));
  spans_ = spans;
  if (weights_->half() == 0) return;
  for (const cv::Range& span : spans_)
    convolveColumns(span);
}

void GaussianFilterRows::convolveColumns(const cv::Range& span)
{
  const int half = weights_->half();
  const int begin = std::max(span.start - half, 0) / kColumns * kColumns;
  const int end = std::min((span.end + half + kColumns - 1) / kColumns * kColumns, rows_->size().width);
  columns_.clear();
  for (const std::uint8_t* const row : window_)
    columns_.push_back(row + begin);
  std::uint16_t* sums[kRowsAtOnce];
  for (int i = 0; i < kRowsAtOnce; ++i)
    sums[i] = sums_[i] + half + begin;
  kernels<GaussKernels>().convolve_columns(columns_.data(), weights_->weights(), end - begin, sums);
}

const std::uint8_t* GaussianFilterRows::row(int i)
{
  const int half = weights_->half();
  if (half == 0) return window_[static_cast<std::size_t>(i)];
  mirrorEnds(sums_[i] + half, rows_->size().width, half);
  for (const cv::Range& span : spans_)
    kernels<GaussKernels>().convolve_row(sums_[i] + span.start, weights_->weights(), 1, span.size(),
                                         means_[0] + span.start);
  return means_[0];
}

}  // namespace robot_vision
