#include "robot_vision/tags/pose/tag_pose_tracker.hpp"

#include <cmath>
#include <iterator>
#include <map>

#include "bundle_pose.hpp"
#include "corner_filter.hpp"
#include "corner_noise.hpp"
#include "pose_ambiguity.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{

namespace
{

const double kMinRestProbability = 0.9;  // from which a tag is taken to be at rest
const double kGuessFreedom = 4.0;        // weight of corner_noise, in degrees of freedom
const double kMeasuredFreedom = 100.0;   // weight of the covariances measured in the images
// The share of what a frame tells about which pose is right that is new: even in motion, pixels, prints and the lens
// cause nearly the same errors in consecutive frames. The value is cautious: for moving tags of 10 to 16 px of all
// families, the probability given to wrong poses is two to three times as large as their frequency.
const double kNewInformation = 0.3;

/// The mean variance of all coordinates, px^2.
double varianceOf(const CornerCovariance& covariance)
{
  return cv::trace(covariance) / 8.0;
}

struct FollowedTag
{
  CornerFilter filter;
  double time;  // s, of the newest frame with it
};

}  // namespace

struct TagPoseTracker::Impl
{
  Impl(const Bundle& tags, const TagPoseParams& settings) : bundle(tags), params(settings) {}

  CornerNoise& noiseOf(const SeenTag& tag) { return tag.measured ? measured_noise : guessed_noise; }

  double lensVariance() const { return params.lasting_noise * params.lasting_noise; }

  /// The bundle's tags in a frame, with the variances that are known so far.
  std::vector<SeenTag> matchTags(const std::vector<TagCorners>& seen, const CameraModel& camera)
  {
    std::vector<SeenTag> tags = tagsOf(bundle, seen, camera, params.corner_noise * params.corner_noise, lensVariance());
    for (SeenTag& tag : tags)
    {
      tag.covariance *= noiseOf(tag).total();
      tag.lens_variance *= noiseOf(tag).total();
    }
    return tags;
  }

  void dropLostTags(double time_s)
  {
    if (!(time_s >= time && time_s - time <= params.max_gap))
    {
      followed.clear();
      ambiguity.clear();
    }
    for (auto it = followed.begin(); it != followed.end();)
      it = time_s - it->second.time > params.max_gap ? followed.erase(it) : std::next(it);
  }

  /// Filters the corners of the tags and returns the mean weight of the newest frame in them.
  double filter(double time_s, std::vector<SeenTag>& tags)
  {
    double gains = 0.0;
    for (SeenTag& tag : tags)
    {
      CornerNoise& noise = noiseOf(tag);
      const double total = varianceOf(tag.covariance), unit = total / noise.total();
      const double min_lasting = tag.measured ? 0.0 : lensVariance() / unit, fresh = unit * noise.fresh(min_lasting);
      const auto [it, is_new] = followed.try_emplace(tag.tag.id, FollowedTag{{tag.corners, fresh}, time_s});
      CornerFilter& corners = it->second.filter;
      if (!is_new)
      {
        corners.update(time_s - it->second.time, tag.corners, fresh);
        it->second.time = time_s;
        if (corners.rest() > kMinRestProbability) noise.addChange(corners.change() / unit);
      }
      tag.corners = corners.corners();
      tag.covariance *= (corners.variance() + unit * noise.lasting(min_lasting)) / total;
      gains += corners.gain();
    }
    return gains / static_cast<double>(tags.size());
  }

  /// Measures the noise by the residuals of each tag's unfiltered corners. The tags are fitted one by one, because the
  /// residuals of all together would also contain the errors of the layout.
  void measureNoise(const std::vector<SeenTag>& tags, const Observation& raw, const CameraModel& camera,
                    const cv::Affine3d& near)
  {
    const double freedom = 2.0;  // eight coordinates minus the six of a pose
    for (CornerNoise* noise : {&guessed_noise, &measured_noise})
    {
      double squares = 0.0, count = 0.0;
      for (std::size_t i = 0; i < tags.size(); ++i)
      {
        if (&noiseOf(tags[i]) != noise) continue;
        const double cost = fitPose(cornersOnly({raw[i]}), camera, near).cost;
        if (!std::isfinite(cost)) continue;
        squares += cost * noise->total();
        count += freedom;
      }
      if (count > 0.0) noise->addResiduals(squares, count);
    }
  }

  Bundle bundle;
  TagPoseParams params;
  CornerNoise guessed_noise{kGuessFreedom}, measured_noise{kMeasuredFreedom};
  double corner_variance = params.corner_noise * params.corner_noise;  // px^2, of the newest frame's corners
  PoseAmbiguity ambiguity;
  std::map<int, FollowedTag> followed;
  double time = std::nan("");  // s, of the newest frame with a pose
};

TagPoseTracker::TagPoseTracker(const Bundle& bundle, const TagPoseParams& params)
{
  validate(bundle);
  validate(params);
  impl_ = std::make_unique<Impl>(bundle, params);
}

TagPoseTracker::~TagPoseTracker() = default;

double TagPoseTracker::cornerNoise() const
{
  return std::sqrt(impl_->corner_variance);
}

std::optional<TagPoses> TagPoseTracker::update(double time_s, const std::vector<TagCorners>& seen,
                                               const CameraModel& camera)
{
  require(std::isfinite(time_s), "time", time_s, "finite (s)");
  validate(camera);
  Impl& self = *impl_;
  std::vector<SeenTag> tags = self.matchTags(seen, camera);
  if (tags.empty()) return std::nullopt;
  const Observation raw = observationOf(tags, camera);
  self.dropLostTags(time_s);
  const double share = self.filter(time_s, tags);

  const std::vector<PoseRefinement> fits = fitBundle(tags, camera);
  if (fits.empty()) return std::nullopt;
  const std::vector<WeightedPose> poses = self.ambiguity.update(time_s - self.time, fits, kNewInformation * share);
  self.time = time_s;
  self.measureNoise(tags, raw, camera, poses.front().fit.pose);
  self.corner_variance = varianceOf(raw.front().information.inv());
  return posesOf(poses, raw, camera);
}

}  // namespace robot_vision
