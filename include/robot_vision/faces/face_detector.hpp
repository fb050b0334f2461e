#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct FaceParams
{
  std::string cascade_1 = "haarcascade_frontalface_default.xml";
  std::string cascade_2 = "haarcascade_profileface.xml";
  std::string eye_cascade = "haarcascade_eye.xml";
  double scale_factor = 1.2;
  int min_neighbors = 2;
  int min_size = 40;
  int max_size = 0;
  bool equalize = true;
  double max_search_period = 0.5;
  double hold = 0.5;
  bool background = true;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("cascade_1", &FaceParams::cascade_1, Anything{}, "",
          "Haar or LBP cascade that is tried first: a path, or a name in OpenCV's data");
    visit("cascade_2", &FaceParams::cascade_2, Anything{}, "",
          "cascade that is tried where the first finds none, also mirrored: a path, a name in OpenCV's data, or "
          "empty: none");
    visit("eye_cascade", &FaceParams::eye_cascade, Anything{}, "",
          "cascade of the eyes in a face: a path, a name in OpenCV's data, or empty: none");
    visit("scale_factor", &FaceParams::scale_factor, Range{1.01, 4}, "", "from one size that is searched to the next");
    visit("min_neighbors", &FaceParams::min_neighbors, Range{0, 100}, "",
          "windows that must agree on a face besides the first");
    visit("min_size", &FaceParams::min_size, Range{1, 8192}, "px", "side of the smallest face");
    visit("max_size", &FaceParams::max_size, Range{0, 8192}, "px",
          "side of the largest face, min_size or more; 0: any");
    visit("equalize", &FaceParams::equalize, Anything{}, "", "stretch the gray levels first");
    visit("max_search_period", &FaceParams::max_search_period, Range{0, 60}, "s",
          "a new face is found within this; 0: one search after the other");
    visit("hold", &FaceParams::hold, Range{0, 60}, "s",
          "a face is followed for at most so long by its looks alone, where no cascade sees it");
    visit("background", &FaceParams::background, Anything{}, "",
          "search whole images in a thread of its own, while update() goes on");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range. Cascades are not
/// read.
void validate(const FaceParams& params);

/// A face in a frame.
struct Face
{
  int id = -1;             // the same for the same face from frame to frame, from 0; -1: not followed
  cv::Rect box;            // px, as the cascade's window
  double score = 0.0;      // 0 to 1: n / (n + 4) of the n windows that agree, or if predicted a correlation
  cv::Point2d velocity;    // px/s of the middle
  bool predicted = false;  // followed by its appearance: no cascade has seen it in this frame
};

/// Finds faces with cascades of boosted features (Viola, Jones: Rapid Object Detection using a Boosted Cascade of
/// Simple Features, CVPR 2001), and follows them.
///
/// detect() searches the whole image, as cv::CascadeClassifier::detectMultiScale does. update() does that every now
/// and then, so that a new face is found within max_search_period; in the frames between it searches around the known
/// faces, where a few windows of about the right size do, and where the image has changed. A face is reported when a
/// cascade has seen it in this very frame, or within the last `hold` seconds and it still looks as it did then,
/// unless it was seen too seldom, or by too few windows, before. After 2 s out of sight, or without a frame, a face
/// gets another id.
class FaceDetector
{
public:
  /// Throws std::invalid_argument as validate() does, and naming the parameter and the file if one of the cascades is
  /// not there or none.
  explicit FaceDetector(const FaceParams& params = FaceParams());
  ~FaceDetector();

  /// Other parameters from now on; the faces remain known. Throws as the constructor does, and then changes nothing.
  void configure(const FaceParams& params);

  /// All faces in a single image, the largest first. Does not touch what update() follows.
  /// Throws std::invalid_argument if `image` is not an image of `encoding` (see encoding.hpp).
  std::vector<Face> detect(const cv::Mat& image, const std::string& encoding);

  /// The faces in the frame of `time_s` (s, of any clock), by their id. An image of another size and time that goes
  /// back make it forget them. Throws as detect() does.
  std::vector<Face> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// Up to two eyes, the left one in the image first, in a face of the frame that was updated or detected last, px.
  /// Empty if there is no eye_cascade.
  std::vector<cv::Rect> findEyes(const Face& face);

  /// The time that the last search of a whole image took, s of update()'s clock; 0 if none has ended.
  double searchTime() const;

  /// Waits for a search in the background, so that the next update() has what it has found: for recordings, and for
  /// results that do not depend on how fast the machine is.
  void waitForSearch() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
