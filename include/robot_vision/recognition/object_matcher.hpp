#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/recognition/pose_candidate.hpp"
#include "robot_vision/recognition/view_model.hpp"

namespace robot_vision
{

struct ObjectMatchParams
{
  int max_candidates = 30;
  double min_score = 0.0;
  double min_distance = 0.3;
  double max_distance = 3.0;
  int min_size = 24;
  int contrast = 12;
  double jump = 0.01;
  int threads = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("max_candidates", &ObjectMatchParams::max_candidates, Range{1, 1000}, "",
          "of each object, the best; with depths up to as many more where other pieces of it seem to be");
    visit("min_score", &ObjectMatchParams::min_score, Range{0, 1}, "", "least score of a candidate");
    visit("min_distance", &ObjectMatchParams::min_distance, Range{0.05, 100}, "m",
          "nearest that objects are looked for");
    visit("max_distance", &ObjectMatchParams::max_distance, Range{0.05, 100}, "m", "farthest");
    visit("min_size", &ObjectMatchParams::min_size, Range{16, 1000}, "px",
          "of an object's diameter in the image; it is not looked for where it would be smaller");
    visit("contrast", &ObjectMatchParams::contrast, Range{1, 255}, "gray levels",
          "smallest step of an edge in the image");
    visit("jump", &ObjectMatchParams::jump, Range{0.001, 1}, "",
          "smallest step of an edge of depth, as share of the depth");
    visit("threads", &ObjectMatchParams::threads, Range{1, 64}, "",
          "that share the work, as far as OpenCV's setting allows");
  }
};

/// Throws std::invalid_argument for the first parameter out of range, and for a max_distance not above min_distance.
void validate(const ObjectMatchParams& params);

/// Looks for objects, of which it has models, in the frames of a camera, with or without depths.
///
/// Views are compared by the directions of edges and by normals of surfaces, each in eight bins, which are spread to
/// where an object's part may be. How large a view is at a place comes from the depth there, so that one size of each
/// is enough. Coarse views choose the finer ones that are compared; the best of these are looked at closely, each
/// feature at its own depth, and moved to where surfaces and edges are. The image is made as small as a VGA depth
/// camera's with half the pixels in a row, and its distortion is removed: it may have any size.
///
/// The same frames give the same candidates, whatever the number of threads and what was matched before. Memory is kept
/// from frame to frame. For one thread at a time.
///
/// Source: Hinterstoisser, Cagniart, Ilic, Sturm, Navab, Fua, Lepetit: Gradient Response Maps for Real-Time Detection
/// of Textureless Objects, PAMI 2012 (LINEMOD); Hinterstoisser, Lepetit, Ilic, Holzer, Bradski, Konolige, Navab: Model
/// Based Training, Detection and Pose Estimation of Texture-Less 3D Objects in Heavily Cluttered Scenes, ACCV 2012.
class ObjectMatcher
{
public:
  /// Throws std::invalid_argument as validate() of the parameters does.
  explicit ObjectMatcher(const ObjectMatchParams& params = ObjectMatchParams());
  ~ObjectMatcher();

  /// Other parameters from now on. Throws as the constructor does.
  void configure(const ObjectMatchParams& params);

  /// Adds an object; the index of its model: 0, 1, ... What is searched by is made with the first frame, one with
  /// depths or one without. Throws std::invalid_argument as validate() of the model does, and for one whose training
  /// has not ended.
  int add(const ViewModel& model);

  /// How many it has.
  int models() const;

  /// Bytes of memory that the model of this index takes. Throws std::invalid_argument for an index that there is not.
  std::size_t memory(int model) const;

  /// Where the objects may be, those of one model after the other, the best of it first; poses in the camera's optical
  /// frame, m. `image` is CV_8UC3 (BGR) or CV_8UC1 (gray), `depth` of `encoding` (depth_image.hpp), both of the
  /// camera's size and not remapped; one of them may be empty. Without depth (a webcam) all distances are tried, which
  /// takes some ten times as long and finds less among other things. `mask` (CV_8UC1, of this size; empty: all) is not
  /// 0 where an object's anchor, a point in the middle of what is seen of it, may be. Throws std::invalid_argument if
  /// both images are empty, for images of other sizes or types, for a camera that is not calibrated, and as validate()
  /// of the camera does.
  std::vector<PoseCandidate> match(const cv::Mat& image, const cv::Mat& depth, const std::string& encoding,
                                   const CameraModel& camera, const cv::Mat& mask = cv::Mat());

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
