#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "face_search.hpp"

namespace robot_vision
{

/// The score of a face on which so many windows agree.
double scoreOf(int neighbors);

/// A face that is followed from frame to frame.
struct FaceTrack
{
  int id = -1;  // -1: a cascade has not seen it twice yet
  FaceView view = FaceView::kFirst;
  cv::Rect box;            // px
  double time = 0.0;       // s, of the box
  double seen = 0.0;       // s, when a cascade saw it last
  int trust = 0;           // frames in which it was seen, less twice how often it was missed; above 0 it is believed
  bool visible = true;     // false: it is only remembered, in case that it comes back
  bool predicted = false;  // not seen by a cascade at `time`
  double score = 0.0;
  cv::Point2d velocity;                          // px/s
  cv::Mat appearance;                            // when a cascade saw it last, as a square
  std::deque<std::pair<double, cv::Rect>> past;  // its boxes, with their times in s
};

/// The known faces.
class FaceTracks
{
public:
  /// Looks for each face near its expected place, in about its size.
  void follow(double time_s, const cv::Mat& gray, FaceSearch& search, const FaceParams& params);

  /// Adds what a search has found in the frame of `result.job.time`, which may be some frames ago.
  void add(const FaceResult& result, double time_s, const FaceParams& params);

  void clear() { tracks_.clear(); }

  /// Forgets faces of other sizes.
  void keep(const FaceWindows& windows);

  /// The faces that are seen or predicted in the newest frame, by their id.
  std::vector<Face> faces() const;

  /// The boxes of these faces.
  std::vector<cv::Rect> boxes() const;

  /// Windows of about the sizes of the known faces, or of all sizes if there is none.
  FaceWindows windows(const FaceParams& params) const;

private:
  void dropDoubles();

  std::vector<FaceTrack> tracks_;
  int next_id_ = 0;
};

}  // namespace robot_vision
