#pragma once

#include <opencv2/objdetect.hpp>
#include <vector>

#include "robot_vision/people/people_detector.hpp"

namespace robot_vision
{

/// Windows of a HOGDescriptor.
struct PersonWindows
{
  std::vector<cv::Rect> boxes;  // px, may reach beyond the image
  std::vector<double> weights;  // distances from the plane of the support vector machine
  std::vector<double> scales;   // sizes, as a factor of the descriptor's window
};

/// The sizes of windows that are searched in an image, as factors of the descriptor's window, from 1 on.
std::vector<double> windowScales(const cv::Size& image, const cv::Size& window, double step);

/// The windows in a CV_8UC3 image, not smaller than one, that have a person in them as cv::HOGDescriptor's
/// detectMultiScale() finds them before it groups them. Of too many to be grouped the surest.
PersonWindows findWindows(const cv::HOGDescriptor& hog, const cv::Mat& bgr, const cv::Size& stride,
                          const PeopleParams& params);

/// Groups windows as detectMultiScale() does. With mean_shift the weights are densities then. The scales are left
/// meaningless.
void groupWindows(const cv::HOGDescriptor& hog, PersonWindows& windows, const PeopleParams& params);

}  // namespace robot_vision
