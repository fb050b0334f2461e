#pragma once

#include <string>

namespace robot_vision
{

constexpr int kNoColorCode = -1;  // instead of a code of cv::cvtColor: the pixels are in the space already

/// The code of cv::cvtColor from bgr8, or rgb8, to a space. Throws as colorChannels() does.
int colorCode(const std::string& space, bool is_rgb);

/// Has a range of hues that begins with 0 hold those of 180, too, which are the same red: HLS rounds to either.
void closeHues(int& low, int& high);

}  // namespace robot_vision
