#pragma once

#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct HeadParams
{
  std::string head = "yolov8";
  std::string task = "detect";
  int classes = 80;
  int keypoints = 17;
  int keypoint_values = 3;
  double score_threshold = 0.25;
  std::vector<double> class_thresholds;
  double iou_threshold = 0.45;
  bool class_agnostic = false;
  int max_detections = 300;
  int input_width = 640;
  int input_height = 640;
  int reg_max = 7;
  std::vector<int> strides;
  bool background = true;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("head", &HeadParams::head, OneOf{"yolov3, yolov5, yolov8, yolov10, yolox, nanodet, ssd, detr or rtdetr"}, "",
          "the family of networks whose outputs are decoded");
    visit("task", &HeadParams::task, OneOf{"detect, segment, pose or oriented"}, "",
          "what it finds besides boxes: segment is for yolov5 and yolov8, pose and oriented for yolov8");
    visit("classes", &HeadParams::classes, Range{1, 10000}, "", "number of classes, without the background");
    visit("keypoints", &HeadParams::keypoints, Range{1, 1000}, "", "number of keypoints of an object, for pose");
    visit("keypoint_values", &HeadParams::keypoint_values, OneOf{"2 or 3"}, "",
          "numbers of a keypoint: x, y and, of 3, its score");
    visit("score_threshold", &HeadParams::score_threshold, Range{0, 1}, "", "lowest score of an object");
    visit("class_thresholds", &HeadParams::class_thresholds, Anything{}, "",
          "lowest score for each class, instead of score_threshold; empty: the same for all");
    visit("iou_threshold", &HeadParams::iou_threshold, Range{0, 1}, "",
          "boxes that overlap a surer one by more are left out, where the network itself leaves several");
    visit("class_agnostic", &HeadParams::class_agnostic, Anything{}, "", "also those of another class");
    visit("max_detections", &HeadParams::max_detections, Range{1, 10000}, "", "so many are reported, the surest ones");
    visit("input_width", &HeadParams::input_width, Range{1, 4096}, "px", "of the network's input");
    visit("input_height", &HeadParams::input_height, Range{1, 4096}, "px", "of the network's input");
    visit("reg_max", &HeadParams::reg_max, Range{1, 64}, "", "of nanodet: bins of a distance, less one");
    visit("strides", &HeadParams::strides, Anything{}, "px",
          "of the grids of nanodet, with three of its first version, and yolox, in the order of the output; empty: 8, "
          "16, 32, and 64 for nanodet");
    visit("background", &HeadParams::background, Anything{}, "", "class 0 of ssd is the background");
  }
};

/// Also throws unless the head has the task, class_thresholds has as many numbers as there are classes, each from 0 to
/// 1, or none, and there are at most 8 strides, from 4 to 1024.
void validate(const HeadParams& params);

}  // namespace robot_vision
