#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// How a depth camera measures, which decides what is wrong with its images.
enum class DepthSensor
{
  kExact,
  kKinect,
  kStereo,
  kTof,
};

/// The sensor of a name: none (kExact), kinect, stereo or tof. Throws std::invalid_argument for any other name.
DepthSensor depthSensor(const std::string& name);

/// Makes of exact depth what a sensor would measure. With f for the depth camera's focal length in px, and z in m:
///
/// - none measures z as it is.
/// - kinect measures the disparity to a projector 75 mm to its right, in steps of 1/8 px, from 0.5 to 5 m. The standard
///   deviation of z is 0.0012 + 0.0019 (z - 0.4)^2 m. It has nothing where the projector's light does not fall.
/// - stereo measures the disparity to a second camera 50 mm to its right, in steps of 1/32 px, from 0.3 to 10 m. The
///   standard deviation is that of 0.1 px: 2 z^2 / f m. The errors of pixels that are near each other are alike, as of
///   a matcher that compares blocks of 5 x 5 px: of two that are dx and dy px apart the correlation is
///   (1 - dx / 5) (1 - dy / 5), 0 from 5 px on. It has nothing where the second camera does not see.
/// - tof measures the time of flight, from 0.5 to 4.5 m. The standard deviation is 0.001 + 0.064 z^2 / brightness m,
///   where a brightness below 8 counts as 8.
///
/// The steps of a disparity are a part of these deviations, which are never less than that of the steps alone. Half of
/// the pixels beside an edge are flying with stereo and tof: they mix the disparities, or z, of its two sides. All but
/// none lose pixels at random:
///
/// - of surfaces at a grazing angle none up to 75 degrees between normal and ray, all from 87 degrees on, and a share
///   that is linear in the cosine between;
/// - of dark surfaces all of brightness 0, none from 40 on, and a share that is linear in the brightness between.
///
/// Sources: Nguyen, Izadi and Lovell, Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking, 3DIMPVT
/// 2012; Khoshelham and Elberink, Accuracy and Resolution of Kinect Depth Data, Sensors 2012; Lange and Seitz,
/// Solid-State Time-of-Flight Range Camera, J. Quantum Electronics 2001.
///
/// The errors of the other sensors are independent from pixel to pixel. The noise of a frame depends on the seed and
/// its number only. Threads may share one object.
class DepthNoise
{
public:
  /// Throws std::invalid_argument if the camera is not valid.
  DepthNoise(DepthSensor sensor, const CameraModel& depth_camera, std::uint64_t seed);
  ~DepthNoise();

  /// `exact` is CV_32FC1 of the camera's size, z in m; what is not finite and above 0 is taken for nothing.
  /// `brightness` is CV_8UC1, what the same pixels reflect, or empty: then everything is as bright as 128. `noisy`
  /// becomes CV_32FC1, z in m, NaN where the sensor has nothing, and may be `exact`. Throws std::invalid_argument for
  /// an image of another size or type.
  void apply(std::int64_t frame, const cv::Mat& exact, const cv::Mat& brightness, cv::Mat& noisy) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
