#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

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

const std::string kNumbers = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";

/// The text of a calibration with another P and D.
std::string textWith(const std::string& projection, const std::string& distortion)
{
  const std::string square = "{rows: 3, cols: 3, data: " + kNumbers + "}\n";
  return "image_width: 640\nimage_height: 480\ncamera_name: eye\ndistortion_model: plumb_bob\ncamera_matrix: " +
         square + "rectification_matrix: " + square + "projection_matrix: " + projection +
         "\ndistortion_coefficients: " + distortion + "\n";
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

TEST(CalibrationFile, hasMatricesOfTheirSizes)
{
  const std::string projection = "{rows: 3, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}";
  const std::string lens = "{rows: 5, cols: 1, data: [0.1, 0, 0, 0, 0]}", none = "{rows: 1, cols: 0, data: []}";
  std::string camera;
  EXPECT_EQ(parseCalibration(textWith(projection, lens), CalibrationFormat::kYaml, camera).D.size(), 5u);
  EXPECT_EQ(parseCalibration(textWith(projection, none), CalibrationFormat::kYaml, camera).D.size(), 0u);

  const std::string square = "{rows: 3, cols: 3, data: " + kNumbers + "}";
  const std::string is_lens = "distortion_coefficients is ", must_be = ", must be 1x0 to 1x14 with as many";
  const std::string of_no_size[][3] = {
      {square, lens, "projection_matrix is 3x3 with 9 numbers, must be 3x4 with as many"},
      {"{rows: 3, cols: 4, data: [1, 0]}", lens, "projection_matrix is 3x4 with 2 numbers, must be 3x4 with as many"},
      {"{cols: 4, data: []}", lens, ""},
      {projection, "{rows: 1, cols: 500000000, data: [0]}", is_lens + "1x500000000 with 1 numbers" + must_be},
      {projection, "{rows: 65536, cols: 65536, data: []}", is_lens + "65536x65536 with 0 numbers" + must_be},
      {projection, "{rows: 1, cols: 4, data: [0, 0, 0, 0, 0]}", is_lens + "1x4 with 5 numbers" + must_be},
      {projection, "{rows: -1, cols: -1, data: [0]}", is_lens + "-1x-1 with 1 numbers" + must_be},
      {projection, "5", ""}};
  for (const auto& [of_projection, of_lens, reason] : of_no_size)
  {
    try
    {
      parseCalibration(textWith(of_projection, of_lens), CalibrationFormat::kYaml, camera);
      FAIL() << of_projection << of_lens;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_EQ(std::string(e.what()).find("no calibration that can be read: " + reason), 0u) << e.what();
    }
  }
}
