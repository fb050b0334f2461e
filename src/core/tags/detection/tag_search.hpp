#pragma once

#include "robot_vision/tags/detection/tag_detector.hpp"
#include "tag_dictionary.hpp"

namespace robot_vision
{

constexpr int kMinSearched = 72;  // px after decimation: in smaller images the library writes beyond its memory

/// A detector of libapriltag's. For one thread at a time.
class TagSearch
{
public:
  /// The parameters must be valid, and the dictionary must be made for them.
  TagSearch(std::shared_ptr<const TagDictionary> dictionary, const TagDetectorParams& params);

  /// The tags in a part of a gray image; `decimate` as in the parameters, but not 0.
  std::vector<Tag> find(const cv::Mat& gray, const cv::Rect& part, double decimate);

private:
  cv::Mat prepare(const cv::Mat& pixels, double decimate);
  Tag toTag(const apriltag_detection_t& found, const cv::Mat& gray, const cv::Rect& part) const;

  TagDetectorParams params_;
  std::shared_ptr<const TagDictionary> dictionary_;  // must outlive the detector
  DetectorPtr detector_;
  cv::Mat copy_;  // of pixels that the library cannot be given as they are
};

}  // namespace robot_vision
