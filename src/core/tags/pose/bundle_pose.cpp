#include "bundle_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "corner_covariance.hpp"
#include "ippe_square.hpp"
#include "lens_error.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{

namespace
{

/// In the tag's frame.
std::array<cv::Point3d, 4> cornersOf(double size)
{
  const double half = size / 2.0;
  return {cv::Point3d(-half, -half, 0.0), {half, -half, 0.0}, {half, half, 0.0}, {-half, half, 0.0}};
}

/// In the body's.
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

/// Whether four points are the corners of a convex shape, counter-clockwise as seen with y down, and each of the
/// triangles that three of them make has at least this area.
bool isConvex(const std::array<cv::Point2d, 4>& p, double least_area)
{
  for (std::size_t i = 0; i < 4; ++i)
  {
    const cv::Point2d &a = p[i], &b = p[(i + 1) % 4], &c = p[(i + 2) % 4];
    if (!((c - b).cross(b - a) / 2.0 > least_area)) return false;  // so that NaN is refused, too
  }
  return true;
}

void validateCorners(const TagCorners& seen, const CameraModel& camera)
{
  std::ostringstream corners;
  for (const cv::Point2d& p : seen.corners)
    corners << (corners.tellp() ? ", " : "") << '(' << p.x << ", " << p.y << ')';
  const std::string name = "corners of tag " + std::to_string(seen.id);
  const double least_area = 0.5;  // px^2
  require(isConvex(seen.corners, least_area), name, corners.str(),
          "finite and convex, counter-clockwise as seen, of more than 1 px^2");
  require(isConvex(raysOf(seen.corners, camera), 0.0), name, corners.str(), "where the camera's distortion has rays");
  require(!seen.covariance || isCovariance(*seen.covariance), "covariance of the " + name, "none",
          "symmetric, positive definite and finite");
}

/// The poses of the body by those of each tag; those are best that explain the other tags, too. The better one first.
std::array<cv::Affine3d, 2> startsOf(const std::vector<SeenTag>& tags, const Sighting& sighting,
                                     const CameraModel& camera)
{
  std::array<cv::Affine3d, 2> best;
  double least = std::numeric_limits<double>::infinity();
  for (const SeenTag& seen : tags)
  {
    std::array<cv::Affine3d, 2> poses = squarePoses(raysOf(seen.corners, camera), seen.tag.size);
    for (cv::Affine3d& pose : poses)
      pose = pose * seen.tag.pose.inv();
    double cost = costOf(sighting, camera, poses[0]);
    const double other_cost = costOf(sighting, camera, poses[1]);
    if (other_cost < cost)
    {
      std::swap(poses[0], poses[1]);
      cost = other_cost;
    }
    if (&seen == &tags.front() || cost < least)
    {
      least = cost;
      best = poses;
    }
  }
  return best;
}

/// The sighting with what the layout leaves open of where a body near there is seen.
Sighting withLayout(Sighting sighting, const std::vector<SeenTag>& tags, const CameraModel& camera,
                    const cv::Affine3d& body)
{
  for (std::size_t i = 0; i < tags.size(); ++i)
  {
    const BundleTag& tag = tags[i].tag;
    if (tag.shift_noise == 0.0 && tag.turn_noise == 0.0) continue;
    MotionJacobian J = pixelsByMotion(cornersOf(tag.size), camera, body * tag.pose);
    for (int row = 0; row < J.rows; ++row)
      for (int column = 0; column < J.cols; ++column)
        J(row, column) *= column < 3 ? tag.shift_noise : tag.turn_noise;
    const CornerCovariance layout = J * J.t();
    if (!std::isfinite(cv::norm(layout))) continue;  // behind the camera: there is no pose
    sighting[i].information = inverseOf(inverseOf(sighting[i].information) + layout);
  }
  return sighting;
}

/// What the covariance of a pose lacks when the lens' errors are taken to be others in each tag.
cv::Matx66d sharedLensError(const PoseRefinement& fit, const Sighting& sighting, const std::vector<SeenTag>& tags,
                            const CameraModel& camera)
{
  using Gain = cv::Matx<double, 6, 8>;  // the pose by the pixels, for a lens with an error of 1 px
  std::vector<const SeenTag*> bent;     // by the lens
  std::vector<Gain> gains;
  for (std::size_t i = 0; i < tags.size(); ++i)
  {
    if (tags[i].lens_variance == 0.0) continue;
    bent.push_back(&tags[i]);
    gains.push_back(std::sqrt(tags[i].lens_variance) * fit.covariance *
                    pixelsByMotion(sighting[i].points, camera, fit.pose).t() * sighting[i].information);
  }
  cv::Matx66d shared = cv::Matx66d::zeros();
  for (std::size_t a = 0; a < bent.size(); ++a)
  {
    Gain others = Gain::zeros();  // what they do together, as alike as the lens is there and here
    for (std::size_t b = 0; b < a; ++b)
      others += gains[b] * distortionCorrelation(bent[b]->corners, bent[a]->corners, camera);
    shared += gains[a] * others.t();
  }
  return shared + shared.t();
}

/// Whether a body may be there: not so far away that a tag is a small part of a pixel, nor seen from behind only.
bool isPossible(const cv::Affine3d& body, const std::vector<SeenTag>& tags)
{
  const double farthest = 1e4;  // times the size of a tag
  return std::any_of(tags.begin(), tags.end(),
                     [&](const SeenTag& seen)
                     {
                       const cv::Affine3d pose = body * seen.tag.pose;
                       const cv::Vec3d place = pose.translation(), out = pose.rotation() * cv::Vec3d(0, 0, 1);
                       return out.dot(place) < 0.0 && cv::norm(place) < farthest * seen.tag.size;
                     });
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
                    one.covariance.has_value(), lens_variance});
  }
  return tags;
}

Sighting sightingOf(const std::vector<SeenTag>& tags, const CameraModel& camera)
{
  Sighting sighting;
  for (const SeenTag& seen : tags)
  {
    const CornerCovariance covariance = seen.covariance + lensError(seen.corners, seen.lens_variance, camera);
    sighting.push_back({cornersOf(seen.tag), seen.corners, inverseOf(covariance)});
  }
  return sighting;
}

std::vector<PoseRefinement> fitBody(const std::vector<SeenTag>& tags, const CameraModel& camera)
{
  std::vector<PoseRefinement> fits;
  if (tags.empty()) return fits;
  const double same = 0.005;  // rad, between two ways to the same pose
  const Sighting exact = sightingOf(tags, camera);
  const std::array<cv::Affine3d, 2> starts = startsOf(tags, exact, camera);
  const Sighting sighting = withLayout(exact, tags, camera, starts[0]);
  for (const cv::Affine3d& start : starts)
  {
    PoseRefinement fit = fitPose(sighting, camera, start);
    if (!std::isfinite(fit.cost) || !isPossible(fit.pose, tags)) continue;
    fit.covariance += sharedLensError(fit, sighting, tags, camera);
    if (fits.empty() || cv::norm(difference(fits[0].pose, fit.pose).get_minor<3, 1>(3, 0)) > same) fits.push_back(fit);
  }
  std::sort(fits.begin(), fits.end(), [](const PoseRefinement& a, const PoseRefinement& b) { return a.cost < b.cost; });
  return fits;
}

TagPoses posesOf(const std::vector<WeighedPose>& poses, const Sighting& sighting, const CameraModel& camera)
{
  const auto estimate = [&](const PoseRefinement& fit) {
    return PoseEstimate{fit.pose, fit.covariance, errorOf(sighting, camera, fit.pose)};
  };
  TagPoses result;
  result.best = estimate(poses[0].fit);
  result.probability = poses[0].probability;
  if (poses.size() == 1) return result;
  result.other = estimate(poses[1].fit);
  result.ratio = result.best.error / result.other->error;
  // The second moment about the best pose of what may be either of the two.
  const cv::Vec6d between = difference(poses[0].fit.pose, poses[1].fit.pose);
  result.best.covariance = poses[0].probability * result.best.covariance +
                           poses[1].probability * (result.other->covariance + between * between.t());
  return result;
}

}  // namespace robot_vision
