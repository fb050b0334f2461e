#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct DenseFlowParams
{
  std::string method = "dis";
  double scale = 0.5;
  double max_gap = 2.0;
  std::string preset = "medium";
  double pyr_scale = 0.5;
  int levels = 3;
  int window = 15;
  int iterations = 3;
  int poly_n = 5;
  double poly_sigma = 1.2;
  bool gaussian_window = false;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &DenseFlowParams::method, OneOf{"farneback or dis"}, "", "how the flow is found");
    visit("scale", &DenseFlowParams::scale, Range{0.05, 1}, "",
          "size of the image that is worked on, as share of its own; time grows with the square of it");
    visit("max_gap", &DenseFlowParams::max_gap, Above{0, 3600}, "s",
          "between two frames that are compared; a later one begins anew");
    visit("preset", &DenseFlowParams::preset, OneOf{"ultrafast, fast or medium"}, "",
          "dis: how much time is given to accuracy");
    visit("pyr_scale", &DenseFlowParams::pyr_scale, Range{0.1, 0.9}, "",
          "farneback: size of each level of the pyramid in that of the one below");
    visit("levels", &DenseFlowParams::levels, Range{0, 10}, "",
          "farneback: smaller images that the search begins with; more follow faster motion");
    visit("window", &DenseFlowParams::window, OddRange{3, 99}, "px",
          "farneback: side of the area that moves as one; larger is smoother, and blurs borders");
    visit("iterations", &DenseFlowParams::iterations, Range{1, 20}, "", "farneback: repetitions at each level");
    visit("poly_n", &DenseFlowParams::poly_n, OneOf{"5 or 7"}, "px",
          "farneback: size of the neighbourhood that a polynomial is fitted to");
    visit("poly_sigma", &DenseFlowParams::poly_sigma, Range{0.5, 3}, "px",
          "farneback: standard deviation of the weights of that fit; 1.1 suits 5, 1.5 suits 7");
    visit("gaussian_window", &DenseFlowParams::gaussian_window, Anything{}, "",
          "farneback: a Gaussian window instead of a box, which is more accurate and slower");
  }
};

/// Finds how far each pixel has moved since the last frame.
///
/// The flow is that of cv::calcOpticalFlowFarneback or cv::DISOpticalFlow between the gray images, with a scale of 1 to
/// the bit, except that DIS, which needs 32 px in each direction and 96 px in one, is given smaller images with their
/// last rows and columns repeated. With a smaller scale both images are shrunk (cv::INTER_AREA), and the flow is
/// enlarged and multiplied.
///
/// All is done in the thread of the caller, which leaves the other cores to others and costs less in sum. OpenCV can
/// only be told so for the whole process: until update() returns, what it does in other threads, such as those of
/// nodelets in the same manager, is not divided either. No result depends on that. Threads may share one; their calls
/// wait for each other.
class DenseFlow
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit DenseFlow(const DenseFlowParams& params = DenseFlowParams());
  ~DenseFlow();

  /// The flow from the last frame to the one of `time_s` (s, of any clock): CV_32FC2 of the image's size, px to the
  /// right and down, at the place where a pixel was in the last frame. Empty for the first frame, one of another size,
  /// of an earlier time, or of more than max_gap later: each begins anew. `image` is not modified. Throws
  /// std::invalid_argument if `image` is not an image of `encoding` (see encoding.hpp), or, times the scale, longer
  /// than DIS can have (16384 px), or so large that farneback would take many seconds.
  cv::Mat update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// The time between the two frames of the last flow, s; 0 if there was none.
  double interval() const;

  /// Makes the next frame the first one.
  void reset();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The mean of a flow (CV_32FC2), in its unit. A coordinate is NaN if that of a pixel is. Throws std::invalid_argument
/// if it is no such image.
cv::Point2d meanFlow(const cv::Mat& flow);

/// The median of x and that of y, which is how most of the image moves, of two in the middle the upper one. Treats NaN,
/// and throws, as meanFlow() does.
cv::Point2d medianFlow(const cv::Mat& flow);

}  // namespace robot_vision
