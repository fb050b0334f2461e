#include "suppression.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace robot_vision
{
namespace
{

double areaOf(const CornerBox& box)
{
  return (box.x1 - box.x0) * (box.y1 - box.y0);
}

double sharedArea(const CornerBox& a, const CornerBox& b)
{
  const double width = std::min(a.x1, b.x1) - std::max(a.x0, b.x0);
  const double height = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

bool overlaps(double shared, double area_a, double area_b, double threshold)
{
  return shared > threshold * (area_a + area_b - shared);
}

/// Boxes along the axes.
struct StraightBox
{
  explicit StraightBox(const Candidate& candidate) : box(candidate.box), area(areaOf(box)) {}

  double shared(const StraightBox& other) const { return sharedArea(box, other.box); }

  CornerBox box;
  double area;
};

struct TurnedBox
{
  explicit TurnedBox(const Candidate& candidate) : outline(outlineOf(candidate)), area(areaOf(candidate.box))
  {
    const auto x = std::minmax({outline[0].x, outline[1].x, outline[2].x, outline[3].x});
    const auto y = std::minmax({outline[0].y, outline[1].y, outline[2].y, outline[3].y});
    around = {x.first, y.first, x.second, y.second};
  }

  double shared(const TurnedBox& other) const
  {
    return sharedArea(around, other.around) > 0.0 ? robot_vision::sharedArea(outline, other.outline) : 0.0;
  }

  BoxOutline outline;
  double area;
  CornerBox around;
};

template <class Box>
std::vector<Candidate> suppressBoxes(const std::vector<Candidate>& sorted, const HeadParams& params)
{
  std::vector<Candidate> kept;
  std::vector<Box> boxes;  // of `kept`
  for (const Candidate& candidate : sorted)
  {
    const Box box(candidate);
    bool hidden = false;
    for (std::size_t i = 0; i < kept.size() && !hidden; ++i)
    {
      if (!params.class_agnostic && kept[i].class_id != candidate.class_id) continue;
      const double shared = box.shared(boxes[i]);
      hidden = shared > 0.0 && overlaps(shared, box.area, boxes[i].area, params.iou_threshold);
    }
    if (hidden) continue;
    kept.push_back(candidate);
    boxes.push_back(box);
    if (kept.size() == static_cast<std::size_t>(params.max_detections)) break;
  }
  return kept;
}

}  // namespace

BoxOutline outlineOf(const Candidate& candidate)
{
  const CornerBox& box = candidate.box;
  const cv::Point2d center((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
  const double c = std::cos(candidate.angle), s = std::sin(candidate.angle);
  const cv::Point2d along((box.x1 - box.x0) / 2 * c, (box.x1 - box.x0) / 2 * s);
  const cv::Point2d across((box.y0 - box.y1) / 2 * s, (box.y1 - box.y0) / 2 * c);
  return {center - along - across, center + along - across, center + along + across, center - along + across};
}

std::vector<Candidate> suppress(const std::vector<Candidate>& sorted, const HeadParams& params)
{
  return params.task == "oriented" ? suppressBoxes<TurnedBox>(sorted, params)
                                   : suppressBoxes<StraightBox>(sorted, params);
}

}  // namespace robot_vision
