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
  std::string description;                     // the driver's
  std::vector<v4l2_frmsize_stepwise> sizes{};  // px; one size has its least equal to its largest
};

/// Times from a frame to the next that a device offers; of one rate they are the same.
struct V4l2Periods
{
  v4l2_fract shortest;  // s
  v4l2_fract longest;   // s
};

/// What the device says that it offers; empty if its driver does not say.
std::vector<V4l2Offer> offeredFormats(V4l2Device& device);
std::vector<V4l2Periods> offeredPeriods(V4l2Device& device, std::uint32_t fourcc, cv::Size size);

/// Of the sizes, which must not be empty, the one with the least sum of both differences.
cv::Size nearestSize(const std::vector<v4l2_frmsize_stepwise>& sizes, cv::Size wanted);

/// Of the periods, which must not be empty, the one of the nearest rate (Hz).
v4l2_fract nearestPeriod(const std::vector<V4l2Periods>& periods, double rate);

/// Frames per second; 0 of a period that is none.
double rateOf(const v4l2_fract& period);

/// The period of a rate (Hz), to three digits at least.
v4l2_fract periodOf(double rate);

/// "30", "29.97", "0.0333": never 0 for a rate that is none.
std::string rateText(double rate);

/// "320x240, 640x480", "16x16 to 1920x1080 in steps of 8x2"
std::string describeSizes(const std::vector<v4l2_frmsize_stepwise>& sizes);

/// "30, 15 Hz", "1 to 60 Hz"
std::string describeRates(const std::vector<V4l2Periods>& periods);

}  // namespace robot_vision
