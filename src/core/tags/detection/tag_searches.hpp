#pragma once

#include <optional>

#include "core/common/background_task.hpp"
#include "tag_search.hpp"
#include "tag_tracks.hpp"

namespace robot_vision
{

/// Searches of whole pictures, in the caller's thread and in the background, and of parts of one in several threads.
class TagSearches
{
public:
  /// The parameters must be valid.
  explicit TagSearches(const TagDetectorParams& params);

  /// Takes over other parameters, and drops what is found in the background with the old ones.
  void configure(const TagDetectorParams& params);

  /// The tags in all of a gray picture; `decimate` as in the parameters, but not 0.
  std::vector<Tag> find(const cv::Mat& gray, double decimate);

  /// The tags in each of the regions. cv::setNumThreads() says how many are searched at a time, and changes no tag.
  std::vector<std::vector<Tag>> find(const cv::Mat& gray, const std::vector<TagRegion>& regions);

  /// Whether a search is under way in the background, or what it has found has not been taken.
  bool busy() const { return running_.busy(); }

  /// Waits for the end of one that is under way.
  void wait() const { running_.wait(); }

  /// Begins one; there must be none. Nobody may write to the picture. Returns false if there is no thread for it.
  bool start(const cv::Mat& gray, double decimate);

  /// What it has found, if it has ended and was not dropped. Throws what the search did.
  std::optional<std::vector<Tag>> take() { return running_.take(); }

  /// What is being searched does not matter any more.
  void drop() { running_.drop(); }

  /// The destructor is not to wait for what is being searched. Thread-safe.
  void abandon() { running_.abandon(); }

private:
  TagDetectorParams params_;
  std::shared_ptr<const TagDictionary> dictionary_;
  std::vector<TagSearch> searches_;        // for as many threads as there were at most
  std::shared_ptr<TagSearch> background_;  // an old one lives as long as it is at work
  BackgroundTask<std::vector<Tag>> running_;
};

}  // namespace robot_vision
