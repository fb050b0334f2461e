#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

struct VerifierParams
{
  double tolerance = 0.002;
  int max_pixels = 6000;
  double min_gradient = 50.0;
  double max_hue_error = 10.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("tolerance", &VerifierParams::tolerance, Range{0, 0.1}, "m",
          "standard deviation of the surface from its mesh and of the pose, beyond the noise of the sensor");
    visit("max_pixels", &VerifierParams::max_pixels, Range{100, 10000000}, "",
          "that are compared, of the box around an object; of a larger one rows and columns are left out");
    visit("min_gradient", &VerifierParams::min_gradient, Range{1, 1000}, "",
          "gradient of colors (Sobel, 3x3) from which something can be a contour");
    visit("max_hue_error", &VerifierParams::max_hue_error, Range{1, 90}, "deg",
          "largest angle between the directions of two colors in RGB that are alike, however bright they are");
  }
};

/// What a frame says for and against an object in a pose. A share is NaN where nothing tells it.
struct PoseEvidence
{
  double agreeing = 0.0;  // share of the object's pixels where the depth is that of its surface
  double pierced = 0.0;   // where something behind its surface is seen
  double hidden = 0.0;    // where something before it is seen
  double unknown = 0.0;   // without a depth; with those above 1
  double sunken = 0.0;    // share of the border of what agrees where what is seen goes straight on before the object
  double misfit = 0.0;    // root mean square distance of what agrees, in standard deviations
  double noise = 0.0;     // what the misfit is if it is the sensor's noise alone
  double normals = 0.0;   // share of the parts of what agrees that have the surface's normal
  double outline = 0.0;   // share of its outline, as far as it is not hidden, where the frame changes
  double inner = 0.0;     // the same of its creases and of the edges of its texture
  double colors = 0.0;    // share of the parts that are not hidden that have its color
  double pattern = 0.0;   // correlation of its brightness and that of the frame, -1 to 1
  double pixels = 0.0;    // px^2 of the image that agree; without depths, that it covers
};

/// How probable a pose is after comparison.
struct PoseVerdict
{
  double probability = 0.0;  // 0 to 1, that the object is there in this pose
  double log_odds = -30.0;   // of it, which tell those apart that are nearly 0 or 1
  double occlusion = 0.0;    // 0 to 1, share of the object that is hidden
  PoseEvidence evidence;
  cv::Rect box;       // px, around what is drawn of the object within the image
  int step = 1;       // px between the pixels that were compared, along rows and columns of the box
  cv::Mat explained;  // CV_8UC1, of the compared pixels: 255 where the object is what is seen
};

/// Draws an object in a pose and compares it with a frame.
///
/// Each pixel's depth is compared by the noise of the sensor, the slopes of the differences are compared in blocks of
/// pixels, which are small where the normals agree. Outlines need something behind them, or an edge in the image.
/// Colors are compared in blocks, but for their brightness. What hides a part of the object has an edge where the
/// other part ends: if not, the object would be within another thing, as in a table that one of its sides is a part of.
/// All of it becomes a probability by logistic functions, whose weights the program fit_verification
/// (test/benchmarks) has found for frames with depths and colors, of objects with colors and without, and for frames
/// with depths; for colors alone they are set with more weight on outlines.
///
/// Memory is kept from call to call. For one thread at a time.
class PoseVerifier
{
public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PoseVerifier(const VerifierParams& params = VerifierParams(),
                        const DepthErrorParams& errors = DepthErrorParams());
  ~PoseVerifier();
  PoseVerifier(PoseVerifier&&) noexcept;
  PoseVerifier& operator=(PoseVerifier&&) noexcept;

  /// A probability of 0 where nothing of the object would be seen. Throws std::invalid_argument if the pose is not that
  /// of a rigid body, and if nothing was set in the frame.
  PoseVerdict verify(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What the logistic function takes, in the order of its weights; 0 for what is not known.
std::vector<double> evidenceFeatures(const PoseEvidence& evidence);

}  // namespace robot_vision
