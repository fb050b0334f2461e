#include <gtest/gtest.h>

#include "ros/camera/calibration_file.hpp"

using namespace robot_vision;

namespace
{

sensor_msgs::CameraInfo calibrated()
{
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D = {0.1, -0.2, 0.001, -0.002, 0.05};
  info.K = {500.25, 0.0, 320.0, 0.0, 501.5, 240.0, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {500.25, 0.0, 320.0, 0.0, 0.0, 501.5, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

}  // namespace

TEST(CalibrationFile, givesBackWhatWasWritten)
{
  std::string camera;
  const std::string text = calibrationText(calibrated(), CalibrationFormat::kYaml, "eye");
  EXPECT_EQ(parseCalibration(text, CalibrationFormat::kYaml, camera), calibrated());
  EXPECT_EQ(camera, "eye");
}

TEST(CalibrationFile, isNotWrittenIfItCannotBeReadBack)
{
  const std::string text = calibrationText(calibrated(), CalibrationFormat::kIni, "eye");
  std::string camera;
  if (!text.empty()) EXPECT_EQ(parseCalibration(text, CalibrationFormat::kIni, camera).width, 640u);
  sensor_msgs::CameraInfo fisheye = calibrated();
  fisheye.distortion_model = "equidistant";
  fisheye.D.resize(4);
  EXPECT_EQ(calibrationText(fisheye, CalibrationFormat::kIni, "eye"), "");
}
