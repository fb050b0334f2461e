#include "code_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

// All lengths are in the longest sides of the code.
constexpr double kQuiet = 0.15;              // around a code, which the search needs to see
constexpr double kInitialMotion = 0.5;       // that it may have moved in a frame when it was read once,
constexpr double kMaxUntrackedSpeed = 15.0;  // per s, in more than that,
constexpr double kFarthest = 2.5;            // and at most
constexpr double kPositionError = 0.1;       // that it may deviate from its motion
constexpr double kWide = 0.5;                // more, where all that was not enough
constexpr double kFastest = 60.0;            // per s: what is farther away was put there
constexpr double kMotionError = 0.5;         // of its way that it may deviate from it
constexpr int kCut = 2;                      // px: what is nearer to the edge of a part may go on beyond it

cv::Point2d middleOf(const Code& code)
{
  cv::Point2d sum;
  for (const cv::Point2d& point : code.polygon)
    sum += point;
  return sum / static_cast<double>(code.polygon.size());
}

double longestSide(const Code& code)
{
  double longest = 1.0;
  for (std::size_t i = 0; i < code.polygon.size(); ++i)
    longest = std::max(longest, cv::norm(code.polygon[(i + 1) % code.polygon.size()] - code.polygon[i]));
  return longest;
}

std::vector<cv::Point2f> outlineOf(const Code& code)
{
  return {code.polygon.begin(), code.polygon.end()};
}

bool holds(const Code& code, const cv::Point2d& point)
{
  return cv::pointPolygonTest(outlineOf(code), cv::Point2f(point), false) >= 0.0;
}

/// Where a range may end so that as many lines are left behind it as fit.
int alignedEnd(int end, int spacing, int limit)
{
  return limit - (limit - end) / spacing * spacing;
}

}  // namespace

Code CodeTrack::at(double time_s) const
{
  Code moved = code;
  if (moving)
    for (cv::Point2d& point : moved.polygon)
      point += velocity * (time_s - seen);
  return moved;
}

bool CodeTrack::isInViewAt(double time_s, const cv::Size& image) const
{
  const cv::Rect2d view({0.0, 0.0}, cv::Size2d(image));
  const Code expected = at(time_s);
  return std::all_of(expected.polygon.begin(), expected.polygon.end(),
                     [&view](const cv::Point2d& point) { return view.contains(point); });
}

cv::Rect CodeTrack::regionAt(double time_s, bool wide, const cv::Size& image) const
{
  const double side = longestSide(code), age = time_s - seen;
  const double motion = moving ? kPositionError * side + kMotionError * cv::norm(velocity) * age
                               : std::min(std::max(kMaxUntrackedSpeed * age, kInitialMotion), kFarthest) * side;
  const double border = motion + (kQuiet + (wide ? kWide : 0.0)) * side;
  return grown(cv::boundingRect(outlineOf(at(time_s))), cvCeil(border), image);
}

cv::Rect onLines(const cv::Rect& part, int spacing, const cv::Size& image)
{
  const cv::Point begin(part.x / spacing * spacing, part.y / spacing * spacing);
  return {begin,
          cv::Point(alignedEnd(part.br().x, spacing, image.width), alignedEnd(part.br().y, spacing, image.height))};
}

bool isWhole(const Code& code, const cv::Rect& part, const cv::Size& image)
{
  const cv::Rect box = grown(cv::boundingRect(outlineOf(code)), kCut, image);
  return (box & part) == box;
}

bool saysTheSame(const Code& a, const Code& b)
{
  return a.type == b.type && a.data == b.data;
}

bool isSame(const Code& a, const Code& b)
{
  return saysTheSame(a, b) && (a.type != "qr" || holds(a, middleOf(b)) || holds(b, middleOf(a)));
}

void follow(std::vector<CodeTrack>& tracks, double time_s, const Code& code)
{
  CodeTrack* nearest = nullptr;
  double least = 0.0;
  for (CodeTrack& track : tracks)
  {
    if (track.seen >= time_s || !saysTheSame(track.code, code)) continue;
    const double distance = cv::norm(middleOf(track.at(time_s)) - middleOf(code));
    if (nearest && distance >= least) continue;
    nearest = &track;
    least = distance;
  }
  if (!nearest)
  {
    tracks.push_back({code, time_s, false, {}});
    return;
  }
  const double elapsed = time_s - nearest->seen;
  nearest->velocity = (middleOf(code) - middleOf(nearest->code)) / elapsed;
  nearest->moving = least <= kFastest * elapsed * longestSide(code);
  nearest->code = code;
  nearest->seen = time_s;
}

void forget(std::vector<CodeTrack>& tracks, double before)
{
  const auto isOld = [before](const CodeTrack& track) { return track.seen < before; };
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), isOld), tracks.end());
}

}  // namespace robot_vision
