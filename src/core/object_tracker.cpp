#include "robot_vision/object_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "flow_picture.hpp"
#include "object_features.hpp"
#include "object_model.hpp"
#include "robot_vision/encoding.hpp"
#include "robot_vision/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kFewestPoints = 5;    // that a similarity is believed by
constexpr double kMaxGrowth = 1.4;  // of the scale in one frame, or its inverse
constexpr double kMaxTurn = 0.6;    // rad in one frame
constexpr double kMinScale = 0.1, kMaxScale = 10.0;
constexpr double kSame = 0.5;        // overlap of the outlines of what is one object
constexpr double kFoundAgain = 1.3;  // what is found again must be surer than what is followed, by this factor
constexpr int kFollowRounds = 2, kPlaceRounds = 3, kSearchRounds = 5;  // of corrections by the model

struct Object
{
  int id;
  ObjectModel model;
  Features features;
  TrackedObject state;
  Similarity pose;
  std::vector<std::size_t> seen;  // the model's points that were in the last frame
};

double turnBetween(const Similarity& from, const Similarity& to)
{
  return std::abs(std::remainder(to.angle() - from.angle(), 2.0 * CV_PI));
}

bool isPlausible(const Similarity& last, const Similarity& next)
{
  const double growth = next.scale() / last.scale();
  return growth < kMaxGrowth && growth > 1.0 / kMaxGrowth && turnBetween(last, next) < kMaxTurn;
}

/// Intersection over union of two convex polygons, 0 to 1.
double overlap(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b)
{
  std::vector<cv::Point2f> unused;
  const double both = cv::intersectConvexConvex(a, b, unused);
  return both / (cv::contourArea(a) + cv::contourArea(b) - both);
}

bool isInside(const cv::Size& picture, const cv::Point2f& p)
{
  return p.x >= 0.0F && p.y >= 0.0F && p.x <= static_cast<float>(picture.width - 1) &&
         p.y <= static_cast<float>(picture.height - 1);
}

}  // namespace

void validate(const ObjectTrackerParams& params)
{
  requireRange("points", params.points, 8.0, 200.0);
  require(params.window >= 5 && params.window <= 51 && params.window % 2 == 1, "window", params.window,
          "odd and from 5 to 51");
  requireRange("levels", params.levels, 0.0, 6.0);
  requireRange("max_error", params.max_error, 0.1, 10.0);
  requireRange("min_similarity", params.min_similarity, 0.0, 1.0);
  requireRange("min_confidence", params.min_confidence, 0.05, 1.0);
  requireRange("search_period", params.search_period, 0.0, 3600.0);
  requireRange("search_features", params.search_features, 100.0, 10000.0);
  requireRange("smoothing", params.smoothing, 0.0, 10.0);
}

struct ObjectTracker::Impl
{
  explicit Impl(const ObjectTrackerParams& p) { configure(p); }

  void configure(const ObjectTrackerParams& p)
  {
    params = p;
    flow = {p.window, p.levels, p.max_error};
  }

  int add(const cv::Mat& gray, const cv::Rect& region, const std::string& label)
  {
    ObjectModel model(gray, region, params.points);
    Object object{++last_id, std::move(model), objectFeatures(gray, region), {}, {}, {}};
    object.pose = object.model.firstPose();
    for (std::size_t i = 0; i < object.model.points().size(); ++i)
      object.seen.push_back(i);
    object.state.id = object.id;
    object.state.label = label;
    describe(object);
    objects.push_back(std::move(object));
    return last_id;
  }

  /// Writes the pose into the state.
  static void describe(Object& object)
  {
    const ObjectModel& model = object.model;
    std::transform(model.corners().begin(), model.corners().end(), object.state.outline.begin(),
                   [&object](const cv::Point2f& corner) { return object.pose(cv::Point2d(corner)); });
    object.state.center = object.pose(model.center());
    object.state.scale = object.pose.scale() / model.firstPose().scale();
    object.state.angle = object.pose.angle();
  }

  void lose(Object& object)
  {
    object.state.tracked = false;
    object.state.confidence = 0.0;
    object.state.velocity = {};
    object.state.points.clear();
    object.seen.clear();
  }

  /// Where flow has brought the object, as far as its points agree.
  Similarity followed(const Object& object, double passed)
  {
    const Similarity& pose = object.pose;
    Similarity predicted = pose;
    predicted.shift += object.state.velocity * passed;
    std::vector<cv::Point2f> model_points, points;
    for (const std::size_t i : object.seen)
    {
      const cv::Point2f point = pose(cv::Point2d(object.model.points()[i]));
      if (!isInside(last.size(), point)) continue;
      model_points.push_back(object.model.points()[i]);
      points.push_back(point);
    }
    const FollowedPoints moved = followPoints(last, newest, flow, points, predicted(model_points));
    std::vector<cv::Point2f> from, to;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      if (!moved.found[i]) continue;
      from.push_back(model_points[i]);
      to.push_back(moved.positions[i]);
    }
    return fitSimilarity(from, to, 2.0, kFewestPoints).value_or(predicted);
  }

  /// Takes the object for seen where the model fits, if it fits well enough.
  bool accept(Object& object, const ModelFit& fit, double least)
  {
    const double confidence = static_cast<double>(fit.seen.size()) / static_cast<double>(object.model.points().size());
    const double scale = fit.pose.scale() / object.model.firstPose().scale();
    if (static_cast<int>(fit.seen.size()) < kFewestPoints || confidence < least || scale < kMinScale ||
        scale > kMaxScale)
      return false;
    object.pose = fit.pose;
    object.seen = fit.seen;
    object.state.tracked = true;
    object.state.confidence = confidence;
    object.state.points = fit.where;
    describe(object);
    return true;
  }

  void follow(Object& object, double passed)
  {
    const cv::Point2d before = object.state.center;
    const Similarity start = followed(object, passed);
    const ModelFit fit = object.model.fit(newest, flow, start, params.min_similarity, kFollowRounds);
    if (!isPlausible(object.pose, fit.pose) || !accept(object, fit, params.min_confidence)) return lose(object);
    if (passed <= 0.0) return;
    const double share = params.smoothing > 0.0 ? 1.0 - std::exp(-passed / params.smoothing) : 1.0;
    object.state.velocity += share * ((object.state.center - before) / passed - object.state.velocity);
  }

  /// Whether what has been found is another object of that name, which is followed already.
  bool isTaken(const Object& finder, const Similarity& pose) const
  {
    const std::vector<cv::Point2f> outline = pose(finder.model.corners());
    return std::any_of(objects.begin(), objects.end(),
                       [&](const Object& other)
                       {
                         if (&other == &finder || !other.state.tracked || other.state.label != finder.state.label)
                           return false;
                         return overlap(outline, other.pose(other.model.corners())) > kSame;
                       });
  }

  bool tryPose(Object& object, const Similarity& pose, int rounds)
  {
    const double similarity = 0.5 * (1.0 + params.min_similarity);  // the next coin in a row is quite like this one
    const ModelFit fit = object.model.fit(newest, flow, pose, similarity, rounds);
    const double least = std::min(kFoundAgain * params.min_confidence, 1.0);
    return !isTaken(object, fit.pose) && accept(object, fit, least);
  }

  /// Looks for objects that are lost: where they were, and at times everywhere.
  void search(double time_s)
  {
    std::vector<Object*> lost;
    for (Object& object : objects)
      if (!object.state.tracked && !tryPose(object, object.pose, kPlaceRounds)) lost.push_back(&object);
    if (lost.empty() || (time_s >= searched && time_s < searched + params.search_period)) return;
    searched = time_s;
    const Features features = pictureFeatures(newest.gray(), params.search_features);
    for (Object* object : lost)
    {
      const auto found = matchFeatures(object->features, features);
      if (found) tryPose(*object, *found * object->model.firstPose(), kSearchRounds);
    }
  }

  ObjectTrackerParams params;
  FlowParams flow;
  FlowPicture last, newest;
  cv::Mat converted;  // memory for the next picture
  std::vector<Object> objects;
  int last_id = 0;
  double time = 0.0;         // s, of the newest picture
  double passed = 0.0;       // s, since the last; 0 if it cannot be compared with it
  double searched = -1e300;  // s
};

ObjectTracker::ObjectTracker(const ObjectTrackerParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

ObjectTracker::~ObjectTracker() = default;
ObjectTracker::ObjectTracker(ObjectTracker&&) noexcept = default;
ObjectTracker& ObjectTracker::operator=(ObjectTracker&&) noexcept = default;

void ObjectTracker::configure(const ObjectTrackerParams& params)
{
  validate(params);
  impl_->configure(params);
}

int ObjectTracker::select(const cv::Rect& region, const std::string& label)
{
  if (impl_->newest.empty()) throw std::invalid_argument("there is no picture yet to select a region of");
  const int id = impl_->add(impl_->newest.gray(), region, label);
  impl_->objects.back().state.tracked = true;
  impl_->objects.back().state.confidence = 1.0;
  return id;
}

int ObjectTracker::select(const cv::Mat& image, const std::string& encoding, const cv::Rect& region,
                          const std::string& label)
{
  cv::Mat gray;
  toGray(image, encoding, gray);
  return impl_->add(gray, region, label);
}

bool ObjectTracker::forget(int id)
{
  std::vector<Object>& objects = impl_->objects;
  const auto found = std::find_if(objects.begin(), objects.end(), [id](const Object& one) { return one.id == id; });
  if (found == objects.end()) return false;
  objects.erase(found);
  return true;
}

void ObjectTracker::clear()
{
  impl_->objects.clear();
}

std::vector<TrackedObject> ObjectTracker::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  Impl& me = *impl_;
  require(std::isfinite(time_s), "time", time_s, "finite");
  cv::Mat gray = me.converted;  // it may come to share the input's pixels, which must not be kept
  toGray(image, encoding, gray);
  if (!sharesPixels(gray, image)) me.converted = gray;
  std::swap(me.last, me.newest);
  me.newest.set(gray);
  const bool comparable = me.last.size() == me.newest.size() && time_s >= me.time;
  me.passed = comparable ? time_s - me.time : 0.0;
  me.time = time_s;
  for (Object& object : me.objects)
  {
    if (!comparable)
      me.lose(object);
    else if (object.state.tracked)
      me.follow(object, me.passed);
  }
  me.search(time_s);
  return objects();
}

std::vector<TrackedObject> ObjectTracker::objects() const
{
  std::vector<TrackedObject> states;
  for (const Object& object : impl_->objects)
    states.push_back(object.state);
  return states;
}

std::vector<FlowPoint> ObjectTracker::flow(int count)
{
  Impl& me = *impl_;
  require(count > 0, "count", count, "above 0");
  if (me.last.empty() || me.passed <= 0.0) return {};
  // Corners of the picture at half its size: they do for this, at a quarter of the price.
  int halvings = 1;
  const cv::Mat& small = me.last.halved(me.flow, halvings);
  std::vector<cv::Point2f> points;
  const double distance = std::max(4.0, std::sqrt(static_cast<double>(small.total()) / (2.0 * count)));
  cv::goodFeaturesToTrack(small, points, count, 0.005, distance);
  for (cv::Point2f& point : points)
    point *= std::ldexp(1.0, halvings);
  const FollowedPoints moved = followPoints(me.last, me.newest, me.flow, points, points);
  std::vector<FlowPoint> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (moved.found[i] && isInside(me.newest.size(), moved.positions[i]))
      result.push_back({moved.positions[i], (moved.positions[i] - points[i]) / me.passed});
  return result;
}

}  // namespace robot_vision
