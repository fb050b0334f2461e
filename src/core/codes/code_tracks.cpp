#include "code_tracks.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/common/motion_bounds.hpp"
#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr double kQuietZone = 0.15;  // longest sides; the search needs to see so much around a code
constexpr double kWideMargin = 0.5;  // longest sides, added where a code was not found without
constexpr int kCutMargin = 2;        // px; a code that is nearer to the edge of a part may continue beyond it

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

bool contains(const Code& code, const cv::Point2d& point)
{
  return cv::pointPolygonTest(outlineOf(code), cv::Point2f(point), false) >= 0.0;
}

/// The smallest end of a range, not below `end`, from which a whole number of scan lines leads to `limit`.
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
  const double side = longestSide(code);
  const double motion = motionMargin(moving, cv::norm(velocity), time_s - seen, side);
  const double border = motion + (kQuietZone + (wide ? kWideMargin : 0.0)) * side;
  return grown(cv::boundingRect(outlineOf(at(time_s))), cvCeil(border), image);
}

cv::Rect alignedToScanLines(const cv::Rect& part, int spacing, const cv::Size& image)
{
  const cv::Point begin(part.x / spacing * spacing, part.y / spacing * spacing);
  return {begin,
          cv::Point(alignedEnd(part.br().x, spacing, image.width), alignedEnd(part.br().y, spacing, image.height))};
}

bool isWhole(const Code& code, const cv::Rect& part, const cv::Size& image)
{
  const cv::Rect box = grown(cv::boundingRect(outlineOf(code)), kCutMargin, image);
  return (box & part) == box;
}

bool haveSameContent(const Code& a, const Code& b)
{
  return a.type == b.type && a.data == b.data;
}

bool isSame(const Code& a, const Code& b)
{
  return haveSameContent(a, b) && (a.type != "qr" || contains(a, middleOf(b)) || contains(b, middleOf(a)));
}

void follow(std::vector<CodeTrack>& tracks, double time_s, const Code& code)
{
  CodeTrack* nearest = nullptr;
  double min_distance = 0.0;
  for (CodeTrack& track : tracks)
  {
    if (track.seen >= time_s || !haveSameContent(track.code, code)) continue;
    const double distance = cv::norm(middleOf(track.at(time_s)) - middleOf(code));
    if (nearest && distance >= min_distance) continue;
    nearest = &track;
    min_distance = distance;
  }
  if (!nearest)
  {
    tracks.push_back({code, time_s, false, {}});
    return;
  }
  const double elapsed = time_s - nearest->seen;
  nearest->velocity = (middleOf(code) - middleOf(nearest->code)) / elapsed;
  nearest->moving = isMotion(min_distance, elapsed, longestSide(code));
  nearest->code = code;
  nearest->seen = time_s;
}

}  // namespace robot_vision
