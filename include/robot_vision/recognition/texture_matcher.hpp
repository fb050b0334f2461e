#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/recognition/pose_candidate.hpp"
#include "robot_vision/recognition/texture_model.hpp"

namespace robot_vision
{

struct TextureMatchParams
{
  int texture_width = 1280;
  int texture_features = 5000;
  double texture_ratio = 0.85;
  double texture_error = 2.5;
  int texture_rounds = 600;
  int texture_inliers = 8;
  int texture_instances = 5;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("texture_width", &TextureMatchParams::texture_width, Range{16, 10000}, "px",
          "to which the width of a smaller image is enlarged before keypoints are looked for, at most twice");
    visit("texture_features", &TextureMatchParams::texture_features, Range{50, 5000}, "",
          "most keypoints of an image, the strongest");
    visit("texture_ratio", &TextureMatchParams::texture_ratio, Above{0, 1}, "",
          "largest distance of a keypoint from the place of an object that looks most like it, as a share of that "
          "from the next one");
    visit("texture_error", &TextureMatchParams::texture_error, Range{0.5, 20}, "px",
          "from where a keypoint is expected, up to which it agrees with a pose; more for large ones");
    visit("texture_rounds", &TextureMatchParams::texture_rounds, Range{10, 100000}, "",
          "poses by three keypoints that are tried for each instance of an object");
    visit("texture_inliers", &TextureMatchParams::texture_inliers, Range{4, 1000}, "",
          "fewest keypoints at different places that must agree with a pose");
    visit("texture_instances", &TextureMatchParams::texture_instances, Range{1, 100}, "",
          "of one object that are looked for");
  }
};

/// An object whose texture is seen.
struct TexturedObject
{
  PoseCandidate candidate;
  cv::Matx66d covariance;  // of x, y, z (m) and the rotations about x, y, z (rad) along the camera's axes
  double probability =
      0.0;             // 0 to 1, that it is no coincidence, and at the distance that depths tell; and that it is
                       // not tilted to the other side, if it could be: then there is another object with that pose
  int matches = 0;     // keypoints within its outline that look like one of its own
  int inliers = 0;     // of them that are where they should be
  double error = 0.0;  // px, root mean square distance of these from where they should be
  double depth_agreement = 0.0;  // share of them whose depth is that of the object; NaN: there is none
};

/// Finds objects by their texture in the images of a camera, with or without depths.
///
/// Each keypoint of the image is given to the place on the object that looks most like it, if no other place does
/// (Lowe: Distinctive Image Features from Scale-Invariant Keypoints, 2004). Poses by three of them that are near each
/// other are tried, and the one that most agree with is refined by all of these, and by their depths; then those of
/// further instances are looked for among the rest. How probable a pose is comes from how often so many would agree by
/// chance (Moisan, Stival: A Probabilistic Criterion to Detect Rigid Point Matches Between Two Images, IJCV 2004).
///
/// The same images give the same result. Memory is kept from frame to frame. For one thread at a time.
class TextureMatcher
{
public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit TextureMatcher(const TextureMatchParams& params = TextureMatchParams(),
                          const DepthErrorParams& errors = DepthErrorParams());
  ~TextureMatcher();
  TextureMatcher(TextureMatcher&&) noexcept;
  TextureMatcher& operator=(TextureMatcher&&) noexcept;

  /// Adds a model, whose index is returned: 0, 1, ... Throws std::invalid_argument as validate() of the model does, and
  /// for one without points.
  int add(const TextureModel& model);

  /// The objects, those of each model the most probable first. `image` is CV_8UC3 (BGR) or CV_8UC1, `depth` empty or of
  /// `encoding` (see depth_image.hpp), both of the camera's size; `mask` (CV_8UC1, empty: everywhere) is not 0 where
  /// keypoints count. Throws std::invalid_argument for images of another type or size, and as validate() of the camera
  /// does.
  std::vector<TexturedObject> match(const cv::Mat& image, const cv::Mat& depth, const std::string& encoding,
                                    const CameraModel& camera, const cv::Mat& mask = cv::Mat());

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
