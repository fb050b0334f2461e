#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "v4l2_device.hpp"

namespace robot_vision
{

/// A pixel format that a device offers.
struct V4l2Offer
{
  std::uint32_t fourcc = 0;
  std::string description;                     // from the driver
  std::vector<v4l2_frmsize_stepwise> sizes{};  // px; for a single size, minimum and maximum are equal
};

/// A range of frame periods that a device offers; for a single rate, both are equal.
struct V4l2Periods
{
  v4l2_fract shortest;  // s
  v4l2_fract longest;   // s
};

/// The formats and the frame periods that the driver lists; empty if it lists none.
std::vector<V4l2Offer> offeredFormats(V4l2Device& device);
std::vector<V4l2Periods> offeredPeriods(V4l2Device& device, std::uint32_t fourcc, cv::Size size);

/// The size with the smallest sum of the differences in width and height. `sizes` must not be empty.
cv::Size nearestSize(const std::vector<v4l2_frmsize_stepwise>& sizes, cv::Size wanted);

/// The period with the rate nearest to `rate` (Hz). `periods` must not be empty.
v4l2_fract nearestPeriod(const std::vector<V4l2Periods>& periods, double rate);

/// Frames per second; 0 for a period of 0.
double rateOf(const v4l2_fract& period);

/// The period of a rate (Hz), exact to at least three digits.
v4l2_fract periodOf(double rate);

/// A rate with enough digits that a low one is not shown as 0: "30", "29.97", "0.0333".
std::string rateText(double rate);

/// "320x240, 640x480", "16x16 to 1920x1080 in steps of 8x2"
std::string describeSizes(const std::vector<v4l2_frmsize_stepwise>& sizes);

/// "30, 15 Hz", "1 to 60 Hz"
std::string describeRates(const std::vector<V4l2Periods>& periods);

}  // namespace robot_vision
