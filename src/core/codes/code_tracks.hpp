#pragma once

#include "robot_vision/codes/code_reader.hpp"

namespace robot_vision
{

/// A code that was read, and its motion.
struct CodeTrack
{
  Code code;             // as it was read last
  double seen = 0.0;     // s, when it was read last
  bool moving = false;   // whether the velocity is known, because the code was read more than once
  cv::Point2d velocity;  // px/s, of its middle

  /// The code where it should be at a time.
  Code at(double time_s) const;

  /// Whether all of it should be in the image.
  bool isInViewAt(double time_s, const cv::Size& image) const;

  /// The part of the image in which the code should be, with a margin for its motion, which is larger if `wide`.
  cv::Rect regionAt(double time_s, bool wide, const cv::Size& image) const;
};

/// Grows a part of the image so that scan lines with a distance of `spacing` px are the same in the part as in the
/// whole image.
cv::Rect alignedToScanLines(const cv::Rect& part, int spacing, const cv::Size& image);

/// Whether a code that was read in a part of the image lies inside of it, so that it would be the same in the whole
/// image.
bool isWhole(const Code& code, const cv::Rect& part, const cv::Size& image);

/// Whether both have the same type and data.
bool haveSameContent(const Code& a, const Code& b);

/// Whether both are the same code: bar codes with the same content, or QR codes with the same content that overlap.
bool isSame(const Code& a, const Code& b);

/// Updates the nearest track of the same content with a code of a frame, or begins a new track.
void follow(std::vector<CodeTrack>& tracks, double time_s, const Code& code);

}  // namespace robot_vision
