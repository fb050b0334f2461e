#pragma once

#include <atomic>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>
#include <string>
#include <vector>

#include "haar_search.hpp"

namespace robot_vision
{

/// Which windows are classified, and how many must agree.
struct CascadeWindows
{
  double scale_factor;  // from one size to the next
  int min_neighbors;    // besides the first
  int smallest;         // px, shorter side
  int largest;          // px, longer side, 0: any
};

/// One of OpenCV's cascades. For one thread at a time, as it keeps what it works with.
class Cascade
{
public:
  /// None: finds nothing.
  Cascade() = default;

  /// Reads a cascade: a path, or a name that is looked up where OpenCV's data is installed. Throws
  /// std::invalid_argument naming `parameter` and the file.
  Cascade(const std::string& parameter, const std::string& name);

  bool empty() const { return !haar_ && other_.empty(); }

  /// Where in a gray image the cascade sees what it is for, as detectMultiScale finds it: each box is the mean of the
  /// windows, at least min_neighbors + 1, that agree, and `neighbors` becomes how many these are. Ends early, with
  /// none, when `stop` (may be null) is true.
  std::vector<cv::Rect> find(const cv::Mat& gray, const CascadeWindows& windows, std::vector<int>& neighbors,
                             const std::atomic<bool>* stop = nullptr);

private:
  std::vector<cv::Rect> windowsOn(const cv::Mat& gray, const CascadeWindows& windows, const std::atomic<bool>* stop);

  std::unique_ptr<HaarSearch> haar_;
  cv::CascadeClassifier other_;  // if it is none that HaarSearch knows
};

}  // namespace robot_vision
