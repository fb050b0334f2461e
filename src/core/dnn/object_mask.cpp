#include "object_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace robot_vision
{
namespace
{

/// Where the centres of pixels of the image are between those of the prototypes.
struct MaskSamples
{
  MaskSamples(int begin, int count, const AxisPlacement& axis, int length)
    : first(static_cast<std::size_t>(count)), share(first.size())
  {
    for (int i = 0; i < count; ++i)
    {
      const double at = std::clamp((begin + i + 0.5) * axis.scale + axis.offset - 0.5, 0.0, length - 1.0);
      first[static_cast<std::size_t>(i)] = static_cast<int>(at);
      share[static_cast<std::size_t>(i)] = static_cast<float>(at - std::floor(at));
    }
    low = first.front();
    high = std::min(first.back() + 1, length - 1);
  }

  std::vector<int> first;
  std::vector<float> share;
  int low, high;  // the pixels of the prototypes that are looked at, with both
};

/// The columns of a row of prototypes, weighted and added, at the columns of the image.
void sampleRow(const MaskPrototypes& prototypes, const std::vector<float>& weights, int row, const MaskSamples& columns,
               std::vector<float>& sums, float* values)
{
  const std::size_t width = static_cast<std::size_t>(columns.high - columns.low) + 1;
  sums.assign(width + 1, 0.0F);
  for (std::size_t k = 0; k < weights.size(); ++k)
  {
    const std::size_t at = (k * static_cast<std::size_t>(prototypes.height) + static_cast<std::size_t>(row)) *
                           static_cast<std::size_t>(prototypes.width);
    const float* const prototype = prototypes.values + at + columns.low;
    const float weight = weights[k];
    for (std::size_t i = 0; i < width; ++i)
      sums[i] += weight * prototype[i];
  }
  sums[width] = sums[width - 1];
  for (std::size_t i = 0; i < columns.first.size(); ++i)
  {
    const float* const at = &sums[static_cast<std::size_t>(columns.first[i] - columns.low)];
    values[i] = at[0] + (at[1] - at[0]) * columns.share[i];
  }
}

/// The pixels, counted from `begin`, whose centres are from `low` on and before `high`.
cv::Range centersIn(double low, double high, int begin, int count)
{
  const auto at = [=](double edge) { return std::clamp(static_cast<int>(std::ceil(edge - 0.5)) - begin, 0, count); };
  return {at(low), at(high)};
}

}  // namespace

cv::Mat maskOf(const MaskPrototypes& prototypes, const ExtraValues& coefficients, std::size_t index,
               const CornerBox& box)
{
  const cv::Rect pixels = pixelsOf(box);
  cv::Mat mask = cv::Mat::zeros(pixels.size(), CV_8UC1);
  const MaskSamples columns(pixels.x, pixels.width, prototypes.x, prototypes.width);
  const MaskSamples rows(pixels.y, pixels.height, prototypes.y, prototypes.height);
  std::vector<float> weights(static_cast<std::size_t>(prototypes.count));
  for (std::size_t k = 0; k < weights.size(); ++k)
    weights[k] = coefficients.at(index, k);

  std::vector<float> sums;
  cv::Mat sampled(rows.high - rows.low + 1, pixels.width, CV_32F);
  for (int row = rows.low; row <= rows.high; ++row)
    sampleRow(prototypes, weights, row, columns, sums, sampled.ptr<float>(row - rows.low));

  const cv::Range inside_x = centersIn(box.x0, box.x1, pixels.x, pixels.width);
  const cv::Range inside_y = centersIn(box.y0, box.y1, pixels.y, pixels.height);
  for (int y = inside_y.start; y < inside_y.end; ++y)
  {
    const int above = rows.first[static_cast<std::size_t>(y)] - rows.low;
    const float* const a = sampled.ptr<float>(above);
    const float* const b = sampled.ptr<float>(std::min(above + 1, sampled.rows - 1));
    const float share = rows.share[static_cast<std::size_t>(y)];
    auto* const to = mask.ptr<std::uint8_t>(y);
    for (int x = inside_x.start; x < inside_x.end; ++x)
      to[x] = a[x] + (b[x] - a[x]) * share > 0.0F ? 255 : 0;
  }
  return mask;
}

}  // namespace robot_vision
