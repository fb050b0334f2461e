#pragma once

#include <opencv2/core.hpp>

#include "candidates.hpp"
#include "output_shapes.hpp"
#include "robot_vision/dnn/head_decoder.hpp"

namespace robot_vision
{

/// Where a number of the input is between the numbers of the image: the input's is scale * image's + offset.
struct AxisPlacement
{
  double scale;
  double offset;
};

/// Images whose weighted sum, with the coefficients of a box as weights, is above 0 on its object.
struct MaskPrototypes
{
  const float* values = nullptr;
  int count = 0;
  int height = 0;
  int width = 0;
  AxisPlacement x, y;  // from pixels of the image to those of the prototypes, coordinates as of InputPlacement
};

/// The mask of a box of the image, of pixelsOf(box).
cv::Mat maskOf(const MaskPrototypes& prototypes, const ExtraValues& coefficients, std::size_t index,
               const CornerBox& box);

}  // namespace robot_vision
