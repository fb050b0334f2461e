#include "robot_vision/tags/pose/tag_pose_tracker.hpp"

#include <algorithm>
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

const double kRest = 0.9;           // probability from which a tag is taken to be at rest
const double kGuess = 4.0;          // degrees of freedom that corner_noise is worth
const double kMeasurement = 100.0;  // and what each picture says of its own corners
// Pixels, prints and the lens err in a frame nearly as in the one before it, even in motion: such a share of what it
// says of which pose is right is new. Rather too little: of tags of 10 to 16 px in motion, of all families, the
// probabilities of wrong poses are two to three times as many as these are.
const double kNews = 0.3;

/// px^2, mean of all coordinates.
double varianceOf(const CornerCovariance& covariance)
{
  return cv::trace(covariance) / 8.0;
}

struct Followed
{
  CornerFilter filter;
  double time;  // s, of the newest frame with it
};

}  // namespace

struct TagPoseTracker::Impl
{
  Impl(const Bundle& tags, const TagPoseParams& settings) : bundle(tags), params(settings) {}

  CornerNoise& noiseOf(const SeenTag& tag) { return tag.measured ? of_measured : of_guessed; }

  double lensVariance() const { return params.lasting_noise * params.lasting_noise; }

  /// The tags of a frame, and what is known of their corners.
  std::vector<SeenTag> see(const std::vector<TagCorners>& seen, const CameraModel& camera)
  {
    std::vector<SeenTag> tags = tagsOf(bundle, seen, camera, params.corner_noise * params.corner_noise, lensVariance());
    for (SeenTag& tag : tags)
    {
      tag.covariance *= noiseOf(tag).total();
      tag.lens_variance *= noiseOf(tag).total();
    }
    return tags;
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
      CornerNoise& noise = noiseOf(tag);
      const double total = varianceOf(tag.covariance), unit = total / noise.total();
      const double least = tag.measured ? 0.0 : lensVariance() / unit, fresh = unit * noise.fresh(least);
      const auto [it, is_new] = followed.try_emplace(tag.tag.id, Followed{{tag.corners, fresh}, time_s});
      CornerFilter& corners = it->second.filter;
      if (!is_new)
      {
        corners.update(time_s - it->second.time, tag.corners, fresh);
        it->second.time = time_s;
        if (corners.rest() > kRest) noise.addChange(corners.change() / unit);
      }
      tag.corners = corners.corners();
      tag.covariance *= (corners.variance() + unit * noise.lasting(least)) / total;
      gains += corners.gain();
    }
    return gains / static_cast<double>(tags.size());
  }

  /// Measures the noise by how badly the corners of each tag, as they are, fit together: how the tags do is a matter of
  /// the layout, too.
  void measure(const std::vector<SeenTag>& tags, const Sighting& raw, const CameraModel& camera,
               const cv::Affine3d& near)
  {
    const double freedom = 2.0;  // eight coordinates less the six of a pose
    for (CornerNoise* noise : {&of_guessed, &of_measured})
    {
      double squares = 0.0, count = 0.0;
      for (std::size_t i = 0; i < tags.size(); ++i)
      {
        if (&noiseOf(tags[i]) != noise) continue;
        const double cost = fitPose({raw[i]}, camera, near).cost;
        if (!std::isfinite(cost)) continue;
        squares += cost * noise->total();
        count += freedom;
      }
      if (count > 0.0) noise->addResiduals(squares, count);
    }
  }

  Bundle bundle;
  TagPoseParams params;
  CornerNoise of_guessed{kGuess}, of_measured{kMeasurement};
  double corner_variance = params.corner_noise * params.corner_noise;  // px^2, of the corners of the newest frame
  PoseAmbiguity choice;
  std::map<int, Followed> followed;
  double time = std::nan("");  // s, of the newest frame with a pose
};

void validate(const TagPoseParams& params)
{
  checkFields(params);
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
  return std::sqrt(impl_->corner_variance);
}

std::optional<TagPoses> TagPoseTracker::update(double time_s, const std::vector<TagCorners>& seen,
                                               const CameraModel& camera)
{
  require(std::isfinite(time_s), "time", time_s, "finite (s)");
  validate(camera);
  Impl& self = *impl_;
  std::vector<SeenTag> tags = self.see(seen, camera);
  if (tags.empty()) return std::nullopt;
  const Sighting raw = sightingOf(tags, camera);
  self.forget(time_s);
  const double share = self.filter(time_s, tags);

  const std::vector<PoseRefinement> fits = fitBody(tags, camera);
  if (fits.empty()) return std::nullopt;
  const std::vector<WeighedPose> poses = self.choice.update(time_s - self.time, fits, kNews * share);
  self.time = time_s;
  self.measure(tags, raw, camera, poses.front().fit.pose);
  self.corner_variance = varianceOf(raw.front().information.inv());
  return posesOf(poses, raw, camera);
}

}  // namespace robot_vision
