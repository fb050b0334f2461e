#include "robot_vision/recognition/pose_refiner.hpp"

#include <algorithm>
#include <cmath>

#include "contour_points.hpp"
#include "core/geometry/rigid_motion.hpp"
#include "pose_fit.hpp"
#include "pose_freedom.hpp"
#include "pose_solver.hpp"
#include "rendered_region.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxPixels = 4000;                           // that are drawn, of the box around the object
constexpr double kShrink = 0.4;                            // of the search, from level to level
constexpr double kScoreShift = 0.002, kScorePixels = 1.0;  // m, px: by which a pose may be off for half of its score
constexpr int kStepsOfRound = 4;
constexpr double kMinScore = 0.3;   // of a pose whose symmetries are looked for
constexpr double kFirstTurn = 0.3;  // rad, standard deviation of the first pose

}  // namespace

struct PoseRefiner::Impl
{
  Impl(const RefinerParams& p, const DepthErrorParams& e) : params((validate(p), p)), errors((validate(e), e)) {}

  RefinedPose refine(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& first)
  {
    requireRigid(first, "the first pose");
    require(frame.hasColors() || frame.hasDepth(), "the frame", "empty", "set");
    PoseResiduals residuals(frame, errors, params.contour_error, params.min_gradient);
    RefinedPose best;
    best.pose = first;
    best.covariance = covarianceOf(cv::Matx66d::zeros(), shape.extent().radius);
    cv::Affine3d pose = first;
    const int levels = levelsFor(frame);
    for (int level = 0; level <= levels && take(frame, shape, pose, residuals); ++level)
    {
      const double score = scoreOf(residuals);
      if (level == 0) best.first_score = score;
      if (score >= best.score) keep(residuals, score, shape.extent(), best);
      if (level == levels) break;
      const FitTolerance tolerance = level + 1 < levels ? toleranceOf(level, frame, shape.extent()) : FitTolerance();
      pose = fit(residuals, tolerance, roundsFor(frame), shape.extent());
    }
    finish(frame, shape, best);
    return best;
  }

  /// Without depths there is less that a pose follows from, and that pulls it to where it should be.
  int levelsFor(const RecognitionFrame& frame) const { return frame.hasDepth() ? params.levels : params.levels + 2; }
  int roundsFor(const RecognitionFrame& frame) const { return frame.hasDepth() ? params.rounds : 2 * params.rounds; }

  /// Draws the object and takes the points of it; returns false if there are none.
  bool take(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose, PoseResiduals& residuals)
  {
    RenderParts parts;
    parts.normals = true;
    parts.bgr = shape.hasColors() && frame.hasColors();
    if (!drawRegion(shape, pose, frame.camera().K, frame.size(), kMaxPixels, parts, region)) return false;
    takeSurfacePoints(region, params.points, surface);
    const ContourLimits limits{std::max(1, 3 * params.contour_points / 5), std::max(1, 2 * params.contour_points / 5)};
    contours = &finder.find(region, parts.bgr, limits);
    if (surface.empty()) return false;
    const double pixels = drawnPixels(region.view) * region.step * region.step;
    residuals.setDensity(pixels / static_cast<double>(surface.size()), finder.spacing() * region.step);
    return true;
  }

  double scoreOf(PoseResiduals& residuals) const
  {
    FitTolerance tolerance;
    tolerance.shift = kScoreShift;
    tolerance.pixels = kScorePixels;
    const cv::Affine3d here(cv::Matx33d::eye(), region.center);
    residuals.match(*contours, here.rotation(), here.translation(), tolerance);
    return equationsAt(residuals, here, tolerance).quality();
  }

  FitTolerance toleranceOf(int level, const RecognitionFrame& frame, const MeshExtent& extent) const
  {
    FitTolerance tolerance;
    const double search = std::pow(kShrink, level) * params.search * extent.diameter;
    const double in_pixels = search / (region.center[2] * Pinhole(frame.camera().K).pixelWidth());
    tolerance.shift = 0.5 * search;
    tolerance.pixels = 0.5 * in_pixels;
    tolerance.radius =
        std::clamp(static_cast<int>(std::ceil(in_pixels)) + 3, tolerance.radius, ContourSearch::kMaxRadius);
    return tolerance;
  }

  /// The pose near that of the region that fits best.
  cv::Affine3d fit(PoseResiduals& residuals, const FitTolerance& tolerance, int rounds, const MeshExtent& extent) const
  {
    const MotionLimits limits{params.search * extent.diameter, kFirstTurn, extent.radius, kStepsOfRound};
    cv::Affine3d motion(cv::Matx33d::eye(), region.center);
    for (int round = 0; round < rounds; ++round)
    {
      residuals.match(*contours, motion.rotation(), motion.translation(), tolerance);
      motion =
          solveMotion(motion, limits, [&](const cv::Affine3d& by) { return equationsAt(residuals, by, tolerance); });
    }
    const cv::Matx33d rotation = motion.rotation() * region.pose.rotation();
    return {rotation, motion.translation() - rotation * extent.center};
  }

  /// `motion` is where the mesh's center is, and the rotation since the region was drawn.
  PoseEquations equationsAt(const PoseResiduals& residuals, const cv::Affine3d& motion,
                            const FitTolerance& tolerance) const
  {
    PoseEquations equations;
    residuals.add(surface, *contours, motion.rotation(), motion.translation(), tolerance, equations);
    return equations;
  }

  /// Has the pose of the region be the best one, with the covariance of the mesh's center.
  void keep(const PoseResiduals& residuals, double score, const MeshExtent& extent, RefinedPose& best)
  {
    best.pose = region.pose;
    best.score = score;
    const cv::Affine3d here(cv::Matx33d::eye(), region.center);
    const PoseEquations equations = equationsAt(residuals, here, FitTolerance());
    const bool is_known = equations.count() >= kMinResiduals;
    const double share = is_known ? 1.0 / std::max(equations.variance(), 1.0) : 0.0;
    best.covariance = covarianceOf(equations.information() * share, extent.radius);
    surface_covariance = covarianceOf(residuals.surfaceInformation(surface, region.center), extent.radius);
  }

  /// Adds to the covariance what the residuals do not tell, and has it be that of the object's frame.
  void finish(const RecognitionFrame& frame, const ObjectShape& shape, RefinedPose& best)
  {
    const cv::Vec3d center = best.pose * shape.extent().center;
    if (best.score > kMinScore) addFreedom(frame, shape, center, best);
    if (frame.hasDepth() && center[2] > 0.0)
    {
      const cv::Vec3d shift = center * (errors.depth_bias / center[2]);
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
          best.covariance(row, column) += shift[row] * shift[column];
    }
    best.covariance = atOrigin(best.covariance, best.pose.translation() - center);
  }

  void addFreedom(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Vec3d& center, RefinedPose& best)
  {
    best.free_axes = shape.freeAxes();
    if (best.free_axes.empty())
    {
      // The directions of contours are not quite exact, so that they seem to tell of what surfaces say that it is free.
      const bool texture = frame.hasColors() && shape.hasColors();
      const auto found = freedom.find(shape, best.pose, surface_covariance, frame.camera().K, frame.size(),
                                      depthDeviation(center[2], errors), texture);
      const cv::Affine3d back = best.pose.inv();
      if (found) best.free_axes.push_back({back * found->point, back.rotation() * found->direction});
    }
    for (const FreeAxis& axis : best.free_axes)
      best.covariance =
          withFreeAxis(best.covariance, {best.pose * axis.point, best.pose.rotation() * axis.direction}, center);
  }

  RefinerParams params;
  DepthErrorParams errors;
  RenderedRegion region;
  ContourPointFinder finder;
  FreedomCheck freedom;
  std::vector<SurfacePoint> surface;
  const std::vector<ContourPoint>* contours = nullptr;
  cv::Matx66d surface_covariance;  // of the best pose, as depths of all of its surface would tell it
};

PoseRefiner::PoseRefiner(const RefinerParams& params, const DepthErrorParams& errors)
  : impl_(std::make_unique<Impl>(params, errors))
{
}

PoseRefiner::~PoseRefiner() = default;
PoseRefiner::PoseRefiner(PoseRefiner&&) noexcept = default;
PoseRefiner& PoseRefiner::operator=(PoseRefiner&&) noexcept = default;

RefinedPose PoseRefiner::refine(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& first)
{
  return impl_->refine(frame, shape, first);
}

}  // namespace robot_vision
