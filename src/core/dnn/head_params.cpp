#include "robot_vision/dnn/head_params.hpp"

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinStride = 4, kMaxStride = 1024;  // px
constexpr std::size_t kMaxStrides = 8;

const char* tasksOf(const std::string& head)
{
  if (head == "yolov8") return "detect, segment, pose or oriented";
  return head == "yolov5" ? "detect or segment" : "detect";
}

}  // namespace

void validate(const HeadParams& params)
{
  checkFields(params);
  checkField(("task of " + params.head).c_str(), params.task, OneOf{tasksOf(params.head)});
  const std::size_t thresholds = params.class_thresholds.size();
  require(thresholds == 0 || thresholds == static_cast<std::size_t>(params.classes), "class_thresholds",
          std::to_string(thresholds) + " numbers",
          "none, or one for each of the " + std::to_string(params.classes) + " classes");
  for (const double threshold : params.class_thresholds)
    requireRange("class_thresholds", threshold, 0.0, 1.0);
  require(params.strides.size() <= kMaxStrides, "strides", std::to_string(params.strides.size()) + " numbers",
          "at most " + std::to_string(kMaxStrides));
  for (const int stride : params.strides)
    requireRange("strides", stride, kMinStride, kMaxStride);
}

}  // namespace robot_vision
