#include "fixed_disparities.hpp"

#include <cstdint>
#include <limits>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

void requireMask(const std::string& name, const cv::Mat& mask, const cv::Size& size)
{
  if (mask.empty()) return;
  checkPixels(mask, "mono8");
  require(mask.size() == size, "the size of " + name, toText(mask.size()), "the images', " + toText(size));
}

/// A row of a mask; null: of none.
const std::uint8_t* rowOf(const cv::Mat& mask, int y)
{
  return mask.empty() ? nullptr : mask.ptr<std::uint8_t>(y);
}

bool isSeen(const std::uint8_t* row, int x)
{
  return row == nullptr || row[x] != 0;
}

}  // namespace

void dropUnseen(cv::Mat& disparities, int invalid, const cv::Mat& left_seen, const cv::Mat& right_seen)
{
  requireMask("left_seen", left_seen, disparities.size());
  requireMask("right_seen", right_seen, disparities.size());
  for (int y = 0; y < disparities.rows; ++y)
  {
    auto* row = disparities.ptr<std::int16_t>(y);
    const std::uint8_t *left = rowOf(left_seen, y), *right = rowOf(right_seen, y);
    for (int x = 0; x < disparities.cols; ++x)
    {
      if (row[x] <= invalid) continue;
      const int partner = x - ((row[x] + kDisparitySteps / 2) >> kDisparityShift);  // of the nearest pixel
      const bool inside = partner >= 0 && partner < disparities.cols;
      if (!inside || !isSeen(left, x) || !isSeen(right, partner)) row[x] = static_cast<std::int16_t>(invalid);
    }
  }
}

void toPixels(const cv::Mat& disparities, int invalid, cv::Mat& out)
{
  out.create(disparities.size(), CV_32FC1);
  for (int y = 0; y < disparities.rows; ++y)
  {
    const auto* row = disparities.ptr<std::int16_t>(y);
    auto* pixels = out.ptr<float>(y);
    for (int x = 0; x < disparities.cols; ++x)
      pixels[x] = row[x] <= invalid ? std::numeric_limits<float>::quiet_NaN()
                                    : static_cast<float>(row[x]) / static_cast<float>(kDisparitySteps);
  }
}

}  // namespace robot_vision
