#include "canny_stripe.hpp"

#include <algorithm>

namespace robot_vision
{

void CannyStripe::run(const cv::Mat& image, const std::string& encoding, int blur_size,
                      const EdgeThresholds& thresholds, bool squared, cv::Range rows, EdgeHysteresis& hysteresis)
{
  // Candidates depend on the gradients of the rows next to them, which depend on the blurred rows next to these.
  const int first_blurred = std::max(rows.start - 2, 0);
  gray_.begin(image, encoding, std::max(first_blurred - blur_size / 2, 0), blur_size + 1);
  box_.begin({&gray_}, blur_size, first_blurred);
  next_blurred_ = first_blurred;
  if (gray_.size().width != size_.width)
  {
    blurred_.resize(gray_.size().width);
    dx_.resize(gray_.size().width);
    dy_.resize(gray_.size().width);
    marks_.assign(static_cast<std::size_t>(gray_.size().width + 63) / 64 * 64, 0);
  }
  size_ = gray_.size();
  if (squared)
    run(thresholds, rows, squares_, hysteresis);
  else
    run(thresholds, rows, sums_, hysteresis);
}

template <class Magnitude>
void CannyStripe::run(const EdgeThresholds& thresholds, cv::Range rows, RowRing<Magnitude, 3>& magnitudes,
                      EdgeHysteresis& hysteresis)
{
  magnitudes.resize(size_.width);  // sets them to 0, which is the magnitude around the image
  for (int y = std::max(rows.start - 1, 0); y <= rows.end; ++y)
  {
    if (y < size_.height)
      differentiate(y, magnitudes[y]);
    else
      std::fill_n(magnitudes[y], size_.width, Magnitude());
    const int done = y - 1;
    if (done < rows.start) continue;
    kernels<EdgeKernels<Magnitude>>().suppress(
        {magnitudes[done - 1], magnitudes[done], magnitudes[done + 1], dx_[done], dy_[done]}, thresholds, size_.width,
        marks_.data());
    hysteresis.setRow(done, marks_.data());
  }
}

/// Blurs the rows up to `y`, and repeats the first and the last pixel of each beyond its ends.
void CannyStripe::blurTo(int y)
{
  for (; next_blurred_ <= y; ++next_blurred_)
  {
    std::uint8_t* const row = blurred_[next_blurred_];
    box_.next(row);
    row[-1] = row[0];
    row[size_.width] = row[size_.width - 1];
  }
}

template <class Magnitude>
void CannyStripe::differentiate(int y, Magnitude* magnitudes)
{
  const int below = std::min(y + 1, size_.height - 1);
  blurTo(below);
  kernels<EdgeKernels<Magnitude>>().gradient(blurred_[std::max(y - 1, 0)], blurred_[y], blurred_[below], size_.width,
                                             dx_[y], dy_[y], magnitudes);
}

}  // namespace robot_vision
