#include "robot_vision/tag_pose_tracker.hpp"

#include <cmath>
#include <iterator>
#include <map>

#include "body_pose.hpp"
#include "corner_filter.hpp"
#include "corner_noise.hpp"
#include "pose_choice.hpp"
#include "robot_vision/range.hpp"

namespace robot_vision
{

namespace
{

const double kRest = 0.9;  // probability from which a tag is taken to be at rest

struct Followed
{
  CornerFilter filter;
  double time;  // s, of the newest frame with it
};

}  // namespace

struct TagPoseTracker::Impl
{
  Impl(const Bundle& tags, const TagPoseParams& settings)
    : bundle(tags),
      params(settings),
      noise(settings.corner_noise * settings.corner_noise, settings.lasting_noise * settings.lasting_noise)
  {
  }

  void forget(double time_s)
  {
    if (!(time_s >= time && time_s - time <= params.max_gap))
    {
      followed.clear();
      choice.clear();
    }
    for (auto it = followed.begin(); it != followed.end();)
      it = time_s - it->second.time > params.max_gap ? followed.erase(it) : std::next(it);
  }

  /// The tags with their corners filtered; the share of the newest frame in them.
  double filter(double time_s, std::vector<SeenTag>& tags)
  {
    double gains = 0.0;
    for (SeenTag& tag : tags)
    {
      const auto [it, is_new] = followed.try_emplace(tag.tag.id, Followed{{tag.corners, noise.total()}, time_s});
      CornerFilter& corners = it->second.filter;
      if (!is_new)
      {
        corners.update(time_s - it->second.time, tag.corners, noise.fresh());
        it->second.time = time_s;
        if (corners.rest() > kRest) noise.addChange(corners.change());
      }
      tag.corners = corners.corners();
      tag.variance = corners.variance() + noise.lasting();
      gains += corners.gain();
    }
    return gains / static_cast<double>(tags.size());
  }

  /// Measures the noise by how badly the best pose fits the corners as they are.
  void measure(const Sighting& raw, const CameraModel& camera, const cv::Affine3d& near)
  {
    const double cost = fitPose(raw, camera, near).cost;
    const double freedom = 2.0 * static_cast<double>(raw.points.size()) - 6.0;
    if (std::isfinite(cost)) noise.addResiduals(cost * raw.variances[0], freedom);
  }

  Bundle bundle;
  TagPoseParams params;
  CornerNoise noise;
  PoseChoice choice;
  std::map<int, Followed> followed;
  double time = std::nan("");  // s, of the newest frame with a pose
};

void validate(const TagPoseParams& params)
{
  requireRange("corner_noise", params.corner_noise, 0.001, 10.0);
  requireRange("lasting_noise", params.lasting_noise, 0.0, 10.0);
  require(params.max_gap > 0.0 && params.max_gap <= 60.0, "max_gap", params.max_gap, "above 0 to 60");
}

TagPoseTracker::TagPoseTracker(const Bundle& bundle, const TagPoseParams& params)
{
  validate(bundle);
  validate(params);
  impl_ = std::make_unique<Impl>(bundle, params);
}

TagPoseTracker::~TagPoseTracker() = default;
TagPoseTracker::TagPoseTracker(TagPoseTracker&&) noexcept = default;
TagPoseTracker& TagPoseTracker::operator=(TagPoseTracker&&) noexcept = default;

const Bundle& TagPoseTracker::bundle() const
{
  return impl_->bundle;
}

double TagPoseTracker::cornerNoise() const
{
  return std::sqrt(impl_->noise.total());
}

std::optional<TagPoses> TagPoseTracker::update(double time_s, const std::vector<TagCorners>& seen,
                                               const CameraModel& camera)
{
  require(std::isfinite(time_s), "time", time_s, "finite (s)");
  validate(camera);
  Impl& self = *impl_;
  std::vector<SeenTag> tags = tagsOf(self.bundle, seen, camera, self.noise.total());
  if (tags.empty()) return std::nullopt;
  const Sighting raw = sightingOf(tags);
  self.forget(time_s);
  const double share = self.filter(time_s, tags);

  const std::vector<PoseFit> fits = fitBody(tags, camera);
  if (fits.empty()) return std::nullopt;
  const std::vector<WeighedPose> poses = self.choice.update(time_s - self.time, fits, share);
  self.time = time_s;
  self.measure(raw, camera, poses.front().fit.pose);
  return posesOf(poses, raw, camera);
}

}  // namespace robot_vision
