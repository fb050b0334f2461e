#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "frame_points.hpp"
#include "pair_table.hpp"
#include "pose_clusters.hpp"
#include "rendered_region.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/recognition/point_pairs.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinVotes = 5;
constexpr double kSameShift = 0.1;  // of the diameter, of poses that are one
constexpr double kSameTurn = 0.35;  // rad

struct KnownModel
{
  explicit KnownModel(const PointPairModel& any) : extent((validate(any), any.extent)), params(any.params), table(any)
  {
  }

  MeshExtent extent;
  PointPairParams params;
  PairTable table;
};

/// The pose of an object whose point and normal are those of the frame, turned about the normal.
cv::Affine3d poseOf(const PointFrame& seen, const PointFrame& known, double angle)
{
  const double c = std::cos(angle), s = std::sin(angle);
  const cv::Matx33d turn(1, 0, 0, 0, c, -s, 0, s, c);
  const cv::Matx33d rotation = cv::Matx33d(seen.axes).t() * turn * cv::Matx33d(known.axes);
  return {rotation, cv::Vec3d(seen.point) - rotation * cv::Vec3d(known.point)};
}

}  // namespace

struct PointPairMatcher::Impl
{
  explicit Impl(const PointPairMatchParams& p) : params((validate(p), p)) {}

  std::vector<PoseCandidate> match(const RecognitionFrame& frame)
  {
    require(frame.hasColors() || frame.hasDepth(), "the frame", "empty", "set");
    std::vector<PoseCandidate> candidates;
    if (!frame.hasDepth() || models.empty()) return candidates;
    scene.begin(frame, params.max_plane > 0.0);
    for (std::size_t i = 0; i < models.size(); ++i)
      addCandidates(frame, models[i], static_cast<int>(i), candidates);
    return candidates;
  }

  void addCandidates(const RecognitionFrame& frame, const KnownModel& model, int index,
                     std::vector<PoseCandidate>& candidates)
  {
    const double diameter = model.extent.diameter;
    scene.sample(frame, model.params.sampling * diameter, params.max_plane * diameter, params.max_points, points);
    const std::size_t step = std::max<std::size_t>(
        static_cast<std::size_t>(params.reference_step),
        (points.size() + params.max_references - 1) / static_cast<std::size_t>(params.max_references));
    poses.clear();
    for (std::size_t i = step / 2; i < points.size(); i += step)
      voteFor(model, i);
    const std::vector<VotedPose> found = clusterPoses(poses, model.extent.center, kSameShift * diameter, kSameTurn);
    for (std::size_t i = 0; i < std::min(found.size(), static_cast<std::size_t>(params.max_candidates)); ++i)
    {
      PoseCandidate candidate;
      candidate.model = index;
      candidate.pose = found[i].pose;
      candidate.score = found[i].share;
      candidate.box = projectedBox(model.extent, found[i].pose, frame.camera().K, frame.size());
      candidates.push_back(candidate);
    }
  }

  /// Adds the pose that most pairs of a point vote for.
  void voteFor(const KnownModel& model, std::size_t reference)
  {
    const PairTable& table = model.table;
    const auto steps = static_cast<std::uint32_t>(model.params.angle_steps);
    const PointFrame frame(points.points[reference], points.normals[reference]);
    votes.assign(table.frames().size() * steps, 0);
    int pairs = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      const std::uint32_t bin =
          table.bins().binOf(frame.point, points.normals[reference], points.points[i], points.normals[i]);
      if (bin == PairBins::kNone) continue;
      ++pairs;
      const PairTable::Pair *pair = table.begin(bin), *const end = table.end(bin);
      if (pair == end) continue;
      const std::uint16_t angle = frame.angleOf(points.points[i]);
      for (; pair != end; ++pair)
      {
        const auto turn = static_cast<std::uint16_t>(angle - pair->angle);
        ++votes[pair->reference * steps + (turn * steps >> 16)];
      }
    }
    const auto most = std::max_element(votes.begin(), votes.end());
    if (most == votes.end() || *most < kMinVotes) return;
    const auto place = static_cast<std::size_t>(most - votes.begin());
    const double angle = (static_cast<double>(place % steps) + 0.5) * 2.0 * CV_PI / steps;
    poses.push_back({poseOf(frame, table.frames()[place / steps], angle), static_cast<double>(*most),
                     std::min(1.0, static_cast<double>(*most) / pairs)});
  }

  PointPairMatchParams params;
  std::vector<KnownModel> models;
  FramePoints scene;
  OrientedPoints points;
  std::vector<std::uint16_t> votes;  // of each point of the model and each angle
  std::vector<VotedPose> poses;
};

PointPairMatcher::PointPairMatcher(const PointPairMatchParams& params) : impl_(std::make_unique<Impl>(params))
{
}

PointPairMatcher::~PointPairMatcher() = default;

int PointPairMatcher::add(const PointPairModel& model)
{
  impl_->models.emplace_back(model);
  return static_cast<int>(impl_->models.size()) - 1;
}

std::vector<PoseCandidate> PointPairMatcher::match(const RecognitionFrame& frame)
{
  return impl_->match(frame);
}

}  // namespace robot_vision
