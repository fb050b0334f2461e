#include "range_mask.hpp"

namespace robot_vision
{

void findInRange(const cv::Mat& pixels, const cv::Vec3i& low, const cv::Vec3i& high, bool through_red, cv::Mat& mask,
                 cv::Mat& rest)
{
  cv::Scalar from(low[0], low[1], low[2]), to(high[0], high[1], high[2]);
  if (!through_red)
  {
    cv::inRange(pixels, from, to, mask);
    return;
  }
  to[0] = 255;
  cv::inRange(pixels, from, to, mask);
  from[0] = 0;
  to[0] = high[0];
  cv::inRange(pixels, from, to, rest);
  cv::bitwise_or(mask, rest, mask);
}

}  // namespace robot_vision
