#include "robot_vision/recognition/pose_verifier.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "color_agreement.hpp"
#include "contour_points.hpp"
#include "contour_support.hpp"
#include "core/geometry/rigid_motion.hpp"
#include "depth_agreement.hpp"
#include "rendered_region.hpp"
#include "robot_vision/common/range.hpp"
#include "verification_weights.hpp"

namespace robot_vision
{
namespace
{

constexpr ContourLimits kContours = {200, 150}, kFewContours = {80, 50};
constexpr int kFewPixels = 1000;  // for which few contours are enough
const double kNan = std::numeric_limits<double>::quiet_NaN();

/// What is known, from where it says neither yes nor no; 0 if it is not.
double about(double value, double neutral)
{
  return std::isnan(value) ? 0.0 : value - neutral;
}

double logOddsOf(const PoseEvidence& evidence, const VerificationWeights& weights)
{
  const std::vector<double> features = evidenceFeatures(evidence);
  double sum = weights[0];
  for (std::size_t i = 0; i < features.size(); ++i)
    sum += weights[i + 1] * features[i];
  return std::clamp(sum, -30.0, 30.0);
}

const VerificationWeights& weightsFor(const RecognitionFrame& frame, const ObjectShape& shape)
{
  if (!frame.hasDepth()) return kColorWeights;
  if (!frame.hasColors()) return kDepthWeights;
  return shape.hasColors() ? kColorAndDepthWeights : kShapeWeights;
}

PoseEvidence nothingKnown()
{
  PoseEvidence evidence;
  evidence.agreeing = evidence.pierced = evidence.hidden = evidence.sunken = kNan;
  evidence.misfit = evidence.noise = evidence.normals = kNan;
  evidence.outline = evidence.inner = evidence.colors = evidence.pattern = kNan;
  evidence.unknown = 1.0;
  return evidence;
}

}  // namespace

std::vector<double> evidenceFeatures(const PoseEvidence& evidence)
{
  constexpr double kFew = 0.01;  // share of the pixels that says next to nothing
  const double solid = std::log10((evidence.agreeing + evidence.pierced + kFew) / (evidence.pierced + kFew));
  const double visible = evidence.agreeing / std::max(1.0 - evidence.unknown, 1e-9);
  return {about(solid, 1.3),
          about(visible, 0.7),
          about(evidence.sunken, 0.1),
          about(evidence.misfit - evidence.noise, 0.0),
          about(evidence.normals, 0.8),
          about(evidence.outline, 0.7),
          about(evidence.inner, 0.5),
          about(evidence.colors, 0.7),
          about(evidence.pattern, 0.3),
          std::clamp(std::log10(std::max(evidence.pixels, 1.0) / 1000.0), -2.0, 1.0)};
}

struct PoseVerifier::Impl
{
  Impl(const VerifierParams& p, const DepthErrorParams& e)
    : params((validate(p), p)), errors((validate(e), e)), depths(errors, params.tolerance)
  {
  }

  PoseVerdict verify(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose)
  {
    requireRigid(pose, "the pose");
    require(frame.hasColors() || frame.hasDepth(), "the frame", "empty", "set");
    PoseVerdict verdict;
    verdict.evidence = nothingKnown();
    RenderParts parts;
    parts.normals = true;
    parts.bgr = frame.hasColors() && shape.hasColors();
    if (!drawRegion(shape, pose, frame.camera().K, frame.size(), params.max_pixels, parts, region)) return verdict;
    verdict.box = region.box;
    verdict.step = region.step;
    PoseEvidence& evidence = verdict.evidence;
    if (frame.hasDepth())
    {
      depths.compare(region, frame, evidence);
      verdict.explained = depths.states() == kAgreeing;
      const double told = evidence.agreeing + evidence.pierced + evidence.hidden;
      verdict.occlusion = told > 0.0 ? evidence.hidden / told : 0.0;
    }
    else
    {
      verdict.explained = region.view.depth > 0.0;
      evidence.pixels = cv::countNonZero(verdict.explained) * region.step * region.step;
    }
    if (evidence.pixels == 0.0) return verdict;
    const ContourLimits limits = params.max_pixels < kFewPixels ? kFewContours : kContours;
    compareContours(region, frame, contours.find(region, parts.bgr, limits), errors, params, evidence);
    if (parts.bgr) compareColors(region, frame, verdict.explained, params.max_hue_error, evidence);
    verdict.log_odds = logOddsOf(evidence, weightsFor(frame, shape));
    verdict.probability = 1.0 / (1.0 + std::exp(-verdict.log_odds));
    return verdict;
  }

  VerifierParams params;
  DepthErrorParams errors;
  RenderedRegion region;
  ContourPointFinder contours;
  DepthAgreement depths;
};

PoseVerifier::PoseVerifier(const VerifierParams& params, const DepthErrorParams& errors)
  : impl_(std::make_unique<Impl>(params, errors))
{
}

PoseVerifier::~PoseVerifier() = default;
PoseVerifier::PoseVerifier(PoseVerifier&&) noexcept = default;
PoseVerifier& PoseVerifier::operator=(PoseVerifier&&) noexcept = default;

PoseVerdict PoseVerifier::verify(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose)
{
  return impl_->verify(frame, shape, pose);
}

}  // namespace robot_vision
