#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "core/common/background_task.hpp"
#include "face_search.hpp"

namespace robot_vision
{

/// What is to be searched. The picture is the search's own: nobody writes to it.
struct FaceJob
{
  double time = 0.0;  // s, of the frame
  cv::Mat gray;
  bool whole = false;           // the whole picture, or parts of it
  std::vector<cv::Rect> parts;  // px
  FaceWindows windows{};
};

struct FaceResult
{
  FaceJob job;
  std::vector<FoundFace> found;
};

/// Searches in a thread of its own, or in the caller's.
class FaceWorker
{
public:
  FaceWorker(const FaceParams& params, bool background);
  ~FaceWorker() { stop_ = true; }  // so that there is little to wait for

  /// Whether a search is under way, or its result has not been taken.
  bool busy() const { return task_.busy() || result_; }

  /// Waits for the end of a search that is under way.
  void wait() const { task_.wait(); }

  /// Begins a search; the worker must not be busy.
  void start(FaceJob job);

  /// The result of the search, if it has ended. Throws what the search has thrown.
  std::optional<FaceResult> take();

private:
  FaceSearch search_;
  const bool background_;
  std::atomic<bool> stop_{false};
  std::optional<FaceResult> result_;  // of a search in the caller's thread
  BackgroundTask<FaceResult> task_;   // uses the others, and so goes first
};

}  // namespace robot_vision
