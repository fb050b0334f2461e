#include "robot_vision/tracking/object_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "core/image/conversion_buffer.hpp"
#include "followed_object.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "search_rounds.hpp"
#include "velocity.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxFlowInterval = 2.0;     // s, in which points of the whole image may still look alike
constexpr double kMinOverlap = 0.5;          // of two outlines that are taken for the same object
constexpr double kRecoveryConfidence = 1.3;  // times min_confidence, which an object that is found again must have

/// Intersection over union of two convex polygons, 0 to 1.
double overlap(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b)
{
  std::vector<cv::Point2f> unused;
  const double both = cv::intersectConvexConvex(a, b, unused);
  return both / (cv::contourArea(a) + cv::contourArea(b) - both);
}

}  // namespace

struct ObjectTracker::Impl
{
  FollowedObject& add(const cv::Mat& gray, const cv::Rect& region, const std::string& label)
  {
    objects.emplace_back(last_id + 1, label, gray, region, params.points);
    ++last_id;
    return objects.back();
  }

  /// Whether another object with the same label is already followed in this pose.
  bool isTaken(const FollowedObject& finder, const Similarity& pose) const
  {
    const auto is_there = [&](const FollowedObject& other)
    {
      return &other != &finder && other.state().tracked && other.state().label == finder.state().label &&
             overlap(finder.outlineAt(pose), other.outlineAt(other.pose())) > kMinOverlap;
    };
    return std::any_of(objects.begin(), objects.end(), is_there);
  }

  bool tryPose(FollowedObject& object, const Similarity& pose)
  {
    // More than min_similarity is required, because similar objects may be near, such as coins in a row.
    const double similarity = 0.5 * (1.0 + params.min_similarity);
    const ModelFit fit = object.fitAt(pose, frames, similarity);
    return !isTaken(object, fit.pose) &&
           object.accept(fit, std::min(kRecoveryConfidence * params.min_confidence, 1.0), frames, params.smoothing);
  }

  bool tryMatch(FollowedObject& object, const Features& features)
  {
    const auto found = matchFeatures(object.features(), features);
    return found && tryPose(object, *found * object.firstPose());
  }

  /// Searches for an object around its last place. Returns whether it was found.
  bool tryNear(FollowedObject& object)
  {
    const auto& outline = object.state().outline;
    const std::vector<cv::Point2f> last(outline.begin(), outline.end());
    return tryMatch(object, nearFeatures(frames.newest.gray(), cv::boundingRect(last)));
  }

  /// Searches for lost objects: in every frame at their last places, and in turn around these and everywhere.
  void search(double time_s)
  {
    std::vector<FollowedObject*> lost;
    for (FollowedObject& object : objects)
      if (!object.state().tracked && !tryPose(object, object.pose())) lost.push_back(&object);
    for (FollowedObject* object : rounds.choose(std::move(lost), time_s, params.search_period))
      if (!tryNear(*object))
        tryMatch(*object, rounds.features(frames.newest.gray(), params.search_features, time_s, params.search_period));
  }

  ObjectTrackerParams params;
  FramePair frames;
  ConversionBuffer buffer;
  std::vector<FollowedObject> objects;
  int last_id = 0;
  double time = 0.0;  // s, time of the newest frame
  SearchRounds rounds;
};

ObjectTracker::ObjectTracker(const ObjectTrackerParams& params) : impl_(std::make_unique<Impl>())
{
  configure(params);
}

ObjectTracker::~ObjectTracker() = default;
ObjectTracker::ObjectTracker(ObjectTracker&&) noexcept = default;
ObjectTracker& ObjectTracker::operator=(ObjectTracker&&) noexcept = default;

void ObjectTracker::configure(const ObjectTrackerParams& params)
{
  validate(params);
  impl_->params = params;
  impl_->frames.flow = {params.window, params.levels, params.max_error};
}

int ObjectTracker::select(const cv::Rect& region, const std::string& label)
{
  const FlowImage& newest = impl_->frames.newest;
  if (newest.empty()) throw std::invalid_argument("there is no image yet to select a region of");
  FollowedObject& object = impl_->add(newest.gray(), region, label);
  object.setSeen();
  return object.state().id;
}

int ObjectTracker::select(const cv::Mat& image, const std::string& encoding, const cv::Rect& region,
                          const std::string& label)
{
  cv::Mat gray;
  toGray(image, encoding, gray);
  return impl_->add(gray, region, label).state().id;
}

bool ObjectTracker::forget(int id)
{
  std::vector<FollowedObject>& objects = impl_->objects;
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [id](const FollowedObject& object) { return object.state().id == id; });
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
  requireFinite("time_s", time_s);
  const cv::Mat gray = me.buffer.gray(image, encoding);
  FramePair& frames = me.frames;
  std::swap(frames.last, frames.newest);
  frames.newest.set(gray);
  const bool comparable = frames.last.size() == frames.newest.size() && time_s >= me.time;
  frames.elapsed = comparable ? time_s - me.time : 0.0;
  me.time = time_s;
  for (FollowedObject& object : me.objects)
  {
    if (comparable && object.state().tracked)
      object.follow(frames, me.params);
    else
      object.setLost();
  }
  me.search(time_s);
  return objects();
}

std::vector<TrackedObject> ObjectTracker::objects() const
{
  std::vector<TrackedObject> states;
  for (const FollowedObject& object : impl_->objects)
    states.push_back(object.state());
  return states;
}

std::vector<FlowPoint> ObjectTracker::flow(int count)
{
  FramePair& frames = impl_->frames;
  require(count > 0, "count", count, "above 0");
  if (frames.last.empty() || frames.elapsed < kMinInterval || frames.elapsed > kMaxFlowInterval) return {};
  // Corners are found in the image of half the size, which is good enough and takes a quarter of the time.
  int halvings = 1;
  const cv::Mat& small = frames.last.halved(frames.flow, halvings);
  std::vector<cv::Point2f> points;
  const double distance = std::max(4.0, std::sqrt(static_cast<double>(small.total()) / (2.0 * count)));
  cv::goodFeaturesToTrack(small, points, count, 0.005, distance);
  for (cv::Point2f& point : points)
    point *= std::ldexp(1.0, halvings);
  const FollowedPoints moved = followPoints(frames.last, frames.newest, frames.flow, points, points);
  std::vector<FlowPoint> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (moved.found[i] && isInside(frames.newest.size(), moved.positions[i]))
      result.push_back({moved.positions[i], (moved.positions[i] - points[i]) / frames.elapsed});
  return result;
}

}  // namespace robot_vision
