#include "plane_gate.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace robot_vision
{
namespace
{

// Which one in 100000 exceeds, with three degrees of freedom. Corners are measured very wrong more often than a normal
// distribution has it, and then the plane is what is right.
constexpr double kMaxDistance = 25.9;

/// Whether one of the poses of the corners explains a plane of the observation, too, or one near it does.
bool isExplained(const SeenPlane& plane, std::size_t tag, const std::vector<PoseRefinement>& fits,
                 const Observation& corners, const CameraModel& camera)
{
  const auto is_near = [&](const PoseRefinement& fit) { return planeDistance(plane, fit) < kMaxDistance; };
  if (std::any_of(fits.begin(), fits.end(), is_near)) return true;
  // The corners of a small tag leave tilts open that the covariance of a pose, which is linear, does not reach.
  Observation both = corners;
  both[tag].plane = plane;
  return std::any_of(fits.begin(), fits.end(),
                     [&](const PoseRefinement& fit)
                     { return fitPose(both, camera, fit.pose).cost - fit.cost < kMaxDistance; });
}

}  // namespace

bool keepExplainedPlanes(const std::vector<PoseRefinement>& fits, const CameraModel& camera, Observation& observation)
{
  const Observation corners = cornersOnly(observation);
  bool left = false;
  for (std::size_t i = 0; i < observation.size(); ++i)
  {
    std::optional<SeenPlane>& plane = observation[i].plane;
    if (plane && !isExplained(*plane, i, fits, corners, camera)) plane.reset();
    left = left || plane;
  }
  return left;
}

}  // namespace robot_vision
