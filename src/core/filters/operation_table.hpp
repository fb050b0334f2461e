#pragma once

#include <string>
#include <vector>

#include "robot_vision/filters/operations.hpp"

namespace robot_vision
{

// The encodings that OpenCV's functions take as they are.
const std::vector<std::string> kGrayOnly = {"mono8"};
const std::vector<std::string> kBgrOnly = {"bgr8"};
const std::vector<std::string> kGrayOrColor = {"bgr8", "rgb8", "mono8"};
const std::vector<std::string> kColors = {"bgr8", "rgb8", "bgra8", "rgba8"};
const std::vector<std::string> kEightBits = {"bgr8", "rgb8", "bgra8", "rgba8", "mono8"};
const std::vector<std::string> kAllPixels = {"bgr8", "rgb8", "bgra8", "rgba8", "mono8", "mono16"};

// Without an opacity, of which some operations would make something without a meaning, as its negative or derivative.
const std::vector<std::string> kOpaque = {"bgr8", "rgb8", "mono8", "mono16"};

/// `make` of an operation that keeps nothing from image to image.
template <class Apply>  // void(const OperationValues& values, const OperationInput& input, cv::Mat& out)
auto eachTime(Apply apply)
{
  return [apply](const OperationValues& values) -> Operation::Step
  { return [apply, values](const OperationInput& input, cv::Mat& out) { apply(values, input, out); }; };
}

/// A gray level, of which white has 255, in values of an image.
double grayLevel(const cv::Mat& image);

/// A kernel as text, with rows between semicolons and numbers between spaces: "0 -1 0; -1 5 -1; 0 -1 0". Returns
/// CV_64FC1 of up to 31x31. Throws std::invalid_argument that says what is wrong with the text.
cv::Mat parseKernel(const std::string& text);

/// Throws std::invalid_argument naming the size unless an image of `size`, its sides multiplied by `scale`, is one that
/// can be handled, of up to kMaxPixels.
void requireResultSize(const cv::Size& size, double scale);

// The operations by their kinds.
std::vector<Operation> arithmeticOperations();
std::vector<Operation> blurOperations();
std::vector<Operation> colorOperations();
std::vector<Operation> geometryOperations();
std::vector<Operation> gradientOperations();
std::vector<Operation> histogramOperations();
std::vector<Operation> morphologyOperations();
std::vector<Operation> pyramidOperations();
std::vector<Operation> thresholdOperations();

}  // namespace robot_vision
