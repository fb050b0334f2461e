#include "bundle_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "core/geometry/rigid_motion.hpp"
#include "corner_covariance.hpp"
#include "ippe_square.hpp"
#include "plane_gate.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{

namespace
{

/// The corners of a tag of `size` (m) in the tag's frame.
std::array<cv::Point3d, 4> cornersOf(double size)
{
  const double half = size / 2.0;
  return {cv::Point3d(-half, -half, 0.0), {half, -half, 0.0}, {half, half, 0.0}, {-half, half, 0.0}};
}

/// The corners of a tag in the body's frame.
std::array<cv::Point3d, 4> cornersOf(const BundleTag& tag)
{
  std::array<cv::Point3d, 4> corners = cornersOf(tag.size);
  for (cv::Point3d& corner : corners)
    corner = tag.pose * corner;
  return corners;
}

std::array<cv::Point2d, 4> raysOf(const std::array<cv::Point2d, 4>& corners, const CameraModel& camera)
{
  std::array<cv::Point2d, 4> rays;
  std::transform(corners.begin(), corners.end(), rays.begin(), [&](const cv::Point2d& p) { return camera.ray(p); });
  return rays;
}

/// True if four points are the corners of a convex shape, counter-clockwise in an image whose y points down, and each
/// triangle of three of them has more than this area.
bool isConvex(const std::array<cv::Point2d, 4>& p, double min_area)
{
  for (std::size_t i = 0; i < 4; ++i)
  {
    const cv::Point2d &a = p[i], &b = p[(i + 1) % 4], &c = p[(i + 2) % 4];
    if (!((c - b).cross(b - a) / 2.0 > min_area)) return false;  // also for NaN
  }
  return true;
}

void validateCorners(const TagCorners& seen, const CameraModel& camera)
{
  std::ostringstream corners;
  for (const cv::Point2d& p : seen.corners)
    corners << (corners.tellp() ? ", " : "") << '(' << p.x << ", " << p.y << ')';
  const std::string name = "corners of tag " + std::to_string(seen.id);
  const double min_area = 0.5;  // px^2
  require(isConvex(seen.corners, min_area), name, corners.str(),
          "finite and convex, counter-clockwise as seen, of more than 1 px^2");
  require(isConvex(raysOf(seen.corners, camera), 0.0), name, corners.str(), "where the camera's distortion has rays");
  require(!seen.covariance || isCovariance(*seen.covariance), "covariance of the " + name, "none",
          "symmetric, positive definite and finite");
  if (seen.plane) validate(*seen.plane);
}

/// Two poses of the body to start the fit from, the better one first. They come from the tag whose two poses explain
/// the other tags best, too.
std::array<cv::Affine3d, 2> initialPoses(const std::vector<SeenTag>& tags, const Observation& observation,
                                         const CameraModel& camera)
{
  std::array<cv::Affine3d, 2> best;
  double min_cost = std::numeric_limits<double>::infinity();
  for (const SeenTag& seen : tags)
  {
    std::array<cv::Affine3d, 2> poses = squarePoses(raysOf(seen.corners, camera), seen.tag.size);
    for (cv::Affine3d& pose : poses)
      pose = pose * seen.tag.pose.inv();
    double cost = costOf(observation, camera, poses[0]);
    const double other_cost = costOf(observation, camera, poses[1]);
    if (other_cost < cost)
    {
      std::swap(poses[0], poses[1]);
      cost = other_cost;
    }
    if (&seen == &tags.front() || cost < min_cost)
    {
      min_cost = cost;
      best = poses;
    }
  }
  return best;
}

/// The uncertainty of the inverse depth of a tag's plane by that of its pose on the body.
cv::Matx33d planeNoise(const BundleTag& tag, const cv::Affine3d& body)
{
  PlaneJacobian J = planeJacobian({{0, 0, 1}, {0, 0, 0}, {}, {}}, body * tag.pose);
  for (int row = 0; row < J.rows; ++row)
    for (int column = 0; column < J.cols; ++column)
      J(row, column) *= column < 3 ? tag.shift_noise : tag.turn_noise;
  return J * J.t();
}

/// Adds the uncertainty of the bundle's layout to the observation of a body near this pose.
Observation withLayoutNoise(Observation observation, const std::vector<SeenTag>& tags, const CameraModel& camera,
                            const cv::Affine3d& body)
{
  for (std::size_t i = 0; i < tags.size(); ++i)
  {
    const BundleTag& tag = tags[i].tag;
    if (tag.shift_noise == 0.0 && tag.turn_noise == 0.0) continue;
    MotionJacobian J = motionJacobian(cornersOf(tag.size), camera, body * tag.pose);
    for (int row = 0; row < J.rows; ++row)
      for (int column = 0; column < J.cols; ++column)
        J(row, column) *= column < 3 ? tag.shift_noise : tag.turn_noise;
    const CornerCovariance layout = J * J.t();
    if (!std::isfinite(cv::norm(layout))) continue;  // the tag is behind the camera, so there is no pose
    observation[i].information = inverseOf(inverseOf(observation[i].information) + layout);
    if (observation[i].plane) observation[i].plane->covariance += planeNoise(tag, body);
  }
  return observation;
}

/// The part of a pose's covariance that comes from lens errors that several tags share. The fit itself takes the errors
/// of different tags to be independent.
cv::Matx66d sharedLensError(const PoseRefinement& fit, const Observation& observation, const std::vector<SeenTag>& tags,
                            const CameraModel& camera)
{
  using Gain = cv::Matx<double, 6, 8>;   // change of the pose with the lens errors in a tag's corners
  std::vector<const SeenTag*> affected;  // by lens errors
  std::vector<Gain> gains;
  for (std::size_t i = 0; i < tags.size(); ++i)
  {
    if (tags[i].lens_variance == 0.0) continue;
    affected.push_back(&tags[i]);
    gains.push_back(std::sqrt(tags[i].lens_variance) * fit.covariance *
                    motionJacobian(observation[i].points, camera, fit.pose).t() * observation[i].information);
  }
  cv::Matx66d shared = cv::Matx66d::zeros();
  for (std::size_t a = 0; a < affected.size(); ++a)
  {
    Gain others = Gain::zeros();  // the effect of the other tags, as far as their lens errors correlate with this tag's
    for (std::size_t b = 0; b < a; ++b)
      others += gains[b] * distortionCorrelation(affected[b]->corners, affected[a]->corners, camera);
    shared += gains[a] * others.t();
  }
  return shared + shared.t();
}

/// True if some tag faces the camera and is not so far away that it covers a small part of a pixel only.
bool isPlausible(const cv::Affine3d& body, const std::vector<SeenTag>& tags)
{
  const double max_distance = 1e4;  // in sizes of the tag
  return std::any_of(tags.begin(), tags.end(),
                     [&](const SeenTag& seen)
                     {
                       const cv::Affine3d pose = body * seen.tag.pose;
                       const cv::Vec3d place = pose.translation(), out = pose.rotation() * cv::Vec3d(0, 0, 1);
                       return out.dot(place) < 0.0 && cv::norm(place) < max_distance * seen.tag.size;
                     });
}

/// The poses near these that explain an observation and are plausible, those that are the same only once.
std::vector<PoseRefinement> fitAll(const Observation& observation, const std::vector<SeenTag>& tags,
                                   const CameraModel& camera, const std::vector<cv::Affine3d>& starts)
{
  const double same = 0.005;  // rad, below which two results are the same pose
  std::vector<PoseRefinement> fits;
  for (const cv::Affine3d& start : starts)
  {
    PoseRefinement fit = fitPose(observation, camera, start);
    if (!std::isfinite(fit.cost) || !isPlausible(fit.pose, tags)) continue;
    fit.covariance += sharedLensError(fit, observation, tags, camera);
    if (fits.empty() || cv::norm(difference(fits[0].pose, fit.pose).get_minor<3, 1>(3, 0)) > same) fits.push_back(fit);
  }
  std::sort(fits.begin(), fits.end(), [](const PoseRefinement& a, const PoseRefinement& b) { return a.cost < b.cost; });
  return fits;
}

}  // namespace

std::vector<SeenTag> tagsOf(const Bundle& bundle, const std::vector<TagCorners>& seen, const CameraModel& camera,
                            double variance, double lens_variance)
{
  std::vector<SeenTag> tags;
  std::set<int> ids;
  for (const TagCorners& one : seen)
  {
    const auto tag = std::find_if(bundle.tags.begin(), bundle.tags.end(),
                                  [&](const BundleTag& candidate) { return candidate.id == one.id; });
    if (tag == bundle.tags.end()) continue;
    require(ids.insert(one.id).second, "tag " + std::to_string(one.id), "seen twice", "seen once");
    validateCorners(one, camera);
    tags.push_back({*tag, one.corners, one.covariance.value_or(variance * CornerCovariance::eye()),
                    one.covariance.has_value(), lens_variance, one.plane});
  }
  return tags;
}

Observation observationOf(const std::vector<SeenTag>& tags, const CameraModel& camera)
{
  Observation observation;
  for (const SeenTag& seen : tags)
  {
    const CornerCovariance lens_error = seen.lens_variance * distortionCorrelation(seen.corners, seen.corners, camera);
    observation.push_back({cornersOf(seen.tag), seen.corners, inverseOf(seen.covariance + lens_error), std::nullopt});
    if (!seen.plane) continue;
    const cv::Affine3d& pose = seen.tag.pose;
    observation.back().plane = {pose.rotation() * cv::Vec3d(0, 0, 1), pose.translation(), seen.plane->inverse_depth,
                                seen.plane->covariance};
  }
  return observation;
}

std::vector<PoseRefinement> fitBundle(const std::vector<SeenTag>& tags, const CameraModel& camera)
{
  if (tags.empty()) return {};
  const Observation exact = observationOf(tags, camera);
  const std::array<cv::Affine3d, 2> starts = initialPoses(tags, cornersOnly(exact), camera);
  Observation observation = withLayoutNoise(exact, tags, camera, starts[0]);
  const std::vector<PoseRefinement> fits =
      fitAll(cornersOnly(observation), tags, camera, {starts.begin(), starts.end()});
  if (!keepExplainedPlanes(fits, camera, observation)) return fits;
  std::vector<cv::Affine3d> poses;
  for (const PoseRefinement& fit : fits)
    poses.push_back(fit.pose);
  std::vector<PoseRefinement> joint = fitAll(observation, tags, camera, poses);
  return joint.empty() ? fits : joint;  // no pose may explain all planes, each of which some pose explains
}

TagPoses posesOf(const std::vector<WeightedPose>& poses, const Observation& observation, const CameraModel& camera)
{
  const auto estimate = [&](const PoseRefinement& fit) {
    return PoseEstimate{fit.pose, fit.covariance, errorOf(observation, camera, fit.pose)};
  };
  TagPoses result;
  result.best = estimate(poses[0].fit);
  result.probability = poses[0].probability;
  result.planes = poses[0].fit.planes;
  if (poses.size() == 1) return result;
  result.other = estimate(poses[1].fit);
  result.ratio = result.best.error / result.other->error;
  // The second moment of the two possible poses about the best one.
  const cv::Vec6d between = difference(poses[0].fit.pose, poses[1].fit.pose);
  result.best.covariance = poses[0].probability * result.best.covariance +
                           poses[1].probability * (result.other->covariance + between * between.t());
  return result;
}

}  // namespace robot_vision
