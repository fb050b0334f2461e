#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct ObjectTrackerParams
{
  int points = 40;
  int window = 15;
  int levels = 3;
  double max_error = 1.0;
  double min_similarity = 0.5;
  double min_confidence = 0.3;
  double search_period = 0.25;
  int search_features = 3000;
  double smoothing = 0.1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("points", &ObjectTrackerParams::points, Range{8, 200}, "",
          "most points that are followed of an object selected from now on");
    visit("window", &ObjectTrackerParams::window, OddRange{5, 51}, "px",
          "side of the window around a point that is followed");
    visit("levels", &ObjectTrackerParams::levels, Range{0, 6}, "", "halvings of the image, for fast motion");
    visit("max_error", &ObjectTrackerParams::max_error, Range{0.1, 10}, "px",
          "by which a point that is followed there and back may miss itself");
    visit("min_similarity", &ObjectTrackerParams::min_similarity, Range{0, 1}, "",
          "correlation with its first appearance from which a point counts as seen");
    visit("min_confidence", &ObjectTrackerParams::min_confidence, Range{0.05, 1}, "",
          "share of an object's points seen, below which it is lost");
    visit("search_period", &ObjectTrackerParams::search_period, Range{0, 3600}, "s",
          "time between searches of the whole image for lost objects");
    visit("search_features", &ObjectTrackerParams::search_features, Range{100, 10000}, "",
          "features of the image in such a search");
    visit("smoothing", &ObjectTrackerParams::smoothing, Range{0, 10}, "s", "time constant of the velocity's filter");
  }
};

/// An object in a frame. If it is lost, outline, centre, scale and angle are those of the last frame in which it was
/// seen.
struct TrackedObject
{
  int id = 0;
  std::string label;
  bool tracked = false;  // seen in this frame, otherwise lost
  std::array<cv::Point2d, 4>
      outline;                      // px: the selected region's top left, top right, bottom right, bottom left corner
  cv::Point2d center;               // px
  double scale = 1.0;               // size relative to that when it was selected
  double angle = 0.0;               // rad, rotation since it was selected, clockwise in the image, -pi to pi
  cv::Point2d velocity;             // px/s of the centre, filtered; 0 if it is lost
  double confidence = 0.0;          // share of its points that are seen, 0 to 1; 0 if it is lost
  std::vector<cv::Point2f> points;  // px, the points that are seen; none if it is lost
};

/// The motion of a point of the image.
struct FlowPoint
{
  cv::Point2f position;  // px, in the newest frame
  cv::Point2f velocity;  // px/s
};

/// Follows selected objects from frame to frame, as flat patterns that are shifted, rotated and scaled.
///
/// Feature points (Shi, Tomasi: Good Features to Track, 1994) are followed from the last frame by pyramidal
/// Lucas-Kanade flow, there and back. The similarity transform that most of them agree with is then corrected by the
/// same flow from the object's first appearance. It is accepted only if enough of the points still look as they did at
/// first, so that errors do not add up, and an object that is covered, has left the image or has turned away is lost at
/// once instead of being followed to a wrong place.
///
/// Lost objects are searched for in every frame at the place where they were seen last, and at intervals, a few of them
/// in a frame, in the whole image by their ORB features; what is found must look as the object did at first. No clock
/// is read, and the results do not depend on chance.
///
/// A repeating pattern that moves by about half of its period between two frames is followed to its next repetition,
/// and of two objects that look the same one may be found in the place of the other. Not thread-safe.
class ObjectTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit ObjectTracker(const ObjectTrackerParams& params = ObjectTrackerParams());
  ~ObjectTracker();
  ObjectTracker(ObjectTracker&&) noexcept;
  ObjectTracker& operator=(ObjectTracker&&) noexcept;

  /// Sets the parameters from the next frame on. Objects are kept, with the points that they have.
  /// Throws std::invalid_argument as validate() does.
  void configure(const ObjectTrackerParams& params);

  /// Selects the object in a region (px) of the newest frame, and returns its id: 1, 2, ... Throws
  /// std::invalid_argument if there is no frame yet, or if the region is not inside of the image, is smaller than 16x16
  /// px, or has too few features.
  int select(const cv::Rect& region, const std::string& label = "");

  /// Selects the object in a region of an earlier frame. It counts as lost until it is found in the next frame.
  int select(const cv::Mat& image, const std::string& encoding, const cv::Rect& region, const std::string& label = "");

  /// Forgets an object. Returns whether there was one with this id.
  bool forget(int id);

  /// Forgets all objects.
  void clear();

  /// Follows the objects into the frame at `time_s` (s, of any clock), and returns them in the order in which they were
  /// selected. In a frame of another size than the last one, or of an earlier time, they are searched for as if they
  /// had been lost. `image` is not modified. Throws std::invalid_argument if `image` is not of `encoding` (see
  /// encoding.hpp), and for a time that is not finite.
  std::vector<TrackedObject> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// The objects as update() has returned them, and those that were selected since.
  std::vector<TrackedObject> objects() const;

  /// The optical flow from the last frame but one to the newest at up to `count` feature points. Nothing after the
  /// first frame, after one of another size, and after one whose time is not later, or more than 2 s later.
  std::vector<FlowPoint> flow(int count = 200);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
