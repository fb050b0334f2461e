#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

// The pixels of a depth image (REP 118) hold z of what they see, in the camera's optical frame: 16UC1 in mm, where 0 is
// none, or 32FC1 in m, where NaN is none. mono16 is taken for 16UC1, which some transports call so; in 32FC1 infinities
// and what is not above 0 are taken for none, too.

/// The cv::Mat type of depth images of an encoding. Throws std::invalid_argument naming any other encoding.
int depthType(const std::string& encoding);

/// Throws std::invalid_argument naming what was expected unless `depth` can be a depth image of this encoding.
void checkDepth(const cv::Mat& depth, const std::string& encoding);

/// The same, and of this size.
void checkDepth(const cv::Mat& depth, const std::string& encoding, const cv::Size& size);

/// Writes depths in m (CV_32FC1), NaN where there is none, into `metres`, which is reused if it fits and may be
/// `depth`. Throws as checkDepth() does.
void toMetres(const cv::Mat& depth, const std::string& encoding, cv::Mat& metres);

/// Writes depths in mm (CV_16UC1), halves rounded up; 0 where there is none, and for what is beyond 65.535 m.
void toMillimetres(const cv::Mat& depth, const std::string& encoding, cv::Mat& millimetres);

/// Why the numbers of a depth image are probably not what its encoding says, as a line for a log: no pixel has a depth,
/// or those that have one are, by their median, nearer or farther than what depth cameras see. Empty if nothing is odd.
/// Looks at some thousand pixels. Throws as checkDepth() does.
std::string oddDepth(const cv::Mat& depth, const std::string& encoding);

}  // namespace robot_vision
