#pragma once

#include "robot_vision/tag_detector.hpp"
#include "tag_library.hpp"
#include "tag_pattern.hpp"

namespace robot_vision
{

constexpr int kLeastSearched = 72;  // px after decimation: in smaller pictures the library writes behind its memory

/// libapriltag's detector.
class TagSearch
{
public:
  /// The parameters must be valid.
  explicit TagSearch(const TagDetectorParams& params);

  /// Takes over other parameters.
  void configure(const TagDetectorParams& params);

  /// The tags in a part of a grey picture; `decimate` as in the parameters, but not 0.
  std::vector<Tag> find(const cv::Mat& gray, const cv::Rect& part, double decimate);

private:
  struct Family
  {
    FamilyPtr record;
    TagPattern pattern;
  };

  void makeDetector();
  cv::Mat prepare(const cv::Mat& pixels, double decimate);
  Tag toTag(const apriltag_detection_t& found, const cv::Mat& gray, const cv::Rect& part) const;

  TagDetectorParams params_;
  std::vector<Family> families_;  // must outlive the detector, which frees tables in them
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_{nullptr, apriltag_detector_destroy};
  cv::Mat copy_;  // memory for pixels that the library cannot be given as they are
};

}  // namespace robot_vision
