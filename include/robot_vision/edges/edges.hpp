#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct EdgeParams
{
  int blur_size = 7;
  double low_threshold = 15.0;
  double high_threshold = 30.0;
  int aperture = 3;
  bool l2_gradient = false;
  int threads = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("blur_size", &EdgeParams::blur_size, OddRange{1, 31}, "px", "side of the box blur; 1: none");
    visit("low_threshold", &EdgeParams::low_threshold, Range{0, 10000}, "",
          "gradient magnitude above which a pixel prolongs an edge");
    visit("high_threshold", &EdgeParams::high_threshold, Range{0, 10000}, "",
          "gradient magnitude above which a pixel begins an edge; at least low_threshold");
    visit("aperture", &EdgeParams::aperture, OneOf{"3, 5 or 7"}, "px", "side of the Sobel kernel");
    visit("l2_gradient", &EdgeParams::l2_gradient, Anything{}, "",
          "Euclidean magnitude of the gradient, instead of the sum of its two absolute values");
    visit("threads", &EdgeParams::threads, Range{1, 64}, "",
          "number of threads that share an image, as far as OpenCV's setting allows; with aperture 5 and 7 it is "
          "OpenCV that works");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const EdgeParams& params);

/// Finds Canny edges in the blurred image, bit for bit as cv::cvtColor, cv::blur and cv::Canny do. With an aperture of
/// 3, each row is processed from the input to its edge candidates while it is in the processor's cache; with others
/// OpenCV does the work, in its own threads. Memory is kept from frame to frame, so that a stream allocates none.
class EdgeDetector
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit EdgeDetector(const EdgeParams& params = EdgeParams());
  EdgeDetector(EdgeDetector&&);
  EdgeDetector& operator=(EdgeDetector&&);
  ~EdgeDetector();

  /// Writes CV_8UC1, 255 on edges and 0 elsewhere, into `edges` (reused if it fits). `image` is not modified.
  /// Throws std::invalid_argument if `image` is not of `encoding` (see encoding.hpp).
  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& edges);

  /// The encoding of what apply() writes for input of `encoding`: mono8.
  static std::string outputEncoding(const std::string& /*encoding*/) { return "mono8"; }

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
