#pragma once

#include <robot_vision/Detection.h>

#include <string>

#include "robot_vision/segmentation/regions.hpp"

namespace robot_vision
{

/// A region of a mask as a message; `id` is -1 for what is not followed.
Detection toDetection(const Region& region, const std::string& label, int id = -1, double score = 1.0);

}  // namespace robot_vision
