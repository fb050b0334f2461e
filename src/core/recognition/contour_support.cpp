#include "contour_support.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr int kRadius = 3;         // px, from where a contour should be to where it may be
constexpr double kBeside = 3.0;    // px, from an outline to what is seen inside and outside of it
constexpr double kGate = 4.0;      // standard deviations, that a depth is off if it is of something else
constexpr double kMinJump = 0.01;  // m, behind an outline
constexpr int kMinPoints = 12;     // that tell something

enum class Support
{
  kNone,
  kFound,
  kHidden,  // nobody can tell
  kUntold,  // there are no depths that tell it
};

struct Tally
{
  int all = 0, found = 0;

  void add(Support support)
  {
    if (support == Support::kHidden || support == Support::kUntold) return;
    ++all;
    found += support == Support::kFound ? 1 : 0;
  }

  double share() const
  {
    return all < kMinPoints ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(found) / all;
  }
};

/// What the depths beside a contour at this depth say; `is_outline`: there must be something else on the other side.
Support depthSupport(const ContourSearch& search, const cv::Point2d& place, const ContourPoint& contour, double depth,
                     double gate)
{
  const cv::Point2d way = kBeside * cv::Point2d(cv::Vec2d(contour.normal));
  const auto inside = static_cast<double>(search.depthAt(contour.is_outline ? place - way : place));
  if (inside < depth - gate) return Support::kHidden;
  if (!contour.is_outline) return Support::kNone;
  const auto outside = static_cast<double>(search.depthAt(place + way));
  if (outside < depth - gate) return Support::kHidden;
  // Where the object itself has no depth, something may hide it: beside what is near, a Kinect measures none.
  if (std::isnan(inside)) return Support::kHidden;
  if (std::isnan(outside)) return Support::kUntold;
  return outside > depth + gate && inside < depth + gate ? Support::kFound : Support::kNone;
}

}  // namespace

void compareContours(const RenderedRegion& region, const RecognitionFrame& frame,
                     const std::vector<ContourPoint>& points, const DepthErrorParams& errors,
                     const VerifierParams& params, PoseEvidence& evidence)
{
  const ContourSearch search(frame, params.min_gradient);
  const Pinhole camera(frame.camera().K);
  Tally outline, inner;
  for (const ContourPoint& contour : points)
  {
    const cv::Vec3d point = region.center + cv::Vec3d(contour.point);
    const cv::Point2d place = camera.project(point);
    const double gate = std::max(kGate * depthDeviation(point[2], errors), kMinJump);
    Support support = Support::kNone;
    if (frame.hasDepth()) support = depthSupport(search, place, contour, point[2], gate);
    const bool is_open = support == Support::kNone || support == Support::kUntold;
    if (is_open && search.colorEdge(place, contour.normal, kRadius)) support = Support::kFound;
    if (support == Support::kUntold && frame.hasColors()) support = Support::kNone;
    if (contour.is_outline)
      outline.add(support);
    else if (frame.hasColors())
      inner.add(support);
  }
  evidence.outline = outline.share();
  evidence.inner = inner.share();
}

}  // namespace robot_vision
