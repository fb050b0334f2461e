#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

#include "ros/images/camera_info.hpp"

using namespace robot_vision;

namespace
{

boost::shared_ptr<sensor_msgs::CameraInfo> ofWholeSensor()
{
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->header.frame_id = "eye";
  info->width = 1280;
  info->height = 960;
  info->distortion_model = "plumb_bob";
  info->D = {0.1, 0.0, 0.0, 0.0, 0.0};
  info->K = {1000.0, 0.0, 640.0, 0.0, 1010.0, 480.0, 0.0, 0.0, 1.0};
  info->P = {900.0, 0.0, 650.0, -90.0, 0.0, 910.0, 490.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

}  // namespace

TEST(CameraInfo, ofAWholeSensorStaysAsItIs)
{
  const auto info = ofWholeSensor();
  EXPECT_EQ(ofImages(info), info);
  info->binning_x = info->binning_y = 1;
  EXPECT_EQ(ofImages(info, {640, 480}), info);
}

TEST(CameraInfo, ofBinnedPixelsIsThatOfTheImage)
{
  const auto info = ofWholeSensor();
  info->binning_x = 2;
  info->binning_y = 4;
  auto expected = *ofWholeSensor();
  expected.width = 640;
  expected.height = 240;
  expected.K = {500.0, 0.0, 320.0, 0.0, 252.5, 120.0, 0.0, 0.0, 1.0};
  expected.P = {450.0, 0.0, 325.0, -45.0, 0.0, 227.5, 122.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  EXPECT_EQ(*ofImages(info), expected);
  EXPECT_EQ(*ofImages(info, {640, 240}), expected);
  EXPECT_EQ(ofImages(info, {1280, 960}), info);  // of a driver that gives the camera_info of its images
  EXPECT_EQ(info->K, ofWholeSensor()->K);
}

TEST(CameraInfo, ofARegionHasItsPrincipalPointThere)
{
  const auto info = ofWholeSensor();
  info->roi.x_offset = 100;
  info->roi.y_offset = 60;
  info->roi.width = 1001;
  info->roi.height = 400;
  info->binning_x = 2;
  auto expected = *ofWholeSensor();
  expected.width = 500;
  expected.height = 400;
  expected.K = {500.0, 0.0, 270.0, 0.0, 1010.0, 420.0, 0.0, 0.0, 1.0};
  expected.P = {450.0, 0.0, 275.0, -45.0, 0.0, 910.0, 430.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  EXPECT_EQ(*ofImages(info), expected);
}
