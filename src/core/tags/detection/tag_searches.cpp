#include "tag_searches.hpp"

#include <algorithm>
#include <atomic>

#include "core/image/rects.hpp"

namespace robot_vision
{

TagSearches::TagSearches(const TagDetectorParams& params)
{
  configure(params);
}

void TagSearches::configure(const TagDetectorParams& params)
{
  dictionary_ = TagDictionary::of(params.families, params.max_hamming);
  params_ = params;
  searches_.clear();
  searches_.emplace_back(dictionary_, params_);
  background_ = std::make_shared<TagSearch>(dictionary_, params_);
  drop();
}

std::vector<Tag> TagSearches::find(const cv::Mat& gray, double decimate)
{
  return searches_.front().find(gray, fullRect(gray), decimate);
}

std::vector<std::vector<Tag>> TagSearches::find(const cv::Mat& gray, const std::vector<TagRegion>& regions)
{
  const std::size_t threads = std::min(static_cast<std::size_t>(std::max(cv::getNumThreads(), 1)), regions.size());
  while (searches_.size() < threads)
    searches_.emplace_back(dictionary_, params_);
  std::vector<std::vector<Tag>> found(regions.size());
  std::atomic<std::size_t> next{0};  // a thread that is done takes the next, as the regions are of all sizes
  const auto work = [&](const cv::Range& range)
  {
    for (int thread = range.start; thread < range.end; ++thread)
      for (std::size_t i = next++; i < regions.size(); i = next++)
        found[i] = searches_[static_cast<std::size_t>(thread)].find(gray, regions[i].part, regions[i].decimate);
  };
  cv::parallel_for_({0, static_cast<int>(threads)}, work);
  return found;
}

bool TagSearches::start(const cv::Mat& gray, double decimate)
{
  return running_.start([search = background_, gray, decimate]
                        { return search->find(gray, fullRect(gray), decimate); });
}

}  // namespace robot_vision
