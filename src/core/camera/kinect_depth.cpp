#include "kinect_depth.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr double kStepsPerPixel = 4.0;  // of a shift
constexpr double kShiftOffset = 0.375;  // px of 1280 in a row, between a shift and what it is a number of

constexpr double kColorFocalLength = 525.0;  // px, of 640 in a row
const cv::Point2d kCorrelationOffset(5.0, 4.0);

constexpr double kColorOffset = -0.045;  // m, to the left of the middle of the housing
constexpr double kDepthOffset = -0.02;

bool isPositive(double value)
{
  return std::isfinite(value) && value > 0.0;
}

/// A pinhole camera whose axis is in the middle of the image, as if those of 5:4 had the rows of 4:3 ones and some more
/// below.
CameraModel centeredCamera(cv::Size size, double focal_length)
{
  CameraModel camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.K = {focal_length, 0.0, size.width / 2.0 - 0.5, 0.0, focal_length, size.width * 3.0 / 8.0 - 0.5, 0.0,
              0.0,          1.0};
  camera.D.assign(5, 0.0);
  return camera;
}

}  // namespace

bool KinectOptics::valid() const
{
  return isPositive(projector_baseline) && isPositive(reference_distance) && isPositive(reference_pixel) &&
         std::isfinite(zero_shift);
}

/// What is nearer than the plane is shifted to one side, what is farther to the other: a shift by s on the plane
/// belongs to the depth at which the rays of camera and projector, which are a baseline b apart, meet: z = z0 b / (b -
/// s).
KinectDepths kinectDepths(const KinectOptics& optics)
{
  KinectDepths depths{};
  for (int shift = 0; shift < kNoKinectShift; ++shift)
  {
    const double pixels = shift / kStepsPerPixel - optics.zero_shift - kShiftOffset;
    const double left = optics.projector_baseline - pixels * optics.reference_pixel;
    const double depth = optics.reference_distance * optics.projector_baseline / left;
    if (left > 0.0 && depth < kMaxKinectDepth)
      depths[static_cast<std::size_t>(shift)] = static_cast<std::uint16_t>(std::lround(1000.0 * depth));
  }
  return depths;
}

void toKinectDepth(const cv::Mat& shifts, const KinectDepths& depths, cv::Mat& depth)
{
  CV_Assert(shifts.type() == CV_16UC1);
  depth.create(shifts.size(), CV_16UC1);
  for (int y = 0; y < shifts.rows; ++y)
  {
    const auto* const from = shifts.ptr<std::uint16_t>(y);
    std::transform(from, from + shifts.cols, depth.ptr<std::uint16_t>(y),
                   [&depths](std::uint16_t shift) { return depths[std::min(shift, kNoKinectShift)]; });
  }
}

CameraModel kinectColorCamera(cv::Size size)
{
  return centeredCamera(size, kColorFocalLength * size.width / 640.0);
}

CameraModel kinectDepthCamera(const KinectOptics& optics)
{
  CameraModel camera = centeredCamera({kKinectDepthWidth, kKinectDepthHeight}, optics.focalLength());
  camera.K(0, 2) -= kCorrelationOffset.x;
  camera.K(1, 2) -= kCorrelationOffset.y;
  return camera;
}

cv::Affine3d kinectDepthPose()
{
  return cv::Affine3d().translate({kColorOffset - kDepthOffset, 0.0, 0.0});
}

Housing kinectHousing()
{
  // The optical frame's z, x and y axes are the housing's x, -y and -z axes.
  const cv::Matx33d optical(0, 0, 1, -1, 0, 0, 0, -1, 0);
  return {cv::Affine3d(optical, cv::Vec3d(0.0, kColorOffset, 0.0))};
}

}  // namespace robot_vision
