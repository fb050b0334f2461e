#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// A rectangle of a feature; the sum of its pixels counts `weight` times, a whole number.
struct HaarRectangle
{
  cv::Rect box;  // px, from the upper left corner of the window
  float weight = 0.0F;
};

/// A weak classifier: votes by one feature, which is divided by the contrast of the window.
struct HaarStump
{
  std::array<HaarRectangle, 3> rectangles;  // the third one's weight may be 0
  float threshold = 0.0F;
  float below = 0.0F;  // its vote if the feature is below the threshold
  float above = 0.0F;  // its vote if not
};

/// Rejects a window if its stumps' votes are less than the threshold.
struct HaarStage
{
  float threshold = 0.0F;
  std::vector<HaarStump> stumps;
};

/// A cascade of boosted Haar features, of upright rectangles and trees of one node, as most of OpenCV's are.
struct HaarCascade
{
  cv::Size window;  // px, of the smallest face
  std::vector<HaarStage> stages;
};

/// Reads a cascade from a file. Null if it is of another kind, or if its features are so large that their sums would
/// have to be rounded; throws cv::Exception for a file that cv::FileStorage cannot read.
std::shared_ptr<const HaarCascade> readHaarCascade(const std::string& path);

}  // namespace robot_vision
