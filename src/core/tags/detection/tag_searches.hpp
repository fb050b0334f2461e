#pragma once

#include <optional>

#include "core/common/background_task.hpp"
#include "tag_search.hpp"
#include "tag_tracks.hpp"

namespace robot_vision
{

/// Searches whole images, in the caller's thread or in the background, and parts of one image in several threads.
class TagSearches
{
public:
  /// The parameters must be valid.
  explicit TagSearches(const TagDetectorParams& params);

  /// Takes over other parameters, and drops what a search in the background finds with the old ones.
  void configure(const TagDetectorParams& params);

  /// The tags in a gray image; `decimate` as in the parameters, but not 0.
  std::vector<Tag> find(const cv::Mat& gray, double decimate);

  /// The tags in each of the regions. cv::setNumThreads() says how many are searched at a time, which changes no tag.
  std::vector<std::vector<Tag>> find(const cv::Mat& gray, const std::vector<TagRegion>& regions);

  /// The search in the background, as in BackgroundTask. start() begins it; nobody may write to the image before it
  /// ends.
  bool busy() const { return running_.busy(); }
  void wait() const { running_.wait(); }
  bool start(const cv::Mat& gray, double decimate);
  std::optional<std::vector<Tag>> take() { return running_.take(); }
  void drop() { running_.drop(); }
  void abandon() { running_.abandon(); }

private:
  TagDetectorParams params_;
  std::shared_ptr<const TagDictionary> dictionary_;
  std::vector<TagSearch> searches_;        // one for each thread that was ever needed
  std::shared_ptr<TagSearch> background_;  // one with old parameters lives until its search ends
  BackgroundTask<std::vector<Tag>> running_;
};

}  // namespace robot_vision
