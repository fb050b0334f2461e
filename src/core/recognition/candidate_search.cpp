#include "candidate_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/affine.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "near_places.hpp"

namespace robot_vision
{

/// Poses are moved to where they fit best by one stage after the other: fewer and fewer of them, by more and more
/// features.
struct FitStage
{
  std::size_t poses;           // the best, that come so far
  int features;                // of each kind, that are compared
  std::array<int, 2> reaches;  // px, for edges, of each step; 0: there is no such step
  double tolerance;            // of depths, as share of the diameter, while it is moved
  double count_tolerance;      // the same, when what agrees is counted
};

namespace
{

constexpr std::size_t kMaxHits = 4000;  // that are looked at closely
constexpr int kAllFeatures = FitLimits().most;

constexpr std::array<FitStage, 3> kStages = {
    {{1500, 16, {5, 0}, 0.16, 0.12}, {400, 32, {4, 0}, 0.16, 0.06}, {150, kAllFeatures, {3, 2}, 0.06, 0.03}}};
// Without depth there are only contours to move it by, and few of them say nothing.
constexpr std::array<FitStage, 2> kStagesWithoutDepth = {
    {{500, kAllFeatures, {5, 4}, 0.0, 0.0}, {500, kAllFeatures, {3, 2}, 0.0, 0.0}}};
constexpr double kTolerance = 0.01, kCountTolerance = 0.005;  // m, in addition to these
constexpr FitWeights kBefore{-7, 5.5F, 1, 3, 0.5F, 7.5F, 0, 3.5F}, kAfter{-26, 24, 17, 12, 14, 11, -2, 8};
constexpr double kNear = 2.0;           // cells, side of the squares of which each has its best hits
constexpr double kLookWindow = 0.8;     // cells, side of the square that a feature is looked for in
constexpr double kLookOffset = 0.4;     // cells
constexpr double kLookTolerance = 0.3;  // of half the width of all cells, of depths
constexpr double kWidthSteps = 1.12;    // between the widths of the series

// Within which two poses are one: the distance as a share of the diameter, and the angle (rad).
constexpr double kSimilarDistance = 0.06, kSimilarAngle = 8.0 * CV_PI / 180.0;
constexpr double kOneDistance = 0.02, kOneAngle = 3.0 * CV_PI / 180.0;
constexpr double kSameDistance = 0.1, kSameAngle = 15.0 * CV_PI / 180.0;

constexpr double kSpot = 0.4;     // of the diameter: poses that are nearer are at one spot
constexpr std::size_t kMore = 3;  // poses of a spot that may come in addition to the best of all
constexpr float kMinMore = 0.0F;  // least evidence of these: that the object is there rather than not

Guess guessOf(const Place& place, const Template& found, const ViewCamera& camera)
{
  const double x = (place.x - camera.cx()) / camera.fx(), y = (place.y - camera.cy()) / camera.fy();
  Guess guess;
  guess.pose.rotation = rayFrame(x, y) * turnInImage(found.turn);
  guess.pose.anchor = cv::Vec3d(x, y, 1.0) / place.inverse;
  guess.view = found.view;
  return guess;
}

/// Around the view's box at the anchor, turned as the view is.
cv::Rect boxOf(const View& view, const ViewPose& pose, const CameraModel& camera)
{
  std::vector<cv::Point2f> corners;
  for (const cv::Point2d& corner : {view.box.tl(), view.box.br(), cv::Point2d(view.box.x, view.box.br().y),
                                    cv::Point2d(view.box.br().x, view.box.y)})
  {
    const cv::Point2d pixel =
        camera.project(cv::Point3d(pose.rotation * cv::Vec3d(corner.x, corner.y, 0) + pose.anchor));
    if (!std::isnan(pixel.x)) corners.emplace_back(pixel);
  }
  return corners.empty() ? cv::Rect() : cv::boundingRect(corners);
}

PoseCandidate candidateOf(const MatchedModel& model, const Guess& guess, const ViewCamera& camera)
{
  PoseCandidate candidate;
  candidate.pose = cv::Affine3d(guess.rotation, guess.middle - guess.rotation * model.model().extent.center);
  candidate.score = 1.0 / (1.0 + std::exp(-static_cast<double>(guess.score)));
  candidate.box = boxOf(model.view(guess.view), guess.pose, camera.camera());
  candidate.view = guess.view;
  return candidate;
}

}  // namespace

MatchedModel::MatchedModel(const ViewModel& model)
  : model_(model), symmetries_(model.symmetries), half_width_(ViewTemplates::reachOf(model))
{
  half_width_ = std::pow(kWidthSteps, std::ceil(std::log(std::max(half_width_, 1e-6)) / std::log(kWidthSteps)));
  for (const View& view : model.views)
  {
    features_.emplace_back(view, model);
    rotations_.push_back(cv::Affine3d(view.rotation, cv::Vec3d()).rotation());
  }
}

const ViewTemplates& MatchedModel::templates(bool with_depth)
{
  std::unique_ptr<ViewTemplates>& templates = with_depth ? with_depth_ : without_depth_;
  if (!templates) templates = std::make_unique<ViewTemplates>(model_, half_width_, with_depth);
  return *templates;
}

std::size_t MatchedModel::memory() const
{
  std::size_t bytes = sizeof *this + model_.memory() + rotations_.capacity() * sizeof(cv::Matx33d);
  for (const ViewFeatures& features : features_)
    bytes += sizeof features + features.memory();
  for (const auto* templates : {with_depth_.get(), without_depth_.get()})
    bytes += templates == nullptr ? 0 : templates->memory();
  return bytes;
}

CandidateSearch::CandidateSearch(const MatchedModel& model, const ViewTemplates& templates, const ObservedFrame& frame,
                                 const ViewCamera& camera)
  : model_(model), templates_(templates), frame_(frame), camera_(camera), fit_(frame, camera)
{
}

/// The evidence for a template at a place, by the features of its code at their own depths.
void CandidateSearch::look(const ViewHit& hit, const Place& place, Guess& guess) const
{
  const std::size_t window = windowAt(place.inverse, camera_, model_.halfWidth(), kLookWindow);
  const auto bins = frame_.bins(window), ranges = frame_.ranges(window);
  const auto corner = static_cast<float>(0.5 * (kWindows[window] - 1));
  const LookFrame frame{bins[0],
                        ranges[0],
                        bins.stride,
                        PaddedImage<std::uint32_t>::kPad,
                        static_cast<float>(frame_.size().width),
                        static_cast<float>(frame_.size().height),
                        static_cast<float>(camera_.fx()),
                        static_cast<float>(camera_.fy()),
                        static_cast<float>(camera_.cx()) - corner,
                        static_cast<float>(camera_.cy()) - corner,
                        ObservedFrame::kInverseSteps,
                        static_cast<float>(kLookTolerance * model_.halfWidth())};
  LookPose pose;
  for (int i = 0; i < 9; ++i)
    pose.rotation[i] = static_cast<float>(guess.pose.rotation.val[i]);
  const LookKernels& loops = kernels<LookKernels>();
  const auto look = frame_.hasDepth() ? loops.look : loops.look_at_image;
  const cv::Vec3d middle = guess.pose.anchor;
  const double offset = kLookOffset * 2.0 * model_.halfWidth() / kCells;
  guess.score = -1e9F;
  for (const cv::Vec2d& by : {cv::Vec2d(0, 0), cv::Vec2d(1, 0), cv::Vec2d(-1, 0), cv::Vec2d(0, 1), cv::Vec2d(0, -1)})
  {
    const cv::Vec3d at = middle + cv::Vec3d(by[0], by[1], 0) * offset;
    for (int i = 0; i < 3; ++i)
      pose.anchor[i] = static_cast<float>(at[i]);
    LookCounts counts;
    look(frame, templates_.points(guess.view), pose, templates_.fine().code(hit.index), counts);
    FitCounts all;
    all.all_edges = kCodeContours;
    all.all_surfaces = kCodeSurfaces;
    all.depth_edges = counts.depth_edges;
    all.image_edges = counts.image_edges;
    all.hidden_edges = counts.hidden_edges;
    all.edges_beyond = counts.edges_beyond;
    all.surfaces = counts.surfaces;
    all.hidden_surfaces = counts.hidden_surfaces;
    all.surfaces_beyond = counts.surfaces_beyond;
    const float evidence = all.evidence(kBefore);
    if (evidence > guess.score)
    {
      guess.score = evidence;
      guess.pose.anchor = at;
    }
  }
}

/// The best guesses, moved to where they fit best.
std::vector<Guess> CandidateSearch::improved(std::vector<Guess> guesses, std::size_t count)
{
  const double diameter = model_.model().extent.diameter;
  double distance = kSimilarDistance * diameter, angle = kSimilarAngle;
  const auto pass = [&](const FitStage& stage)
  {
    guesses = bestOf(std::move(guesses), std::max(stage.poses, count), distance, angle);
    for (Guess& guess : guesses)
      improve(stage, guess);
    // Those of an object come to be one, and would leave no room for others.
    distance = kOneDistance * diameter;
    angle = kOneAngle;
  };
  if (frame_.hasDepth())
    std::for_each(kStages.begin(), kStages.end(), pass);
  else
    std::for_each(kStagesWithoutDepth.begin(), kStagesWithoutDepth.end(), pass);
  return guesses;
}

void CandidateSearch::improve(const FitStage& stage, Guess& guess)
{
  const double diameter = model_.model().extent.diameter;
  const double tolerance = stage.tolerance * diameter + kTolerance;
  const FitLimits last{stage.count_tolerance * diameter + kCountTolerance, 0.004, 0.87F, 0, stage.features};
  const ViewFeatures& features = model_.features(guess.view);
  for (const int reach : stage.reaches)
    if (reach == 0 || !fit_.improve(features, {tolerance, 0.005, 0.8F, reach, stage.features}, guess.pose)) break;
  guess.score = fit_.count(features, guess.pose, last).evidence(kAfter);
}

void CandidateSearch::locate(Guess& guess) const
{
  guess.rotation = guess.pose.rotation * model_.rotation(guess.view);
  guess.middle = guess.pose.anchor + guess.pose.rotation * model_.view(guess.view).center;
}

/// The best, without those that are within this distance (m) and angle (rad) of a better one. Where there are depths,
/// up to as many more are a few poses of each other spot where the object seems to be: one piece of it may have all of
/// the best, which differ by turns alone. Without depths the other spots are before and behind it.
std::vector<Guess> CandidateSearch::bestOf(std::vector<Guess> guesses, std::size_t count, double distance,
                                           double angle) const
{
  std::vector<std::pair<float, std::size_t>> order;  // the best first, and of equal ones that which came first
  for (std::size_t i = 0; i < guesses.size(); ++i)
    order.emplace_back(-guesses[i].score, i);
  std::sort(order.begin(), order.end());
  NearPlaces near(distance);
  SpotCounts spots(kSpot * model_.model().extent.diameter);
  const std::size_t most = frame_.hasDepth() ? 2 * count : count;
  std::vector<Guess> best;
  for (const auto& [score, i] : order)
  {
    const bool is_more = best.size() >= count;
    if (is_more && (best.size() == most || guesses[i].score < kMinMore)) break;
    Guess& guess = guesses[i];
    locate(guess);
    const bool is_known = near.anyNear(guess.middle,
                                       [&](std::size_t k)
                                       {
                                         const Guess& better = best[k];
                                         const cv::Vec3d gap = better.middle - guess.middle;
                                         return gap.dot(gap) < distance * distance &&
                                                model_.symmetries().angle(guess.rotation, better.rotation) < angle;
                                       });
    if (is_known) continue;
    if (spots.add(guess.middle) > kMore && is_more) continue;
    near.add(guess.middle, best.size());
    best.push_back(guess);
  }
  return best;
}

/// Sorts hits, the best first, and drops those for which a better one is near: of the same coarse template, at about
/// the same place and depth.
void CandidateSearch::keepBest(const std::vector<Place>& places, std::vector<ViewHit>& hits) const
{
  const auto better = [](const ViewHit& a, const ViewHit& b)
  { return std::make_tuple(-a.score, a.place, a.index) < std::make_tuple(-b.score, b.place, b.index); };
  std::sort(hits.begin(), hits.end(), better);
  std::unordered_set<std::uint64_t> taken;
  std::size_t kept = 0;
  for (const ViewHit& hit : hits)
  {
    const Place& place = places[static_cast<std::size_t>(hit.place)];
    const double side = kNear * 2.0 * model_.halfWidth() / kCells * camera_.focalLength() * place.inverse;  // px
    const auto x = static_cast<std::uint64_t>(place.x / side), y = static_cast<std::uint64_t>(place.y / side);
    const auto depth = static_cast<std::uint64_t>(std::log(place.inverse) * 10.0 + 1000.0);
    if (taken.insert(((std::uint64_t{hit.parent} * 8192 + x) * 8192 + y) * 2048 + depth).second) hits[kept++] = hit;
    if (kept == kMaxHits) break;
  }
  hits.resize(kept);
}

std::vector<PoseCandidate> CandidateSearch::find(const std::vector<Place>& places, std::vector<ViewHit>& hits,
                                                 int count)
{
  keepBest(places, hits);
  std::vector<Guess> guesses;
  for (const ViewHit& hit : hits)
  {
    const Place& place = places[static_cast<std::size_t>(hit.place)];
    Guess guess = guessOf(place, templates_.fine().templates[hit.index], camera_);
    look(hit, place, guess);
    guesses.push_back(guess);
  }
  const double diameter = model_.model().extent.diameter;
  guesses = improved(std::move(guesses), static_cast<std::size_t>(count));
  std::vector<PoseCandidate> candidates;
  for (const Guess& guess :
       bestOf(std::move(guesses), static_cast<std::size_t>(count), kSameDistance * diameter, kSameAngle))
    candidates.push_back(candidateOf(model_, guess, camera_));
  return candidates;
}

}  // namespace robot_vision
