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

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const ObjectTrackerParams& params);

/// An object in a frame. If it is lost, outline, centre, scale and angle are those of the last frame it was seen in.
struct TrackedObject
{
  int id = 0;
  std::string label;
  bool tracked = false;                // seen in this frame; else lost
  std::array<cv::Point2d, 4> outline;  // px: what was the region's top left, top right, bottom right, bottom left
  cv::Point2d center;                  // px
  double scale = 1.0;                  // size, 1 when it was selected
  double angle = 0.0;                  // rad, by which it has turned since, clockwise as seen, -pi to pi
  cv::Point2d velocity;                // px/s of the centre, filtered; 0 if it is lost
  double confidence = 0.0;             // share of its points that are seen, 0 to 1; 0 if it is lost
  std::vector<cv::Point2f> points;     // px, those seen; none if it is lost
};

/// How a point of the picture moves.
struct FlowPoint
{
  cv::Point2f position;  // px, in the newest frame
  cv::Point2f velocity;  // px/s
};

/// Follows selected objects from frame to frame, as pictures that are shifted, turned and scaled.
///
/// Feature points (Shi, Tomasi: Good Features to Track, 1994) are followed from the last frame by pyramidal
/// Lucas-Kanade flow there and back. The similarity that most of them agree with is then corrected by the same flow
/// from the object's first appearance, and is believed only if enough of the points still look as they did: errors do
/// not add up, and an object that is covered, has left or has turned away is lost in that frame, not followed to
/// somewhere else. Lost objects are searched for where they were last seen in every frame, and by their ORB features in
/// the whole picture at intervals; what is found must look as the object did. No clock is read, and no chance is
/// involved.
///
/// A pattern that repeats is followed to its next repetition if it moves by about half of one between two frames, and
/// of two objects that look the same one may be found in the place of the other. Not for two threads at once.
class ObjectTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit ObjectTracker(const ObjectTrackerParams& params = ObjectTrackerParams());
  ~ObjectTracker();
  ObjectTracker(ObjectTracker&&) noexcept;
  ObjectTracker& operator=(ObjectTracker&&) noexcept;

  /// Parameters from the next frame on; objects stay, with the points that they have.
  /// Throws std::invalid_argument as validate() does.
  void configure(const ObjectTrackerParams& params);

  /// Selects what is in a region (px) of the newest frame, and returns its id: 1, 2, ... Throws std::invalid_argument
  /// if there is no frame yet, the region is not inside of the picture, is smaller than 16x16 px, or has no features.
  int select(const cv::Rect& region, const std::string& label = "");

  /// Selects what is in a region of a frame of the past; it is lost until it is found in the next frame.
  int select(const cv::Mat& image, const std::string& encoding, const cv::Rect& region, const std::string& label = "");

  /// Forgets an object; whether there was one.
  bool forget(int id);

  /// Forgets all objects.
  void clear();

  /// The objects in the frame of `time_s` (s, of any clock), in the order in which they were selected. In a frame of
  /// another size than the last, or of an earlier time, they are searched for as if they had been lost. `image` is not
  /// modified. Throws std::invalid_argument if `image` is not a picture of `encoding` (see encoding.hpp), and for a
  /// time that is not finite.
  std::vector<TrackedObject> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// The objects as update() has returned them, and those selected since.
  std::vector<TrackedObject> objects() const;

  /// How the picture has moved from the last frame but one to the newest, at up to `count` of its feature points; none
  /// where that cannot be said: after the first frame, one of another size, or of no later time.
  std::vector<FlowPoint> flow(int count = 200);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
