#include "tag_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/common/motion_bounds.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"
#include "tag_search.hpp"

namespace robot_vision
{
namespace
{

constexpr int kTileSide = 4;       // px after decimation, of the tiles for which the library finds a threshold each
constexpr double kMinEdge = 16.0;  // px after decimation that the shortest edge of a tag must have to be found reliably
constexpr double kMaxDecimated = 8;  // a higher decimation saves no time

using Corners = std::array<cv::Point2d, 4>;

std::pair<double, double> shortestAndLongest(const Corners& corners)
{
  std::array<double, 4> sides;
  for (std::size_t i = 0; i < sides.size(); ++i)
    sides[i] = cv::norm(corners[(i + 1) % sides.size()] - corners[i]);
  const auto limits = std::minmax_element(sides.begin(), sides.end());
  return {*limits.first, *limits.second};
}

/// The rectangle of a tag with all its cells, and `border` px around it.
cv::Rect around(const Tag& tag, const Corners& corners, double border, const cv::Size& image)
{
  const TagFamily& family = tagFamily(tag.family);
  const double cells = (family.width - family.width_at_border) / 2.0;
  const double cell = shortestAndLongest(corners).second / family.width_at_border;
  const std::vector<cv::Point2f> points(corners.begin(), corners.end());
  return grown(cv::boundingRect(points), cvCeil(cells * cell + border), image);
}

cv::Point2d middleOf(const Corners& corners)
{
  return (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
}

/// The track that the tag continues: the one expected nearest to it among those that were not yet seen in its frame.
std::vector<TagTrack>::iterator nearest(std::vector<TagTrack>& tracks, const Tag& tag, double time_s)
{
  auto best = tracks.end();
  double least = 0.0;
  for (auto track = tracks.begin(); track != tracks.end(); ++track)
  {
    if (track->tag.id != tag.id || track->tag.family != tag.family || track->seen >= time_s) continue;
    const double distance = cv::norm(middleOf(track->cornersAt(time_s)) - middleOf(tag.corners));
    if (best != tracks.end() && distance >= least) continue;
    best = track;
    least = distance;
  }
  return best;
}

double borderOf(double decimate)
{
  return (kTileSide + 1) * decimate;
}

/// A range that holds the given one, begins and ends on the grid, and is at least `least` px long. In a part of such
/// ranges the library finds the same thresholds as in the whole image.
cv::Range aligned(int begin, int end, int least, int grid, int limit)
{
  const int missing = std::max(least - (end - begin), 0);
  begin = std::max(std::min(begin - missing / 2, limit - least), 0) / grid * grid;
  end = std::max(end, begin + least);
  return {begin, std::min((end + grid - 1) / grid * grid, limit)};
}

}  // namespace

Corners TagTrack::cornersAt(double time_s) const
{
  Corners corners = tag.corners;
  if (moving)
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] += velocity[i] * (time_s - seen);
  return corners;
}

Tag TagTrack::at(double time_s) const
{
  Tag moved = tag;
  moved.corners = cornersAt(time_s);
  for (std::size_t i = 0; i < moved.corners.size(); ++i)
    moved.center += (moved.corners[i] - tag.corners[i]) / 4.0;
  return moved;
}

bool TagTrack::isInViewAt(double time_s, const cv::Size& image) const
{
  const cv::Rect2d view({0.0, 0.0}, cv::Size2d(image));
  const Corners corners = cornersAt(time_s);
  return std::all_of(corners.begin(), corners.end(), [&view](const cv::Point2d& p) { return view.contains(p); });
}

TagRegion TagTrack::regionAt(double time_s, double decimate, const cv::Size& image) const
{
  const auto sides = shortestAndLongest(tag.corners);
  if (decimate == 0.0) decimate = std::min(std::max(std::floor(sides.first / kMinEdge), 1.0), kMaxDecimated);
  double speed = 0.0;
  for (const cv::Point2d& v : velocity)
    speed = std::max(speed, cv::norm(v));
  const double motion = motionMargin(moving, speed, time_s - seen, sides.second);
  const cv::Rect box = around(tag, cornersAt(time_s), borderOf(decimate) + motion, image);
  if (box.empty()) return {{}, decimate};
  const int grid = cvRound(kTileSide * decimate);
  const int least = cvCeil(kMinSearched * decimate);
  const cv::Range x = aligned(box.x, box.br().x, least, grid, image.width);
  const cv::Range y = aligned(box.y, box.br().y, least, grid, image.height);
  return {{x.start, y.start, x.size(), y.size()}, decimate};
}

bool isWhole(const Tag& tag, const TagRegion& region, const cv::Size& image)
{
  const cv::Rect box = around(tag, tag.corners, borderOf(region.decimate), image);
  return (box & region.part) == box;
}

void join(std::vector<TagRegion>& regions)
{
  for (std::size_t i = 0; i < regions.size();)
  {
    const TagRegion& region = regions[i];
    const auto other = std::find_if(regions.begin(), regions.begin() + static_cast<std::ptrdiff_t>(i),
                                    [&region](const TagRegion& r) {
                                      return r.decimate == region.decimate &&
                                             (r.part | region.part).area() <= r.part.area() + region.part.area();
                                    });
    if (other == regions.begin() + static_cast<std::ptrdiff_t>(i))
    {
      ++i;
      continue;
    }
    other->part |= region.part;
    regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(i));
    i = static_cast<std::size_t>(other - regions.begin());  // it may now be joined with others, too
  }
}

bool isSame(const Tag& a, const Tag& b)
{
  if (a.id != b.id || a.family != b.family) return false;
  const auto holds = [](const Tag& tag, const cv::Point2d& point)
  {
    const std::vector<cv::Point2f> outline(tag.corners.begin(), tag.corners.end());
    return cv::pointPolygonTest(outline, cv::Point2f(point), false) >= 0.0;
  };
  return holds(a, b.center) || holds(b, a.center);
}

void merge(std::vector<Tag>& tags, const std::vector<Tag>& more)
{
  for (const Tag& tag : more)
  {
    const auto same = std::find_if(tags.begin(), tags.end(), [&tag](const Tag& t) { return isSame(t, tag); });
    if (same == tags.end())
      tags.push_back(tag);
    else if (tag.hamming < same->hamming)
      *same = tag;
  }
}

void follow(std::vector<TagTrack>& tracks, double time_s, const std::vector<Tag>& tags)
{
  std::vector<TagTrack> followed;
  for (const Tag& tag : tags)
  {
    TagTrack next;
    next.tag = tag;
    next.seen = time_s;
    const auto known = nearest(tracks, tag, time_s);
    if (known != tracks.end())
    {
      const double elapsed = time_s - known->seen;
      for (std::size_t i = 0; i < next.velocity.size(); ++i)
        next.velocity[i] = (tag.corners[i] - known->tag.corners[i]) / elapsed;
      next.moving = isMotion(cv::norm(middleOf(known->cornersAt(time_s)) - middleOf(tag.corners)), elapsed,
                             shortestAndLongest(tag.corners).second);
      tracks.erase(known);
    }
    followed.push_back(next);
  }
  followed.insert(followed.end(), tracks.begin(), tracks.end());
  tracks = std::move(followed);
}

}  // namespace robot_vision
