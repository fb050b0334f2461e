#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/ball/ball.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const double kDiameter = 0.2;

CameraModel wideCamera(const std::vector<double>& D = {-0.25, 0.07, 0.001, -0.002, 0.0})
{
  return {640, 480, {420, 0, 322, 0, 415, 236, 0, 0, 1}, D};
}

/// A mask of the ball: 255 where the ray through a pixel's centre meets it.
cv::Mat1b seen(const CameraModel& camera, const cv::Point3d& ball)
{
  cv::Mat1b mask(camera.height, camera.width);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
    {
      const cv::Point2d ray = camera.ray(cv::Point2d(x, y));
      const cv::Point3d sight(ray.x, ray.y, 1.0);
      const double miss = cv::norm(sight.cross(ball)) / cv::norm(sight);
      mask(y, x) = miss < kDiameter / 2.0 ? 255 : 0;
    }
  return mask;
}

std::vector<cv::Point> outlineOf(const cv::Mat& mask, int approximation = cv::CHAIN_APPROX_NONE)
{
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, approximation);
  return *std::max_element(outlines.begin(), outlines.end(),
                           [](const auto& a, const auto& b) { return a.size() < b.size(); });
}

/// The relative error of the position, infinite if none is found.
double errorOf(const CameraModel& camera, const std::vector<cv::Point>& outline, const cv::Point3d& truth)
{
  const std::optional<BallPosition> found = ballPosition(camera, outline, kDiameter);
  if (!found) return std::numeric_limits<double>::infinity();
  EXPECT_LT(cv::norm(found->center - camera.project(found->position)), 1e-9);
  return cv::norm(found->position - truth) / cv::norm(truth);
}

}  // namespace

TEST(BallPosition, isThatOfTheTrueBall)
{
  for (const std::vector<double>& D : {std::vector<double>{}, std::vector<double>{-0.25, 0.07, 0.001, -0.002, 0.0},
                                       std::vector<double>{0.45, -0.3, 0.001, -0.002, -0.02, 0.8, -0.1, -0.07}})
    for (const cv::Point3d& ball : {cv::Point3d(0, 0, 0.5), cv::Point3d(0.4, -0.25, 0.8), cv::Point3d(-0.6, 0.4, 1.1),
                                    cv::Point3d(0.3, 0.6, 1.5), cv::Point3d(-1.1, -0.7, 2.0), cv::Point3d(1, 1, 3)})
    {
      const CameraModel camera = wideCamera(D);
      const std::vector<cv::Point> outline = outlineOf(seen(camera, ball));
      const std::optional<BallPosition> found = ballPosition(camera, outline, kDiameter);
      ASSERT_TRUE(found) << ball;
      EXPECT_LT(cv::norm(found->position - ball), 0.006 * cv::norm(ball)) << ball;
      EXPECT_LT(cv::norm(found->center - camera.project(ball)), 0.15) << ball;
    }
}

TEST(BallPosition, isNotBiasedByTheEllipseOfABallOffTheAxis)
{
  const CameraModel camera = wideCamera({});
  const cv::Point3d ball(0.3, 0.16, 0.6);
  const cv::Mat1b mask = seen(camera, ball);
  const cv::Moments m = cv::moments(mask, true);
  const cv::Point2d truth = camera.project(ball);
  EXPECT_GT(cv::norm(cv::Point2d(m.m10 / m.m00, m.m01 / m.m00) - truth), 3.0);
  const std::optional<BallPosition> found = ballPosition(camera, outlineOf(mask), kDiameter);
  ASSERT_TRUE(found);
  EXPECT_LT(cv::norm(found->center - truth), 0.15);
}

TEST(BallPosition, isTheSameForACompressedOutline)
{
  const CameraModel camera = wideCamera();
  const cv::Mat1b mask = seen(camera, {0.2, 0.1, 0.9});
  const std::vector<cv::Point> whole = outlineOf(mask), corners = outlineOf(mask, cv::CHAIN_APPROX_SIMPLE);
  ASSERT_LT(corners.size(), whole.size());
  const std::optional<BallPosition> of_corners = ballPosition(camera, corners, kDiameter);
  const std::optional<BallPosition> of_all = ballPosition(camera, whole, kDiameter);
  ASSERT_TRUE(of_corners && of_all);
  EXPECT_EQ(of_corners->position, of_all->position);
}

TEST(BallPosition, isFoundIfHalfOfTheBallIsHidden)
{
  const CameraModel camera = wideCamera();
  const cv::Point3d ball(0.1, -0.1, 0.8);
  const cv::Point middle = camera.project(ball);
  const cv::Mat1b mask = seen(camera, ball);
  for (const cv::Rect& cover :
       {cv::Rect(0, 0, middle.x, 480), cv::Rect(middle.x, 0, 640 - middle.x, 480), cv::Rect(0, 0, 640, middle.y),
        cv::Rect(0, middle.y, 640, 480 - middle.y), cv::Rect(0, 0, middle.x, middle.y)})
  {
    cv::Mat1b half = mask.clone();
    half(cover) = 0;
    EXPECT_LT(errorOf(camera, outlineOf(half), ball), 0.02) << cover;
  }
  cv::Mat1b with_more = mask.clone();  // something of the same colour next to it
  with_more(cv::Rect(middle.x - 10, 0, 20, middle.y)) = 255;
  EXPECT_LT(errorOf(camera, outlineOf(with_more), ball), 0.01);
}

TEST(BallPosition, isFoundIfHalfOfASmallBallIsHidden)
{
  const CameraModel camera = wideCamera();
  for (const auto& [radius, error] : {std::pair(20.0, 0.02), std::pair(8.0, 0.25)})
  {
    const cv::Point3d ball(0.05, -0.03, kDiameter / 2.0 * camera.K(0, 0) / radius);
    cv::Mat1b half = seen(camera, ball);
    half.colRange(cvRound(camera.project(ball).x), 640) = 0;
    EXPECT_LT(errorOf(camera, outlineOf(half), ball), error) << radius;
  }
}

TEST(BallPosition, isNotFoundForRectangles)
{
  const CameraModel camera = wideCamera();
  for (const cv::Size& size :
       {cv::Size(300, 2), cv::Size(200, 6), cv::Size(400, 300), cv::Size(40, 40), cv::Size(60, 60), cv::Size(30, 90)})
  {
    cv::Mat1b mask(480, 640, uchar{0});
    mask(cv::Rect({100, 80}, size)) = 255;
    EXPECT_FALSE(ballPosition(camera, outlineOf(mask), kDiameter)) << size;
  }
}

TEST(BallPosition, isFoundIfTheBorderOfTheImageCutsTheBall)
{
  const CameraModel camera = wideCamera({});
  for (const double x : {-0.77, 0.76})
  {
    const cv::Point3d ball(x, 0.1, 0.9);
    const double center = camera.project(ball).x;
    ASSERT_TRUE(center < -30.0 || center > 669.0);  // most of the ball is cut off
    EXPECT_LT(errorOf(camera, outlineOf(seen(camera, ball)), ball), 0.03) << x;
  }
}

TEST(BallPosition, isNotFoundForTooFewPoints)
{
  const CameraModel camera = wideCamera();
  std::vector<cv::Point> border;
  for (int x = 0; x < 640; ++x)
    border.emplace_back(x, 0);
  EXPECT_FALSE(ballPosition(camera, {}, kDiameter));
  EXPECT_FALSE(ballPosition(camera, {{100, 100}}, kDiameter));
  EXPECT_FALSE(ballPosition(camera, {{100, 100}, {101, 100}, {101, 101}, {100, 101}}, kDiameter));
  EXPECT_FALSE(ballPosition(camera, border, kDiameter));
}

TEST(BallPosition, refusesInvalidArguments)
{
  const CameraModel camera = wideCamera();
  EXPECT_EQ(refusal([&] { ballPosition(camera, {}, 0.0); }), "diameter is 0, must be positive (m)");
  EXPECT_EQ(refusal([&] { ballPosition(camera, {}, std::numeric_limits<double>::quiet_NaN()); }),
            "diameter is nan, must be positive (m)");
  EXPECT_EQ(refusal(
                [&] {
                  ballPosition(camera, {{3, 4}, {640, 4}}, 1.0);
                }),
            "outline point is (640, 4), must be in the camera's image, 640x480");
  EXPECT_EQ(refusal([] { ballPosition(CameraModel(), {}, 1.0); }), "width is 0, must be at least 1");
}

TEST(ChooseBall, takesTheLargestRoundOneOrTheNearest)
{
  const std::vector<BallCandidate> all = {{{50, 50}, 900, 0.4}, {{200, 80}, 300, 0.9}, {{90, 300}, 500, 0.8}};
  EXPECT_EQ(chooseBall(all, 0.7), std::size_t{2});
  EXPECT_EQ(chooseBall(all, 0.85), std::size_t{1});
  EXPECT_EQ(chooseBall(all, 0.0), std::size_t{0});
  EXPECT_EQ(chooseBall(all, 0.95), std::nullopt);
  EXPECT_EQ(chooseBall({}, 0.0), std::nullopt);
  EXPECT_EQ(chooseBall(all, 0.7, cv::Point2d(190, 90)), std::size_t{1});
  EXPECT_EQ(chooseBall(all, 0.7, cv::Point2d(51, 51)), std::size_t{1});  // the nearest one is not round
  EXPECT_EQ(refusal([&] { chooseBall(all, 1.5); }), "min_roundness is 1.5, must be from 0 to 1");
}
