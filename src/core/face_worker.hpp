#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

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

/// Searches in a thread of its own, which starts with the first search, or in the caller's.
class FaceWorker
{
public:
  FaceWorker(const FaceParams& params, bool background);
  ~FaceWorker();
  FaceWorker(const FaceWorker&) = delete;
  FaceWorker& operator=(const FaceWorker&) = delete;

  /// Whether a search is under way, or its result has not been taken.
  bool busy() const;

  /// Waits for the end of a search that is under way.
  void wait() const;

  /// Begins a search; the worker must not be busy.
  void start(FaceJob job);

  /// The result of the search, if it has ended. Throws what the search has thrown.
  std::optional<FaceResult> take();

private:
  void run();

  FaceSearch search_;
  const bool background_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;               // guards what follows
  std::condition_variable wake_;           // for the thread
  mutable std::condition_variable ended_;  // for who waits for a search
  std::optional<FaceJob> job_;
  std::optional<FaceResult> result_;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace robot_vision
