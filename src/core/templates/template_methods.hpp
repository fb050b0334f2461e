#pragma once

#include <string>

namespace robot_vision
{

constexpr double kMinContrast = 1.0;  // gray levels, standard deviation below which pixels are all the same

/// cv::TemplateMatchModes; throws std::invalid_argument for an unknown name.
int methodNumber(const std::string& method);

/// Whether the smallest response is the best.
bool isBestSmall(const std::string& method);

bool isNormed(const std::string& method);

/// Throws std::invalid_argument if this OpenCV takes no mask with the method.
void requireMask(const std::string& method);

}  // namespace robot_vision
