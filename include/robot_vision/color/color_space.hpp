#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

// Colours in the spaces of OpenCV, in 8 bits as cv::cvtColor gives them. A space is named as parameters name it: hsv,
// hls, lab, ycrcb, rgb and bgr, whose channels are in the order of the name.

/// A channel of a space.
struct ColorChannel
{
  std::string name;     // of its limits: "h" for h_low and h_high
  std::string meaning;  // "hue"
  int max = 255;        // the highest limit: 255, or 180 half degrees of a hue
};

/// The names of all spaces.
std::vector<std::string> colorSpaces();

/// The channels of a space. Throws std::invalid_argument naming the space if it is none.
std::array<ColorChannel, 3> colorChannels(const std::string& space);

/// Whether a channel is a hue, in half degrees and on a circle: 180 is 0. Only HLS has pixels of 180, by rounding.
bool isHue(const ColorChannel& channel);

/// Converts a colour of 8 bits as cv::cvtColor does in the middle of an image; at the end of a row OpenCV may round HLS
/// otherwise, by 1. Throws as colorChannels() does.
cv::Vec3b toSpace(const cv::Vec3b& bgr, const std::string& space);

/// Converts an image to CV_8UC3 in a space, as cv::cvtColor does with the image as bgr8 (rgb8 is read as it is). `out`
/// is reused if it fits; it shares the input's pixels if nothing has to be changed. Throws std::invalid_argument as
/// colorChannels() does, or if `image` is not of `encoding`.
void toSpace(const cv::Mat& image, const std::string& encoding, const std::string& space, cv::Mat& out);

}  // namespace robot_vision
