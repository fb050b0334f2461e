#include "robot_vision/stereo/stereo_camera.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSide = 32767;          // px, what the fixed-point maps of cv::remap reach
constexpr double kMaxDifference = 1e-3;  // px, of what both cameras have in common: files round it
constexpr double kMinBaseline = 1e-4;    // m
constexpr double kMaxBaseline = 1e4;     // m
const std::string kOfAPair = "that of two cameras calibrated together";

cv::Size sizeOf(const RectifiedCamera& camera)
{
  return {camera.model.width, camera.model.height};
}

/// validate() whose error says which camera it is.
void validateNamed(const RectifiedCamera& camera, const std::string& name)
{
  try
  {
    validate(camera);
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument(name + " camera: " + e.what());
  }
}

void requireEqual(const std::string& name, double left, double right)
{
  require(std::abs(left - right) <= kMaxDifference, name + " of the right camera", right,
          toText(left) + " as of the left one; the cameras were not calibrated together");
}

}  // namespace

bool operator==(const RectifiedCamera& a, const RectifiedCamera& b)
{
  return a.model == b.model && a.R == b.R && a.P == b.P;
}

CameraModel rectifiedModel(const RectifiedCamera& camera)
{
  CameraModel model;
  model.width = camera.model.width;
  model.height = camera.model.height;
  model.K = camera.P.get_minor<3, 3>(0, 0);
  return model;
}

void validate(const RectifiedCamera& camera)
{
  validate(camera.model);
  requireRange("width", camera.model.width, 1, kMaxSide);
  requireRange("height", camera.model.height, 1, kMaxSide);
  require(camera.model.K(0, 1) == 0.0, "K[1]", camera.model.K(0, 1), "0");
  require(camera.R != cv::Matx33d::zeros(), "R", "0 everywhere", kOfAPair);
  require(camera.P != cv::Matx34d::zeros(), "P", "0 everywhere", kOfAPair);
  validateRectification(camera.R, camera.P);
  require(camera.P(0, 1) == 0.0, "P[1]", camera.P(0, 1), "0");
  require(camera.P(1, 0) == 0.0, "P[4]", camera.P(1, 0), "0");
  require(camera.P(1, 3) == 0.0, "P[7]", camera.P(1, 3), "0, for cameras beside each other");
}

void validate(const StereoCamera& pair)
{
  validateNamed(pair.left, "left");
  validateNamed(pair.right, "right");
  const cv::Matx34d &left = pair.left.P, &right = pair.right.P;
  require(sizeOf(pair.left) == sizeOf(pair.right), "the size of the right camera", toText(sizeOf(pair.right)),
          toText(sizeOf(pair.left)) + " as of the left one");
  // First, as nothing else fits either if each camera was calibrated by itself.
  require(left(0, 3) == 0.0, "P[3] of the left camera", left(0, 3), "0, as distances are measured from it");
  require(right(0, 3) < 0.0, "P[3] of the right camera", right(0, 3),
          "below 0, -P[0] times the baseline; left and right are swapped, or not calibrated together");
  requireEqual("P[0]", left(0, 0), right(0, 0));
  requireEqual("P[5]", left(1, 1), right(1, 1));
  requireEqual("P[6]", left(1, 2), right(1, 2));
  requireRange("the baseline in m, -P[3] / P[0] of the right camera,", -right(0, 3) / right(0, 0), kMinBaseline,
               kMaxBaseline);
}

StereoGeometry geometryOf(const StereoCamera& pair)
{
  validate(pair);
  const cv::Matx34d &left = pair.left.P, &right = pair.right.P;
  return {left(0, 0), left(1, 1), left(0, 2), left(1, 2), left(0, 2) - right(0, 2), -right(0, 3) / right(0, 0)};
}

}  // namespace robot_vision
