#include "gauss_rows.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

constexpr int kMargin = 64;  // px that kernels may touch beyond a row's end
constexpr int kWhole = 256;  // all weights together
constexpr std::uint8_t kImpulse = 255;

std::int32_t pairOf(int first, int second)
{
  return second * 0x10000 + first;
}

}  // namespace

GaussWeights::GaussWeights(int size) : size_(size), half_(size / 2)
{
  // Of a white pixel in a black row OpenCV makes the weights but for the rounding of those above 127: the middle's.
  cv::Mat row(1, 2 * size + 1, CV_8UC1, cv::Scalar(0));
  row.at<std::uint8_t>(size) = kImpulse;
  cv::GaussianBlur(row, row, {size, size}, 0.0);
  int rest = kWhole;
  values_.resize(static_cast<std::size_t>(half_ + 1));
  for (int j = half_; j > 0; --j)
  {
    values_[j] = row.at<std::uint8_t>(size + j);
    rest -= 2 * values_[j];
  }
  values_[0] = static_cast<std::uint16_t>(rest);
  while (values_.back() == 0)  // of the largest windows those next to their ends
    values_.pop_back();
  half_ = static_cast<int>(values_.size()) - 1;
  const auto at = [this](int i) { return i > 2 * half_ ? 0 : values_[static_cast<std::size_t>(std::abs(i - half_))]; };
  for (int i = 0; i <= 2 * half_; i += 2)
    pairs_.push_back(pairOf(at(i), at(i + 1)));
}

bool GaussWeights::areExact() const
{
  cv::Mat picture(100, 150, CV_8UC1);
  cv::RNG().fill(picture, cv::RNG::UNIFORM, 0, 256);
  picture.colRange(0, 50).setTo(255);  // whose mean is white only of weights that add up
  cv::Mat expected;
  cv::GaussianBlur(picture, expected, {size_, size_}, 0.0);
  GrayRows gray;
  gray.begin(picture, "mono8", 0, GaussRows::window(*this));
  GaussRows rows;
  rows.begin(gray, *this, 0);
  for (int y = 0; y < picture.rows; ++y)
  {
    const std::uint8_t* const row = rows.next();
    if (!std::equal(row, row + picture.cols, expected.ptr(y))) return false;
  }
  return true;
}

void GaussRows::begin(GrayRows& rows, const GaussWeights& weights, int first)
{
  rows_ = &rows;
  weights_ = &weights;
  y_ = first;
  sums_.resize(1, rows.size().width + 2 * weights.half() + 2 * kMargin);
  means_.resize(1, rows.size().width + kMargin);
  // From top to bottom, as rows are made.
  const int half = weights.half();
  for (int y = std::max(first - half, 0); y < std::min(first + half, rows.size().height); ++y)
    rows.row(y);
  window_.assign(1, nullptr);  // is about to leave
  for (int y = first - half; y < first + half; ++y)
    window_.push_back(rows_->mirroredRow(y));
}

const std::uint8_t* GaussRows::next()
{
  const int half = weights_->half();
  const int width = rows_->size().width;
  std::copy(window_.begin() + 1, window_.end(), window_.begin());
  window_.back() = rows_->mirroredRow(y_ + half);
  std::uint16_t* const sums = sums_[0] + half;
  kernels().weigh_columns(window_.data(), weights_->weights(), width, sums);
  mirrorEnds(sums, width, half);
  kernels().weigh_row(sums_[0], weights_->weights(), width, means_[0]);
  ++y_;
  return means_[0];
}

}  // namespace robot_vision
