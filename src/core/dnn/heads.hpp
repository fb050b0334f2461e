#pragma once

#include "candidates.hpp"
#include "output_shapes.hpp"
#include "robot_vision/dnn/head_params.hpp"

namespace robot_vision
{

// Each finds the boxes in the outputs of one family of networks, and throws std::invalid_argument if the outputs are
// not those of the family. n is the number of boxes, C that of the classes.

/// Darknet's YOLOv2 to v4 by cv::dnn: outputs (n, 5 + C) with rows of centre and size in 0..1 of the input, objectness,
/// and class scores that are multiplied by it already. Those below `thresh` of the layer in the .cfg file (0.2 if it
/// names none) are 0.
void findYolov3(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, n, 5 + C): centre and size in px of the input, objectness, class scores; to segment, coefficients follow.
void findYolov5(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, n, 5 + C): centre in cells from the corner of that of the row, size as logarithm of cells; else as YOLOv5's.
void findYolox(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, 4 + C, n): centre and size in px of the input, class scores; then coefficients, keypoints or an angle in rad.
void findYolov8(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, n, 6): corners in px of the input, score, class.
void findYolov10(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, n, C + 4 * (reg_max + 1)): class scores; for each side of the box, the bins of its distance from the centre of
/// the row, in strides. The centres of NanoDet-Plus are at the upper left corners of the cells, those of the first
/// version, which has three strides, in their middle.
void findNanodet(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, 1, n, 7): number of the image, class, score, corners in 0..1 of the input; or corners (1, n, 4), classes (1, n)
/// and scores (1, n).
void findSsd(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// Logits (1, n, C + 1), the last of which is for no object, and centre and size (1, n, 4) in 0..1 of the input.
void findDetr(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

/// (1, n, 4 + C): centre and size in 0..1 of the input, class scores; or logits (1, n, C) and (1, n, 4).
void findRtdetr(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);

}  // namespace robot_vision
