#pragma once

#include <atomic>
#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>
#include <string>
#include <vector>

#include "robot_vision/faces/face_detector.hpp"

namespace robot_vision
{

/// Reads a cascade: a path, or a name that is looked up where OpenCV's data is installed. Throws std::invalid_argument
/// naming `parameter` and the file.
cv::CascadeClassifier readCascade(const std::string& parameter, const std::string& name);

/// How a face looks, that is which cascade sees it.
enum class FaceView
{
  kFirst,
  kSecond,
  kMirrored  // the second cascade in the mirrored picture
};

struct FoundFace
{
  cv::Rect box;  // px
  int neighbors = 0;
  FaceView view = FaceView::kFirst;
};

/// Which windows are looked at, and how many must agree: see FaceParams.
struct FaceWindows
{
  /// All that the parameters want.
  static FaceWindows of(const FaceParams& params);

  /// Whether a face of this side, px, is neither too small nor too large.
  bool admit(int side) const { return side >= smallest && (largest == 0 || side <= largest); }

  /// Those of them that are of these sides, px.
  FaceWindows narrowed(int least, int most) const;

  double scale_factor;
  int min_neighbors;
  int smallest;  // px
  int largest;   // px, 0: any
};

/// Searches gray pictures for faces. It has memory of its own: each thread needs one.
class FaceSearch
{
public:
  /// Throws std::invalid_argument if a cascade cannot be read.
  explicit FaceSearch(const FaceParams& params);

  /// The faces in a part of the picture, the largest first: those that the first cascade sees, or else the second. The
  /// windows are those of detectMultiScale on that part. Ends early, without any, when `stop` (may be null) is true.
  std::vector<FoundFace> find(const cv::Mat& gray, const cv::Rect& part, const FaceWindows& windows,
                              const std::atomic<bool>* stop = nullptr);

  /// The same of one view.
  std::vector<FoundFace> find(FaceView view, const cv::Mat& gray, const cv::Rect& part, const FaceWindows& windows,
                              const std::atomic<bool>* stop = nullptr);

  /// The views that there are, the first one first.
  const std::vector<FaceView>& views() const { return views_; }

private:
  cv::CascadeClassifier first_;
  cv::CascadeClassifier second_;
  std::vector<FaceView> views_ = {FaceView::kFirst};
};

}  // namespace robot_vision
