#include "robot_vision/filters/brightness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "brightness_kernels.hpp"
#include "core/image/lut_kernels.hpp"
#include "core/image/row_bands.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// The output for each value of an unsigned integer type.
template <class T>
cv::Mat makeTable(const BrightnessParams& params)
{
  constexpr int kMax = std::numeric_limits<T>::max();
  cv::Mat_<T> ramp(1, kMax + 1);
  std::iota(ramp.begin(), ramp.end(), T{0});
  cv::Mat_<T> table;
  ramp.convertTo(table, -1, params.gain, params.offset * (kMax / 255));
  for (T& value : table)
    value = cv::saturate_cast<T>(std::pow(value / double{kMax}, params.gamma) * kMax);
  return table;
}

/// The table for three channels, with the identity for the fourth.
cv::Mat keepAlpha(const cv::Mat& table)
{
  cv::Mat_<std::uint8_t> identity(table.size());
  std::iota(identity.begin(), identity.end(), std::uint8_t{0});
  cv::Mat merged;
  cv::merge(std::vector<cv::Mat>{table, table, table, identity}, merged);
  return merged;
}

/// Whether BrightnessKernels::line gives the same results as the table. Without gamma it should, but values next to a
/// half may be rounded differently.
bool isLine(const cv::Mat& table, const BrightnessParams& params)
{
  if (params.gamma != 1.0) return false;
  std::array<std::uint8_t, 256> ramp;
  std::iota(ramp.begin(), ramp.end(), std::uint8_t{0});
  std::array<std::uint8_t, 256> line;
  kernels<BrightnessKernels>().line(ramp.data(), static_cast<float>(params.gain), static_cast<float>(params.offset),
                                    256, line.data());
  return std::equal(line.begin(), line.end(), table.ptr());
}

/// cv::LUT for a row of 16-bit values, which OpenCV supports only since version 5.
void applyLut(const std::uint16_t* table, const std::uint16_t* values, int count, std::uint16_t* results)
{
  for (int i = 0; i < count; ++i)
    results[i] = table[values[i]];
}

}  // namespace

Brightness::Brightness(const BrightnessParams& params) : params_(params)
{
  validate(params);
  table_ = makeTable<std::uint8_t>(params);
  is_line_ = isLine(table_, params);
  alpha_table_ = keepAlpha(table_);
}

void Brightness::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& out)
{
  checkPixels(image, encoding);
  if (encoding == "mono16" && wide_table_.empty()) wide_table_ = makeTable<std::uint16_t>(params_);
  const bool is_kept = outputEncoding(encoding) == encoding;
  if (!is_kept) toBgr(image, encoding, bgr_);
  const cv::Mat& from = is_kept ? image : bgr_;
  out.create(from.size(), from.type());
  parallelForRows(from.rows, params_.threads, kMinRows, [&](int, const cv::Range& rows) { applyTo(from, rows, out); });
}

void Brightness::applyTo(const cv::Mat& image, const cv::Range& rows, cv::Mat& out) const
{
  if (image.channels() == 4)
  {
    cv::Mat band = out.rowRange(rows);
    cv::LUT(image.rowRange(rows), alpha_table_, band);
    return;
  }
  const auto& tables = kernels<LutKernels>();
  const auto gain = static_cast<float>(params_.gain);
  const auto offset = static_cast<float>(params_.offset);
  const int count = image.cols * image.channels();
  for (int y = rows.start; y < rows.end; ++y)
  {
    if (image.depth() == CV_16U)
      applyLut(wide_table_.ptr<std::uint16_t>(), image.ptr<std::uint16_t>(y), count, out.ptr<std::uint16_t>(y));
    else if (is_line_ && !tables.has_fast_lut)
      kernels<BrightnessKernels>().line(image.ptr(y), gain, offset, count, out.ptr(y));
    else
      tables.apply_lut(table_.ptr(), image.ptr(y), count, out.ptr(y));
  }
}

std::string Brightness::outputEncoding(const std::string& encoding)
{
  const bool kept =
      encoding == "rgb8" || encoding == "bgra8" || encoding == "rgba8" || encoding == "mono8" || encoding == "mono16";
  return kept ? encoding : "bgr8";
}

}  // namespace robot_vision
