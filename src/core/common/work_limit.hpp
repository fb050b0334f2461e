#pragma once

#include <opencv2/core/types.hpp>
#include <string>

namespace robot_vision
{

/// Throws std::invalid_argument unless `steps` of work for each pixel of an image of `size` are at most `most` in sum,
/// so that no image holds up those that come after it for many seconds. `params` names what the steps come from: "size
/// is 99".
void requireWork(const std::string& params, double steps, const cv::Size& size, double most);

}  // namespace robot_vision
