#include "robot_vision/dnn/head_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "candidates.hpp"
#include "heads.hpp"
#include "image_frame.hpp"
#include "object_mask.hpp"
#include "output_shapes.hpp"
#include "suppression.hpp"

namespace robot_vision
{
namespace
{

struct Head
{
  const char* name;
  void (*find)(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates);
  bool suppresses;  // whether the network has left out what overlaps
};

constexpr Head kHeads[] = {
    {"yolov3", findYolov3, false},  {"yolov5", findYolov5, false}, {"yolov8", findYolov8, false},
    {"yolov10", findYolov10, true}, {"yolox", findYolox, false},   {"nanodet", findNanodet, false},
    {"ssd", findSsd, true},         {"detr", findDetr, true},      {"rtdetr", findRtdetr, true},
};

bool isSurer(const Candidate& a, const Candidate& b)
{
  return a.score != b.score ? a.score > b.score : a.index < b.index;
}

/// The surest candidates that are in the image, at most `count` of them, sorted.
void keepSurest(std::vector<Candidate>& found, std::size_t count, const ImageFrame& frame, bool oriented)
{
  const auto is_outside = [&](const Candidate& candidate)
  {
    const CornerBox box = frame.boxOf(candidate, oriented);
    return !(box.x1 > box.x0 && box.y1 > box.y0);
  };
  found.erase(std::remove_if(found.begin(), found.end(), is_outside), found.end());
  if (found.size() > count)
  {
    std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end(), isSurer);
    found.erase(found.begin() + static_cast<std::ptrdiff_t>(count), found.end());
  }
  std::sort(found.begin(), found.end(), isSurer);
}

std::vector<ObjectKeypoint> keypointsOf(const HeadParams& params, const ExtraValues& extras, std::size_t index,
                                        const ImageFrame& frame)
{
  std::vector<ObjectKeypoint> keypoints;
  const auto values = static_cast<std::size_t>(params.keypoint_values);
  for (std::size_t k = 0; k < static_cast<std::size_t>(params.keypoints); ++k)
  {
    const cv::Point2d at = frame.point(extras.at(index, k * values), extras.at(index, k * values + 1));
    const ObjectKeypoint keypoint{static_cast<float>(at.x), static_cast<float>(at.y),
                                  values == 3 ? extras.at(index, k * values + 2) : 1.0F};
    const bool finite = std::isfinite(keypoint.x) && std::isfinite(keypoint.y) && std::isfinite(keypoint.score);
    keypoints.push_back(finite ? keypoint : ObjectKeypoint());
  }
  return keypoints;
}

MaskPrototypes prototypesOf(const HeadParams& params, const HeadOutputs& outputs, const ImageFrame& frame)
{
  const auto any = HeadOutputs::kAny;
  const OutputRows rows = outputs.rows(1, {any, any, any});
  const std::vector<std::int64_t> shape = outputs.lastAxes(1, 3);
  const auto height = static_cast<int>(shape[1]), width = static_cast<int>(shape[2]);
  if (rows.rows == 0 || rows.columns == 0) outputs.refuse(1, "prototypes of at least 1x1 px");
  return {rows.values,
          static_cast<int>(shape[0]),
          height,
          width,
          frame.columns(width, params.input_width),
          frame.rows(height, params.input_height)};
}

/// The pixels that a box touches along one axis.
cv::Range pixelsAlong(double low, double high)
{
  constexpr double kRounding = 1e-3;  // px, by which float32 may put a side beyond the edge of a pixel
  constexpr double kFar = 1e9;        // px, of which differences fit an int
  const double from = std::clamp(low, -kFar, kFar), to = std::clamp(high, -kFar, kFar);
  // What is narrower than that, at the border of an image, is still inside of it.
  const int begin = std::max(std::min(cvFloor(from + kRounding), cvCeil(to) - 1), cvFloor(from));
  return {begin, std::max(cvCeil(to - kRounding), begin + 1)};
}

/// Gives objects their masks, the surest first.
void addMasks(std::vector<FoundObject>& objects, const std::vector<Candidate>& kept, const MaskPrototypes& prototypes,
              const ExtraValues& coefficients)
{
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < objects.size(); ++i)
  {
    const cv::Rect box = pixelsOf(objects[i].box);
    pixels += static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
    if (pixels > HeadDecoder::kMaxMaskPixels) return;
    objects[i].mask = maskOf(prototypes, coefficients, kept[i].index, objects[i].box);
  }
}

}  // namespace

cv::Rect pixelsOf(const CornerBox& box)
{
  const cv::Range x = pixelsAlong(box.x0, box.x1), y = pixelsAlong(box.y0, box.y1);
  return {x.start, y.start, x.size(), y.size()};
}

cv::Point2d FoundObject::center() const
{
  if (outline.empty()) return {(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2};
  cv::Point2d sum;
  for (const cv::Point2f& corner : outline)
    sum += cv::Point2d(corner);
  return sum / static_cast<double>(outline.size());
}

HeadDecoder::HeadDecoder(const HeadParams& params) : params_(params)
{
  validate(params_);
}

std::vector<FoundObject> HeadDecoder::decode(const std::vector<NetworkOutput>& outputs, const InputPlacement& placement,
                                             const cv::Size& image) const
{
  const ImageFrame frame(placement, image);
  const Head& head =
      *std::find_if(std::begin(kHeads), std::end(kHeads), [this](const Head& one) { return params_.head == one.name; });
  const HeadOutputs checked(head.name, outputs);
  Candidates candidates(params_);
  head.find(params_, checked, candidates);
  const bool oriented = params_.task == "oriented";
  const auto limit = static_cast<std::size_t>(params_.max_detections);
  keepSurest(candidates.found, head.suppresses ? limit : kMaxCandidates, frame, oriented);
  const std::vector<Candidate> kept = head.suppresses ? candidates.found : suppress(candidates.found, params_);

  std::vector<FoundObject> objects;
  for (const Candidate& candidate : kept)
  {
    FoundObject& object = objects.emplace_back();
    object.class_id = candidate.class_id;
    object.score = candidate.score;
    object.box = frame.boxOf(candidate, oriented);
    if (oriented)
      for (const cv::Point2d& corner : outlineOf(candidate))
        object.outline.emplace_back(frame.point(corner.x, corner.y));
    if (params_.task == "pose") object.keypoints = keypointsOf(params_, candidates.extras, candidate.index, frame);
  }
  if (params_.task == "segment" && !objects.empty())
    addMasks(objects, kept, prototypesOf(params_, checked, frame), candidates.extras);
  return objects;
}

}  // namespace robot_vision
