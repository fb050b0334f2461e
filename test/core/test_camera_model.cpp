#include <gtest/gtest.h>

#include <limits>
#include <opencv2/calib3d.hpp>

#include "refusal.hpp"
#include "robot_vision/camera_model.hpp"

using namespace robot_vision;

namespace
{

CameraModel cameraWith(const std::vector<double>& D)
{
  return {640, 480, {520, 0, 318, 0, 515, 243, 0, 0, 1}, D};
}

std::string refusalOf(const CameraModel& camera)
{
  return refusal([&] { validate(camera); });
}

}  // namespace

TEST(CameraModel, projectsAsOpenCvDoesWithAnyDistortion)
{
  for (const std::vector<double>& D : {std::vector<double>{}, std::vector<double>{-0.25, 0.07, 0.001, -0.002},
                                       std::vector<double>{-0.25, 0.07, 0.001, -0.002, 0.01},
                                       std::vector<double>{0.45, -0.3, 0.001, -0.002, -0.02, 0.8, -0.1, -0.07}})
  {
    const CameraModel camera = cameraWith(D);
    validate(camera);
    std::vector<cv::Point3d> points;
    for (double x = -1.1; x < 1.2; x += 0.2)
      for (double y = -0.9; y < 1.0; y += 0.2)
        points.emplace_back(x, y, 2.0);
    std::vector<cv::Point2d> expected;
    cv::projectPoints(points, cv::Vec3d::all(0), cv::Vec3d::all(0), camera.K, D, expected);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      const cv::Point2d pixel = camera.project(points[i]), ray = camera.ray(pixel);
      EXPECT_LT(cv::norm(pixel - expected[i]), 1e-9) << D.size();
      EXPECT_LT(cv::norm(2.0 * ray - cv::Point2d(points[i].x, points[i].y)), 1e-9) << D.size();
    }
  }
}

TEST(CameraModel, aPixelWithoutARayHasNone)
{
  CameraModel camera = cameraWith({-0.3, 0.0, 0.0, 0.0});
  camera.K = {420, 0, 320, 0, 420, 240, 0, 0, 1};
  // The distortion brings nothing further out than r (1 - 0.3 r^2) at r = 1 / sqrt(0.9).
  const double furthest = 420.0 * 2.0 / 3.0 / std::sqrt(0.9);
  EXPECT_FALSE(std::isnan(camera.ray({320.0 + furthest - 1.0, 240.0}).x));
  EXPECT_TRUE(std::isnan(camera.ray({320.0 + furthest + 1.0, 240.0}).x));
  EXPECT_TRUE(std::isnan(camera.ray({0.0, 0.0}).y));
}

TEST(CameraModel, whatNoCameraHasIsNamed)
{
  EXPECT_EQ(refusalOf(cameraWith({})), "");
  EXPECT_EQ(refusalOf(cameraWith({0.1, 0.2, 0.3})), "D is 3 numbers, must be 0, 4, 5 or 8 of them");
  EXPECT_EQ(refusalOf(cameraWith(std::vector<double>(12))), "D is 12 numbers, must be 0, 4, 5 or 8 of them");
  EXPECT_EQ(refusalOf(cameraWith({0, 0, 0, std::numeric_limits<double>::infinity()})), "D is inf, must be finite");
  CameraModel camera = cameraWith({});
  camera.width = 0;
  EXPECT_EQ(refusalOf(camera), "width is 0, must be at least 1");
  camera = cameraWith({});
  camera.K = cv::Matx33d::zeros();  // of a camera that was never calibrated
  EXPECT_EQ(refusalOf(camera), "K is 0, must be above 0 where it is a focal length");
}
