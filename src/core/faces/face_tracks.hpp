#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "face_search.hpp"
#include "face_worker.hpp"

namespace robot_vision
{

/// The score of a face on which so many windows agree.
double scoreOf(int neighbors);

/// How a face looked when a cascade saw it last.
class FaceTemplate
{
public:
  FaceTemplate() = default;
  FaceTemplate(const cv::Mat& gray, const cv::Rect& box);

  /// Where in the picture it looks like that most, up to `margin` px away from `expected`, and how much (-1 to 1).
  std::optional<std::pair<cv::Rect, double>> locate(const cv::Mat& gray, const cv::Rect& expected, int margin) const;

private:
  cv::Mat patch_;
};

/// A face that is followed from frame to frame.
struct FaceTrack
{
  int id = -1;  // -1: a cascade has not seen it twice yet
  FaceView view = FaceView::kFirst;
  cv::Rect box;            // px
  double time = 0.0;       // s, of the box
  double seen = 0.0;       // s, when a cascade saw it last
  int trust = 0;           // frames in which it was seen, less those in which it was not; above 0: it is believed in
  bool visible = true;     // or remembered only, in case that it comes back
  bool predicted = false;  // not seen by a cascade at `time`
  double score = 0.0;
  cv::Point2d velocity;  // px/s
  FaceTemplate looks;
  std::deque<std::pair<double, cv::Rect>> past;  // where it was, by time
};

/// The faces that are known.
class FaceTracks
{
public:
  /// Searches only near the faces, where each should be, and for about its size.
  void follow(double time_s, const cv::Mat& gray, FaceSearch& search, const FaceParams& params);

  /// Takes what a search of the frame of `result.job.time` has found, which may be some frames ago.
  void add(const FaceResult& result, double time_s, const FaceParams& params);

  void clear() { tracks_.clear(); }

  /// Forgets faces of other sizes.
  void keep(const FaceWindows& windows);

  /// Those that are seen, or predicted, in the newest frame, by their id.
  std::vector<Face> faces() const;

  /// Where they are now, and windows of about their sizes; all of them if there are no faces.
  std::vector<cv::Rect> boxes() const;
  FaceWindows windows(const FaceParams& params) const;

private:
  void dropDoubles();

  std::vector<FaceTrack> tracks_;
  int next_id_ = 0;
};

}  // namespace robot_vision
