#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct WindowTrackerParams
{
  std::string method = "camshift";
  std::string channels = "hue";
  int hue_bins = 16;
  int saturation_bins = 8;
  int min_saturation = 60;
  int min_value = 32;
  bool subtract_background = true;
  int max_iterations = 10;
  double epsilon = 1.0;
  double min_similarity = 0.3;
  double min_area = 64.0;
  double max_prediction = 0.3;
  double smoothing = 0.1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &WindowTrackerParams::method, OneOf{"meanshift or camshift"}, "",
          "meanshift moves the window, camshift turns and resizes it as well");
    visit("channels", &WindowTrackerParams::channels, OneOf{"hue or hue_saturation"}, "",
          "what the histogram of the object counts");
    visit("hue_bins", &WindowTrackerParams::hue_bins, Range{1, 180}, "", "of the hues, which are 0 to 179");
    visit("saturation_bins", &WindowTrackerParams::saturation_bins, Range{1, 256}, "",
          "hue_saturation: of the saturations, which are 0 to 255");
    visit("min_saturation", &WindowTrackerParams::min_saturation, Range{0, 255}, "",
          "pixels below it do not count: they are gray, and have hardly a hue");
    visit("min_value", &WindowTrackerParams::min_value, Range{0, 255}, "",
          "pixels below it do not count: they are dark, and have hardly a hue");
    visit("subtract_background", &WindowTrackerParams::subtract_background, Anything{}, "",
          "colours count less that were around the object, too, when it was selected");
    visit("max_iterations", &WindowTrackerParams::max_iterations, Range{1, 100}, "",
          "most steps of the window in a frame");
    visit("epsilon", &WindowTrackerParams::epsilon, Range{1, 50}, "px", "a step that is shorter is the last");
    visit("min_similarity", &WindowTrackerParams::min_similarity, Range{0, 1}, "",
          "mean of the back projection in the outline, below which the object is lost");
    visit("min_area", &WindowTrackerParams::min_area, Range{1, 1e9}, "px^2", "smallest outline; it is lost below");
    visit("max_prediction", &WindowTrackerParams::max_prediction, Range{0, 60}, "s",
          "a lost object is expected for so long where its velocity leads; 0: never");
    visit("smoothing", &WindowTrackerParams::smoothing, Range{0, 10}, "s", "time constant of the velocity's filter");
  }
};

/// The object of a WindowTracker in a frame. If it is lost, window, scale and angle are those of the last frame in
/// which it was seen, and so are outline and center, unless it is predicted.
struct TrackedWindow
{
  int id = 0;
  std::string label;
  bool tracked = false;                // seen in this frame, otherwise lost
  bool predicted = false;              // lost, but expected at outline and center
  cv::Rect window;                     // px, as cv::meanShift or cv::CamShift gives it
  std::array<cv::Point2d, 4> outline;  // px: corners of the window, or of the rotated rectangle of cv::CamShift
  cv::Point2d center;                  // px, centre of mass of the back projection there
  double scale = 1.0;                  // size relative to that when it was selected
  double angle = 0.0;                  // rad, rotation since it was selected, clockwise, -pi to pi; 0 for meanshift
  cv::Point2d velocity;                // px/s of the centre, filtered; 0 if it is neither tracked nor predicted
  double confidence = 0.0;             // mean of the back projection in the outline, 0 to 1; 0 if it is lost
};

/// Follows one selected object by the colours that it had when it was selected (Bradski: Computer Vision Face Tracking
/// For Use in a Perceptual User Interface, 1998).
///
/// cv::calcBackProject gives each pixel the frequency of its hue, or of its hue and saturation, in the object; from the
/// window of the last frame cv::meanShift or cv::CamShift goes to where these are densest. With subtract_background
/// each bin is multiplied by 1 - b / a, 0 at least, where a is the share that it has of the object's pixels, and b that
/// of the pixels around it, in three times the width and height.
///
/// The object is lost if its colours are too few in the outline, or the outline is too small. Then the place in the
/// whole image is tried, in every frame, where a window as large as the selection has most of them. What has the same
/// colours is not told from the object. No clock is read. Not thread-safe.
class WindowTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit WindowTracker(const WindowTrackerParams& params = WindowTrackerParams());
  ~WindowTracker();
  WindowTracker(WindowTracker&&) noexcept;
  WindowTracker& operator=(WindowTracker&&) noexcept;

  /// Sets the parameters from the next frame on. The object is kept: its histogram is counted anew. With another method
  /// its scale goes on from what it is, and its angle from 0.
  /// Throws std::invalid_argument as validate() does.
  void configure(const WindowTrackerParams& params);

  /// Selects the object in a region (px) of the newest frame in place of the one before, and returns its id: 1, 2, ...
  /// Throws std::invalid_argument, and keeps the one before, if there is no frame yet, if the region is not inside of
  /// the image or smaller than min_area, and if what is in it would be lost at once.
  int select(const cv::Rect& region, const std::string& label = "");

  /// Forgets the object. Returns whether there was one with this id.
  bool forget(int id);

  /// Follows the object into the frame at `time_s` (s, of any clock), and returns it, if there is one. In a frame of
  /// another size than the last one, or of an earlier time, it is searched for as if it had been lost. `image` is not
  /// modified. Throws std::invalid_argument if `image` is not of `encoding` (see encoding.hpp), and for a time that is
  /// not finite.
  std::vector<TrackedWindow> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// The object as update() has returned it, or as it was selected since; one at most.
  std::vector<TrackedWindow> objects() const;

  /// The back projection in the newest frame: CV_8UC1, 255 for the most frequent colour. Empty without an object. It is
  /// not written to any more.
  cv::Mat backProjection() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
