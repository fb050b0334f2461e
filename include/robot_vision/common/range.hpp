#pragma once

#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// A number as C++ streams write it: 0.5, 30, nan.
std::string toText(double value);

/// A size as "640x480", for messages. Other integers than those of cv::Size stay what they are.
std::string toText(const cv::Size& size);
template <class Integer>
std::string sizeText(Integer width, Integer height)
{
  return std::to_string(width) + "x" + std::to_string(height);
}

/// The words separated by commas, "a, b, c", for a message.
std::string joined(const std::vector<std::string>& words);

/// Throws std::invalid_argument "<name> is <value>, must be <expected>" unless `ok`.
void require(bool ok, const std::string& name, const std::string& value, const std::string& expected);
void require(bool ok, const std::string& name, double value, const std::string& expected);

/// Throws std::invalid_argument naming parameter, value and range unless low <= value <= high; NaN is refused too.
void requireRange(const std::string& name, double value, double low, double high);

/// Throws std::invalid_argument "<name> is <value>, must be finite" for NaN and infinities.
void requireFinite(const std::string& name, double value);

}  // namespace robot_vision
