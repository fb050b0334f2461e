#pragma once

#include "robot_vision/tags/detection/tag_detector.hpp"

namespace robot_vision
{

/// Where to look for tags, and in what resolution.
struct TagRegion
{
  cv::Rect part;  // of the image, px
  double decimate = 1.0;
};

/// A tag that was seen, and how it moves.
struct TagTrack
{
  Tag tag;                              // as it was seen last
  double seen = 0.0;                    // s, when
  bool moving = false;                  // whether it was seen before, so that its velocity is known
  std::array<cv::Point2d, 4> velocity;  // px/s, of its corners

  /// The corners at another time, if the tag moves on as it did.
  std::array<cv::Point2d, 4> cornersAt(double time_s) const;

  /// The tag at another time, if it moves on as it did.
  Tag at(double time_s) const;

  /// Whether all of it should be in the image.
  bool isInViewAt(double time_s, const cv::Size& image) const;

  /// Where it should be then, with as much around it as it takes to find it there. `decimate` as in the parameters.
  TagRegion regionAt(double time_s, double decimate, const cv::Size& image) const;
};

/// Whether a tag that was found in the region is as it would be found in the whole image.
bool isWhole(const Tag& tag, const TagRegion& region, const cv::Size& image);

/// Joins regions where that makes less to search.
void join(std::vector<TagRegion>& regions);

/// Whether both are the same tag: those with the same id that overlap.
bool isSame(const Tag& a, const Tag& b);

/// Adds the tags that are not yet among the others. Of two that are the same, keeps the one with fewer wrong bits.
void merge(std::vector<Tag>& tags, const std::vector<Tag>& more);

/// Continues the tracks by the tags of a frame, and begins new ones.
void follow(std::vector<TagTrack>& tracks, double time_s, const std::vector<Tag>& tags);

}  // namespace robot_vision
