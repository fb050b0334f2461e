#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// How a Kinect (of the first kind) measures depth: by how far the pattern of its projector is shifted from where it is
/// on a plane of known distance. Each Kinect tells its own numbers, which are near these.
struct KinectOptics
{
  double projector_baseline = 0.075;   // m, from the projector to the infrared camera
  double reference_distance = 1.2;     // m, of that plane
  double reference_pixel = 0.1042e-2;  // m, that a pixel of 1280 in a row sees on the plane
  double zero_shift = 200.0;           // px of 1280 in a row, added to all shifts so that none is negative

  /// Whether there can be such a Kinect.
  bool valid() const;

  /// px, of images of 640x480.
  double focalLength() const { return reference_distance / (2.0 * reference_pixel); }
};

constexpr int kKinectDepthWidth = 640;   // px
constexpr int kKinectDepthHeight = 480;  // px
constexpr std::uint16_t kNoKinectShift = 2047;
constexpr double kMaxKinectDepth = 10.0;  // m, beyond which it measures nothing that is true

/// The depths (mm; 0: none) of all shifts of 11 bits that a Kinect may send, in quarters of a pixel of 1280 in a row.
using KinectDepths = std::array<std::uint16_t, 2048>;
KinectDepths kinectDepths(const KinectOptics& optics);

/// Writes the depths of an image of shifts (CV_16UC1) as 16UC1; numbers of more than 11 bits are none. `depth` is
/// reused if it fits.
void toKinectDepth(const cv::Mat& shifts, const KinectDepths& depths, cv::Mat& depth);

/// The color camera and the depth camera of a Kinect that nobody has calibrated, by freenect_camera's defaults: square
/// pixels, no distortion, and the axis in the middle, which the window of the correlation moves by (5, 4) px in depth
/// images (https://wiki.ros.org/kinect_calibration/technical). The focal length is 525 px, for 640x480, in color.
CameraModel kinectColorCamera(cv::Size size);
CameraModel kinectDepthCamera(const KinectOptics& optics);

/// The depth camera's optical frame in that of the color camera: 25 mm to its left, as of freenect_launch and
/// openni_launch (kinect_frames.launch).
cv::Affine3d kinectDepthPose();

/// Where both are in the housing, likewise.
Housing kinectHousing();

}  // namespace robot_vision
