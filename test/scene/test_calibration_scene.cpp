#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "robot_vision/camera/open_source.hpp"
#include "robot_vision/scene/scene.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr int kViews = 40;
constexpr double kNewViewEachFrame = 2.0;  // Hz, the rate of frames
const cv::Size kCorners(8, 6);

cv::Mat gray(const CalibrationScene& scene, int frame)
{
  cv::Mat bgr;
  scene.render(frame, bgr);
  return converted(bgr, cv::COLOR_BGR2GRAY);
}

/// The corners that OpenCV finds; empty if it finds no board.
std::vector<cv::Point2f> findCorners(const cv::Mat& gray)
{
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(gray, kCorners, corners)) return {};
  cv::cornerSubPix(gray, corners, {5, 5}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.001});
  return corners;
}

/// The inner corners in the board's frame, row by row from the top left one.
std::vector<cv::Point3d> boardPoints()
{
  std::vector<cv::Point3d> result;
  for (int row = 0; row < kCorners.height; ++row)
    for (int column = 0; column < kCorners.width; ++column)
      result.emplace_back((column - 3.5) * kSceneCheckerSquare, (2.5 - row) * kSceneCheckerSquare, 0.0);
  return result;
}

}  // namespace

TEST(CalibrationScene, cornersAreFoundWhereTheTruthHasThem)
{
  const CalibrationScene scene({640, 480, kNewViewEachFrame});
  for (int view = 0; view < kViews; view += 4)
  {
    const std::vector<cv::Point2f> corners = findCorners(gray(scene, view));
    ASSERT_EQ(corners.size(), boardPoints().size()) << view;
    const cv::Affine3d pose = scene.truth(view).objects.at(0).pose;
    double squares = 0.0;
    for (const cv::Point3d& point : boardPoints())
    {
      const cv::Point2d exact = scene.camera().project(pose * point);
      double nearest = 1e9;  // the order of the corners is unknown, as OpenCV may find the board upside down
      for (const cv::Point2f& corner : corners)
        nearest = std::min(nearest, cv::norm(cv::Point2d(corner) - exact));
      squares += nearest * nearest;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(corners.size())), 0.1) << view;
  }
}

TEST(CalibrationScene, showsTheWholeBoardAllOverTheImage)
{
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(1280, 720), cv::Size(480, 640)})
  {
    const CalibrationScene scene({size.width, size.height, kNewViewEachFrame});
    const cv::Rect2d image(-0.5, -0.5, size.width, size.height);
    cv::Mat seen = cv::Mat::zeros(3, 4, CV_8U);
    for (int view = 0; view < kViews; ++view)
    {
      const SceneObject board = scene.truth(view).objects.at(0);
      for (const double x : {-0.25, 0.25})
        for (const double y : {-0.2, 0.2})
          EXPECT_TRUE(image.contains(scene.camera().project(board.pose * cv::Point3d(x, y, 0)))) << view;
      for (const cv::Point3d& point : boardPoints())
      {
        const cv::Point2d at = scene.camera().project(board.pose * point);
        seen.at<uchar>(static_cast<int>(3 * at.y / size.height), static_cast<int>(4 * at.x / size.width)) = 1;
      }
    }
    EXPECT_EQ(cv::countNonZero(seen), 12) << size;
  }
}

TEST(CalibrationScene, holdsAPoseForHalfASecond)
{
  const CalibrationScene scene{SceneParams()};  // at 30 Hz
  const auto pose = [&](int frame) { return scene.truth(frame).objects.at(0).pose.matrix; };
  EXPECT_EQ(pose(0), pose(14));
  EXPECT_NE(pose(14), pose(15));
  EXPECT_EQ(pose(3), pose(603));  // the motion repeats after 20 s
}

TEST(CalibrationScene, isOpenedAsASourceByItsName)
{
  CaptureParams params;
  params.source = "synthetic";
  params.scene = "calibration";
  const auto source = openSource(params);
  EXPECT_EQ(source->description(), "synthetic scene (calibration) 640x480 at 30 Hz");
  Frame frame;
  ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  cv::Mat exact;
  const CalibrationScene scene{SceneParams()};
  scene.render(0, exact);
  EXPECT_TRUE(equal(frame.image, exact));
  ASSERT_EQ(frame.truth->objects.size(), 1U);
  EXPECT_EQ(frame.truth->objects[0].name, "checkerboard");
  EXPECT_EQ(source->cameraModel()->K, scene.camera().K);
  params.scene = "road";
  EXPECT_EQ(openSource(params)->description(), "synthetic scene (road) 640x480 at 30 Hz");
  params.scene = "beach";
  EXPECT_EQ(refusal([&] { openSource(params); }), "scene is 'beach', must be room, calibration, road or tabletop");
}
