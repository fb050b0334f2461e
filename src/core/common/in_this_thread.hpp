#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Calls `work` with OpenCV's functions confined to this thread: what is parallel already is not divided any further.
/// Whether something is, OpenCV notes for the process, so that others are confined to their threads meanwhile; the
/// number of its threads, by which some of its functions divide an image, stays as it is.
template <class Work>
void inThisThread(const Work& work)
{
  cv::parallel_for_({0, 1}, [&](const cv::Range&) { work(); });
}

}  // namespace robot_vision
