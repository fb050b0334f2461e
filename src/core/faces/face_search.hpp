#pragma once

#include <atomic>
#include <opencv2/core.hpp>
#include <vector>

#include "cascade.hpp"
#include "robot_vision/faces/face_detector.hpp"

namespace robot_vision
{

/// The view of a face, which is given by the cascade that sees it.
enum class FaceView
{
  kFirst,
  kSecond,
  kMirrored  // the second cascade in the mirrored image
};

struct FoundFace
{
  cv::Rect box;  // px
  int neighbors = 0;
  FaceView view = FaceView::kFirst;
};

/// The windows that are classified in search of faces; see FaceParams.
struct FaceWindows : CascadeWindows
{
  /// Those that the parameters ask for.
  static FaceWindows of(const FaceParams& params);

  /// Whether a face of this side, px, is neither too small nor too large.
  bool admit(int side) const { return side >= smallest && (largest == 0 || side <= largest); }

  /// Those of them whose sides are from `min_side` to `max_side` px.
  FaceWindows narrowed(int min_side, int max_side) const;
};

/// What is to be searched. The image is the job's own: nobody writes to it.
struct FaceJob
{
  double time = 0.0;  // s, of the frame
  cv::Mat gray;
  bool is_whole = false;        // whether the whole image is searched, or parts of it
  std::vector<cv::Rect> parts;  // px
  FaceWindows windows{};
};

struct FaceResult
{
  FaceJob job;
  std::vector<FoundFace> found;
};

/// Searches gray images for faces. For one thread at a time, as the cascades keep what they work with.
class FaceSearch
{
public:
  /// Throws std::invalid_argument if a cascade cannot be read.
  explicit FaceSearch(const FaceParams& params);

  /// The faces in a part of the image, the largest first: those that the first cascade sees, or else the second. The
  /// windows are those of detectMultiScale on that part. Ends early, without any face, when `stop` (may be null) is
  /// true.
  std::vector<FoundFace> find(const cv::Mat& gray, const cv::Rect& part, const FaceWindows& windows,
                              const std::atomic<bool>* stop = nullptr);

  /// The same for one view.
  std::vector<FoundFace> find(FaceView view, const cv::Mat& gray, const cv::Rect& part, const FaceWindows& windows,
                              const std::atomic<bool>* stop = nullptr);

  /// The faces in all parts of a job.
  FaceResult find(FaceJob job, const std::atomic<bool>& stop);

  /// The available views, the first one first.
  const std::vector<FaceView>& views() const { return views_; }

private:
  Cascade first_;
  Cascade second_;
  std::vector<FaceView> views_ = {FaceView::kFirst};
};

}  // namespace robot_vision
