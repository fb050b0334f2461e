#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct FlowDrawingParams
{
  std::string draw = "wheel";
  double max_speed = 0.0;
  int arrow_spacing = 16;
  double arrow_scale = 3.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("draw", &FlowDrawingParams::draw, OneOf{"wheel or arrows"}, "", "how ~processed_image shows the flow");
    visit("max_speed", &FlowDrawingParams::max_speed, Range{0, 1000}, "px per frame",
          "wheel: speed of the brightest colour; 0: the largest in the frame, and 1 at least");
    visit("arrow_spacing", &FlowDrawingParams::arrow_spacing, Range{4, 500}, "px", "arrows: distance between them");
    visit("arrow_scale", &FlowDrawingParams::arrow_scale, Range{0.1, 100}, "",
          "arrows: length, in the distance that the pixel has moved");
  }
};

// The functions take a flow of CV_32FC2, in px, and throw std::invalid_argument if it is none.

/// Writes the flow as colours (CV_8UC3, BGR) into `bgr`, which is reused if it fits: the hue is the angle (red to the
/// right, yellow-green down, cyan to the left, violet up), and the brightness is the speed in `max_speed`; more is as
/// bright. With 0 the largest speed is the brightest, if it is 1 px or more: noise of an image at rest stays dark.
void flowToColors(const cv::Mat& flow, double max_speed, cv::Mat& bgr);

/// Draws an arrow for every `spacing` px each way on `bgr` (CV_8UC3, of the same size), from where the pixel was,
/// `scale` times as long as it moved. Where nothing moves by half a pixel there is a dot. Throws std::invalid_argument
/// naming what does not fit.
void drawFlowArrows(cv::Mat& bgr, const cv::Mat& flow, int spacing, double scale);

}  // namespace robot_vision
