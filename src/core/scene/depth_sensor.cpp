#include "depth_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

DepthSensor depthSensor(const std::string& name)
{
  checkField("sensor", name, OneOf{"none, kinect, stereo or tof", "'"});
  if (name == "none") return DepthSensor::kExact;
  if (name == "kinect") return DepthSensor::kKinect;
  return name == "stereo" ? DepthSensor::kStereo : DepthSensor::kTof;
}

namespace scene
{

namespace
{

const double kGrazingCosine = 0.0523;  // of 87 degrees; all is lost where the cosine is smaller
const double kDark = 40.0;             // brightness below which something is lost

double kinectSigma(double z, double /*disparity*/, double /*brightness*/)
{
  return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
}

double stereoSigma(double z, double disparity, double /*brightness*/)
{
  const double matching_error = 0.1;  // px
  return matching_error * z * z / disparity;
}

// The error of a phase is inversely proportional to the light that comes back.
double tofSigma(double z, double /*disparity*/, double brightness)
{
  const double darkest = 8.0;
  return 0.001 + 0.064 * z * z / std::max(brightness, darkest);
}

const DepthSensorModel kKinectModel = {0.075, 1.0 / 8.0, 0.5, 5.0, 1, 0.0, kinectSigma};
const DepthSensorModel kStereoModel = {0.05, 1.0 / 32.0, 0.3, 10.0, 5, 0.5, stereoSigma};
const DepthSensorModel kTofModel = {0.0, 0.0, 0.5, 4.5, 1, 0.5, tofSigma};

}  // namespace

const DepthSensorModel& sensorModel(DepthSensor sensor)
{
  if (sensor == DepthSensor::kKinect) return kKinectModel;
  return sensor == DepthSensor::kStereo ? kStereoModel : kTofModel;
}

double lostAtAngle(double cosine)
{
  return std::clamp((kSteepCosine - cosine) / (kSteepCosine - kGrazingCosine), 0.0, 1.0);
}

double lostAtBrightness(double brightness)
{
  return std::clamp(1.0 - brightness / kDark, 0.0, 1.0);
}

}  // namespace scene

}  // namespace robot_vision
