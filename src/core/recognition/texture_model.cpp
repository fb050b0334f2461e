#include "robot_vision/recognition/texture_model.hpp"

#include <cmath>

#include "robot_vision/common/range.hpp"
#include "robot_vision/features/keypoints.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinLength = 1e-4, kMaxLength = 1000.0;  // m, of an object
constexpr double kMinSize = 1e-6;                         // m, of a keypoint
constexpr int kMaxViews = 1000000;
constexpr double kMaxPlace = 1000.0;         // m, of a coordinate
constexpr double kMaxDirectionError = 0.01;  // of its length

/// The bytes of a descriptor, of SIFT the numbers, by OpenCV's defaults.
int descriptorLength(const std::string& detector)
{
  if (detector == "sift") return 128;
  return detector == "akaze" ? 61 : 32;
}

bool isWithin(const cv::Vec3d& vector, double limit)
{
  return std::abs(vector[0]) <= limit && std::abs(vector[1]) <= limit && std::abs(vector[2]) <= limit;  // nor is NaN
}

void checkPoint(const TexturePoint& point)
{
  require(isWithin(point.position, kMaxPlace), "the position of a keypoint", "not finite or far away",
          "within " + toText(kMaxPlace) + " m");
  require(std::abs(cv::norm(point.direction) - 1.0) <= kMaxDirectionError, "the length of a keypoint's direction",
          cv::norm(point.direction), "1");
  requireRange("the size of a keypoint", point.size, kMinSize, kMaxLength);
  requireRange("the number of views of a keypoint", point.views, 1, kMaxViews);
}

}  // namespace

void validate(const TextureParams& params)
{
  checkFields(params);
  KeypointParams keypoints;
  keypoints.detector = params.detector;
  validate(keypoints);
}

void validate(const TextureModel& model)
{
  validate(model.params);
  require(isWithin(model.extent.center, kMaxPlace) && isWithin(model.extent.size, kMaxPlace), "the extent of a model",
          "not finite or too large", "within " + toText(kMaxPlace) + " m");
  for (const double length : {model.extent.diameter, model.extent.radius})
    requireRange("the diameter or radius of a model", length, kMinLength, kMaxLength);
  requireRange("the number of views of a model", model.views, 0, kMaxViews);
  require(model.points.size() <= kMaxTexturePoints, "the number of keypoints of a model",
          static_cast<double>(model.points.size()), "at most " + std::to_string(kMaxTexturePoints));
  const cv::Mat& descriptors = model.descriptors;
  const int type = model.params.detector == "sift" ? CV_32FC1 : CV_8UC1;
  require(static_cast<std::size_t>(descriptors.rows) == model.points.size(), "the number of descriptors",
          descriptors.rows, std::to_string(model.points.size()) + " as of keypoints");
  const int columns = descriptorLength(model.params.detector);
  require(model.points.empty() || (descriptors.type() == type && descriptors.cols == columns),
          "the type or length of the descriptors", "another one", "that of " + model.params.detector);
  require(descriptors.type() != CV_32FC1 || cv::checkRange(descriptors), "a descriptor", "not finite", "numbers");
  for (const TexturePoint& point : model.points)
    checkPoint(point);
}

}  // namespace robot_vision
