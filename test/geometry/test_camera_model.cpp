#include <gtest/gtest.h>

#include <limits>
#include <opencv2/calib3d.hpp>

#include "robot_vision/geometry/camera_model.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

CameraModel cameraWith(const std::vector<double>& D, const std::string& distortion_model = "plumb_bob")
{
  return {640, 480, {520, 0, 318, 0, 515, 243, 0, 0, 1}, D, distortion_model};
}

const std::vector<double> kFisheye = {0.05, -0.02, 0.006, -0.001};

std::vector<cv::Point3d> grid(double reach)
{
  std::vector<cv::Point3d> points;
  for (double x = -1.1; x < 1.2; x += 0.2)
    for (double y = -0.9; y < 1.0; y += 0.2)
      points.emplace_back(reach * x, reach * y, 2.0);
  return points;
}

/// Expects that project() gives the expected pixels, and ray() the points again.
void expectProjections(const CameraModel& camera, const std::vector<cv::Point3d>& points,
                       const std::vector<cv::Point2d>& expected)
{
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const cv::Point2d pixel = camera.project(points[i]), ray = camera.ray(pixel);
    EXPECT_LT(cv::norm(pixel - expected[i]), 1e-9) << camera.D.size();
    EXPECT_LT(cv::norm(2.0 * ray - cv::Point2d(points[i].x, points[i].y)), 1e-9) << camera.D.size();
  }
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
    const std::vector<cv::Point3d> points = grid(1.0);
    std::vector<cv::Point2d> expected;
    cv::projectPoints(points, cv::Vec3d::all(0), cv::Vec3d::all(0), camera.K, D, expected);
    expectProjections(camera, points, expected);
  }
}

TEST(CameraModel, projectsAsOpenCvDoesWithAFisheye)
{
  for (const std::string& name : {"equidistant", "fisheye"})
  {
    CameraModel camera = cameraWith(kFisheye, name);
    camera.K(0, 1) = 0.52;  // skew, which cv::fisheye takes as a fraction of the focal length
    validate(camera);
    const std::vector<cv::Point3d> points = grid(4.0);  // 70 degrees from the axis
    std::vector<cv::Point2d> expected;
    cv::fisheye::projectPoints(points, expected, cv::Affine3d::Identity(), camera.K, kFisheye, 0.001);
    expectProjections(camera, points, expected);
    EXPECT_LT(cv::norm(camera.ray(camera.project({0.0, 0.0, 1.0}))), 1e-15);
  }
}

TEST(CameraModel, jacobianEqualsNumericDerivatives)
{
  const double step = 1e-6;
  for (const CameraModel& camera :
       {cameraWith({0.45, -0.3, 0.001, -0.002, -0.02, 0.8, -0.1, -0.07}), cameraWith(kFisheye, "equidistant")})
    for (const cv::Point3d& point : grid(1.0))
    {
      const cv::Matx23d jacobian = camera.projection(point).jacobian;
      for (int axis = 0; axis < 3; ++axis)
      {
        cv::Vec3d there(point), back(point);
        there[axis] += step;
        back[axis] -= step;
        const cv::Point2d change = (camera.project(there) - camera.project(back)) / (2.0 * step);
        EXPECT_LT(cv::norm(change - cv::Point2d(jacobian(0, axis), jacobian(1, axis))), 1e-5);
      }
    }
}

TEST(CameraModel, givesNanForPixelsThatNoRayReaches)
{
  CameraModel camera = cameraWith({-0.3, 0.0, 0.0, 0.0});
  camera.K = {420, 0, 320, 0, 420, 240, 0, 0, 1};
  // The distorted radius r (1 - 0.3 r^2) has its maximum at r = 1 / sqrt(0.9).
  const double furthest = 420.0 * 2.0 / 3.0 / std::sqrt(0.9);
  EXPECT_FALSE(std::isnan(camera.ray({320.0 + furthest - 1.0, 240.0}).x));
  EXPECT_TRUE(std::isnan(camera.ray({320.0 + furthest + 1.0, 240.0}).x));
  EXPECT_TRUE(std::isnan(camera.ray({0.0, 0.0}).y));
  // Beyond that the distortion shows points on the other side: they are no rays, nor a guess for those beside them.
  camera.K = {300, 0, 320, 0, 300, 240, 0, 0, 1};
  const RayTable table = rayTable(camera);
  int beyond = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
    {
      const bool reached = std::hypot((x - 320.0) / 300.0, (y - 240.0) / 300.0) < 2.0 / 3.0 / std::sqrt(0.9);
      const cv::Point2d ray(table.x.at<float>(y, x), table.y.at<float>(y, x)), alone = camera.ray(cv::Point2d(x, y));
      ASSERT_EQ(std::isnan(ray.x), !reached) << x << " " << y;
      ASSERT_EQ(std::isnan(alone.x), !reached) << x << " " << y;
      beyond += reached ? 0 : 1;
      if (reached)
      {
        ASSERT_LT(cv::norm(ray - alone), 1e-6) << x << " " << y;
      }
    }
  EXPECT_GT(beyond, 1000);
  // What an ideal fisheye sees at 90 degrees or more is not in front of the camera.
  camera = cameraWith({0.0, 0.0, 0.0, 0.0}, "equidistant");
  EXPECT_FALSE(std::isnan(camera.ray({318.0 + 520.0 * 1.55, 243.0}).x));
  EXPECT_TRUE(std::isnan(camera.ray({318.0 + 520.0 * 1.58, 243.0}).x));
  for (const double z : {0.0, -1.0})
    EXPECT_TRUE(std::isnan(camera.project({0.1, 0.1, z}).x));
}

TEST(CameraModel, raysAreOfTheFirstBranchOfADistortion)
{
  // What these lenses show grows up to the radius `turn`, falls, and grows again: beyond `turn` in the image is no ray.
  struct Lens
  {
    double focal_length;
    std::vector<double> D;
    std::string model;
  };
  for (const Lens& lens : {Lens{330, {0.05, -0.2, 0, 0, 0.04}, "plumb_bob"}, Lens{500, {-0.5, 0.1, 0, 0}, "plumb_bob"},
                           Lens{360, {0.1, -0.3, 0, 0, 0.05}, "plumb_bob"},
                           Lens{500, {-0.5, 0.1, 0, 0, 0, 0.02, 0, 0}, "rational_polynomial"},
                           Lens{400, {-0.6, 0.14, 0.01, 0}, "equidistant"}})
  {
    CameraModel camera = cameraWith(lens.D, lens.model);
    camera.K = {lens.focal_length, 0, 320, 0, lens.focal_length, 240, 0, 0, 1};
    const auto shown = [&camera, &lens](double radius) {
      return (camera.project({radius, 0.0, 1.0}).x - 320.0) / lens.focal_length;
    };
    double turn = 0.0;
    while (shown(turn + 1e-4) > shown(turn))
      turn += 1e-4;
    ASSERT_GT(shown(20.0), shown(turn)) << "there must be a second branch";
    const RayTable table = rayTable(camera);
    int beyond = 0;
    for (int y = 0; y < camera.height; y += 3)
      for (int x = 0; x < camera.width; x += 3)
      {
        const cv::Point2d at((x - 320.0) / lens.focal_length, (y - 240.0) / lens.focal_length);
        const cv::Point2d ray(table.x.at<float>(y, x), table.y.at<float>(y, x)), alone = camera.ray(cv::Point2d(x, y));
        const double seen = cv::norm(at), radius = cv::norm(ray);
        if (std::abs(seen - shown(turn)) < 1e-5) continue;
        ASSERT_EQ(std::isnan(alone.x), seen > shown(turn)) << x << " " << y << " " << lens.D[0];
        ASSERT_EQ(std::isnan(ray.x), seen > shown(turn)) << x << " " << y << " " << lens.D[0];
        beyond += std::isnan(ray.x) ? 1 : 0;
        if (std::isnan(ray.x)) continue;
        ASSERT_LT(cv::norm(ray - alone), 1e-4 * (1.0 + radius)) << x << " " << y;
        ASSERT_LT(radius, turn + 1e-4);
        ASSERT_NEAR(shown(radius), seen, 1e-6) << x << " " << y;
        ASSERT_GE(ray.dot(at), 0.0);
      }
    EXPECT_GT(beyond, 20) << lens.D[0];
  }
}

TEST(CameraModel, namesWhatIsWrongWithARectification)
{
  const cv::Matx33d R = cv::Matx33d::eye();
  const cv::Matx34d P(520, 0, 318, -60, 0, 515, 243, 0, 0, 0, 1, 0);
  const auto of = [](const cv::Matx33d& R, const cv::Matx34d& P)
  { return refusal([&] { validateRectification(R, P); }); };
  EXPECT_EQ(of(R, P), "");
  EXPECT_EQ(of(cv::Matx33d::zeros(), cv::Matx34d::zeros()), "");
  EXPECT_EQ(of({0, -1, 0, 1, 0, 0, 0, 0, 1}, P), "");
  EXPECT_EQ(of({1, 0, 0, 0, 1, 0, 0, 0, -1}, P), "R is no rotation, must be a rotation matrix");
  EXPECT_EQ(of(R * 1.1, P), "R is no rotation, must be a rotation matrix");
  EXPECT_EQ(of({std::nan(""), 0, 0, 0, 1, 0, 0, 0, 1}, P), "R is nan, must be finite");
  EXPECT_EQ(of(R, {6000, 0, 4000, -1200000, 0, 6000, 3000, 0, 0, 0, 1, 0}), "");  // a baseline in mm
  cv::Matx34d wrong = P;
  wrong(0, 0) = 0.0;
  EXPECT_EQ(of(R, wrong), "P is 0, must be above 0 where it is a focal length");
  wrong = P;
  wrong(1, 1) = -1.0;
  EXPECT_EQ(of(R, wrong), "P is -1, must be above 0 where it is a focal length");
  wrong = P;
  wrong(2, 2) = 2.0;
  EXPECT_EQ(of(R, wrong), "the last row of P is 0, 0, 2, 0, must be 0, 0, 1, 0");
  wrong(1, 2) = 1e300;
  EXPECT_EQ(of(R, wrong), "P is 1e+300, must be from -1e+06 to 1e+06");
}

TEST(CameraModel, namesWhatIsWrongWithACamera)
{
  EXPECT_EQ(refusalOf(cameraWith({})), "");
  const std::string plumb_bob = "must be 0, 4, 5 or 8 of them (distortion_model plumb_bob)";
  EXPECT_EQ(refusalOf(cameraWith({0.1, 0.2, 0.3})), "D is 3 numbers, " + plumb_bob);
  EXPECT_EQ(refusalOf(cameraWith(std::vector<double>(12))), "D is 12 numbers, " + plumb_bob);
  EXPECT_EQ(refusalOf(cameraWith(std::vector<double>(5), "equidistant")),
            "D is 5 numbers, must be 4 of them (distortion_model equidistant)");
  const std::string models = "must be plumb_bob, rational_polynomial, equidistant or fisheye";
  EXPECT_EQ(refusalOf(cameraWith({}, "fish")), "distortion_model is 'fish', " + models);
  EXPECT_EQ(refusalOf(cameraWith({}, "")), "");
  EXPECT_EQ(refusalOf(cameraWith({0.1, 0.0, 0.0, 0.0}, "")), "distortion_model is '', " + models);
  EXPECT_EQ(refusalOf(cameraWith({0, 0, 0, std::numeric_limits<double>::infinity()})), "D is inf, must be finite");
  CameraModel camera = cameraWith({});
  camera.width = 0;
  EXPECT_EQ(refusalOf(camera), "width is 0, must be at least 1");
  camera.width = 100000;
  EXPECT_EQ(refusalOf(camera), "width is 100000, must be from 1 to 65536");
  const auto with = [](int row, int column, double value)
  {
    CameraModel changed = cameraWith({});
    changed.K(row, column) = value;
    EXPECT_TRUE(isCalibrated(changed.K));
    return refusalOf(changed);
  };
  EXPECT_EQ(with(0, 0, -5), "K is -5, must be above 0 where it is a focal length");
  EXPECT_EQ(with(1, 1, -515), "K is -515, must be above 0 where it is a focal length");
  EXPECT_EQ(with(0, 2, std::nan("")), "K is nan, must be finite");
  EXPECT_EQ(with(0, 1, 1e300), "K is 1e+300, must be from -1e+06 to 1e+06");
  EXPECT_EQ(with(1, 0, 1.0), "K[3] is 1, must be 0");
  EXPECT_EQ(with(2, 2, -1.0), "the last row of K is 0, 0, -1, must be 0, 0, 1");
  EXPECT_EQ(refusalOf(cameraWith({1e7, 0, 0, 0})), "D is 1e+07, must be from -1e+06 to 1e+06");
  const std::string escape = refusalOf(cameraWith({}, "\x1b[2J\n"));
  EXPECT_EQ(escape, "distortion_model is '\\x1b[2J\\x0a', " + models);
  camera = cameraWith({});
  camera.K = cv::Matx33d::zeros();
  EXPECT_FALSE(isCalibrated(camera.K));
  EXPECT_EQ(refusalOf(camera), "K is 0 everywhere, must be that of a calibrated camera");
}
