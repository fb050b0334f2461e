#pragma once

#include "robot_vision/codes/code_reader.hpp"

namespace robot_vision
{

/// A code that was read, and how it moves.
struct CodeTrack
{
  Code code;             // as it was read last
  double seen = 0.0;     // s, when
  bool moving = false;   // whether it was read before, and so
  cv::Point2d velocity;  // px/s, of its middle, is known

  /// The code as it should be, or should have been.
  Code at(double time_s) const;

  /// Whether all of it should be in the image.
  bool isInViewAt(double time_s, const cv::Size& image) const;

  /// The part of the image where it should be, with as much around it as it may have moved; `wide`: with more.
  cv::Rect regionAt(double time_s, bool wide, const cv::Size& image) const;
};

/// The smallest part that holds `part` and in which a search reads along the lines that it reads along in the image,
/// `spacing` px from each other.
cv::Rect onLines(const cv::Rect& part, int spacing, const cv::Size& image);

/// Whether a code that was read in a part of the image is as it would be read in all of it.
bool isWhole(const Code& code, const cv::Rect& part, const cv::Size& image);

/// Whether both are of one type and content.
bool saysTheSame(const Code& a, const Code& b);

/// Whether both are the same code: QR codes that say the same and overlap, bar codes that say the same.
bool isSame(const Code& a, const Code& b);

/// Takes over a code of a frame.
void follow(std::vector<CodeTrack>& tracks, double time_s, const Code& code);

}  // namespace robot_vision
