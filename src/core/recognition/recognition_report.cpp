#include "robot_vision/common/range.hpp"
#include "robot_vision/recognition/object_recognizer.hpp"

namespace robot_vision
{
namespace
{

/// A share in whole hundredths.
std::string hundredths(double share)
{
  return toText(cvRound(100.0 * share) / 100.0);
}

}  // namespace

std::string reasonText(const ModelReport& report)
{
  switch (report.reason)
  {
    case MissReason::kNone:
      return "found";
    case MissReason::kNoCandidate:
      return "nothing looks like it";
    case MissReason::kOutside:
      return "its candidates are outside of the image";
    case MissReason::kNoDepth:
      return "there is no depth where it may be";
    case MissReason::kTooSmall:
      return "too far away: it has too few pixels at " + hundredths(report.nearest_distance) + " m";
    case MissReason::kNotThere:
      return "the depths where it may be are those of something else; the best match has a score of " +
             hundredths(report.best_score);
    case MissReason::kImprobable:
      return "below the threshold: the best probability is " + hundredths(report.best_probability);
    case MissReason::kClaimed:
      return "something else explains its pixels better; its probability is " + hundredths(report.best_probability);
  }
  return "";
}

}  // namespace robot_vision
