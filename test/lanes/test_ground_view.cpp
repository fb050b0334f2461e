#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "robot_vision/lanes/ground_view.hpp"
#include "robot_vision/lanes/lane_detector.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

CameraModel camera(const std::vector<double>& D = {})
{
  return {320, 240, cv::Matx33d(200.0, 0, 159.5, 0, 205.0, 119.5, 0, 0, 1), D, "plumb_bob"};
}

/// The pixel of a place on the floor by cv::projectPoints.
cv::Point2d expected(const cv::Point2d& place, const GroundParams& params, const CameraModel& seen_by)
{
  const double sine = std::sin(params.pitch), cosine = std::cos(params.pitch);
  const cv::Matx33d rotation(0, -1, 0, -sine, 0, -cosine, cosine, 0, -sine);  // to right, down and ahead
  const cv::Vec3d eye(params.camera_x, params.camera_y, params.camera_height);
  cv::Vec3d turn;
  cv::Rodrigues(rotation, turn);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(std::vector<cv::Point3d>{{place.x, place.y, 0.0}}, turn, -(rotation * eye), seen_by.K, seen_by.D,
                    pixels);
  return pixels[0];
}

/// While it lives it notes how large the matrices are that OpenCV makes.
class NotedMatrices : public cv::MatAllocator
{
public:
  NotedMatrices() { cv::Mat::setDefaultAllocator(this); }
  ~NotedMatrices() override { cv::Mat::setDefaultAllocator(cv::Mat::getStdAllocator()); }

  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override
  {
    cv::UMatData* const made = cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
    largest_ = std::max(largest_, made->size);
    return made;
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override
  {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override { cv::Mat::getStdAllocator()->deallocate(data); }

  /// Bytes of the largest one since the last call.
  std::size_t largest() const { return std::exchange(largest_, 0); }

private:
  mutable std::size_t largest_ = 0;
};

}  // namespace

TEST(GroundView, placesAreWhereTheCameraProjectsThem)
{
  GroundParams params;
  params.camera_x = 0.1;
  params.camera_y = -0.05;
  for (const auto& lens : {camera(), camera({-0.2, 0.05, 0.001, -0.002})})
  {
    const GroundView view(params, lens);
    for (const cv::Point2d place : {cv::Point2d(0.4, 0.0), {0.6, 0.2}, {1.0, -0.3}})
      EXPECT_LT(cv::norm(view.toImage(place) - expected(place, params, lens)), 1e-6) << place;
  }
}

TEST(GroundView, theViewAndTheGroundAreInverse)
{
  const GroundView view(GroundParams(), camera());
  EXPECT_EQ(view.seen().size(), cv::Size(240, 200));
  for (const cv::Point2d at : {cv::Point2d(0, 0), {239, 199}, {17.5, 80.25}})
    EXPECT_LT(cv::norm(view.toView(view.toGround(at)) - at), 1e-9);
  EXPECT_LT(cv::norm(view.toGround({-0.5, -0.5}) - cv::Point2d(1.2, 0.6)), 1e-9);  // ahead and left is up and left
}

TEST(GroundView, whatIsBehindTheCameraIsNotSeen)
{
  GroundParams params;
  EXPECT_TRUE(std::isnan(GroundView(params, camera()).toImage({-1.0, 0.0}).x));
  params.ground = "points";
  const GroundView view(params, 0.4, {320, 240});
  EXPECT_TRUE(std::isnan(view.toImage({-10.0, 0.0}).x));
  EXPECT_LT(cv::norm(view.toImage({params.near, 0.2}) - cv::Point2d(31.5, 227.5)), 1e-3);
  EXPECT_LT(cv::norm(view.toImage({params.far, -0.2}) - cv::Point2d(191.5, 95.5)), 1e-3);
}

TEST(GroundView, aLensThatFoldsItsBorderShowsNothingTwice)
{
  const CameraModel folding = camera({-0.3, 0.0, 0.0, 0.0});  // its radius grows up to 1.05, and shrinks again
  GroundParams params;
  params.view_width = 4.0;
  params.resolution = 0.01;
  const GroundView view(params, folding);
  for (const double y : {0.5, 0.6})
  {
    const cv::Point2d pixel = view.toImage({0.3, y});
    EXPECT_TRUE(std::isnan(pixel.x)) << pixel;
  }
  EXPECT_FALSE(std::isnan(view.toImage({0.6, 0.2}).x));
}

TEST(LaneDetector, anythingAtAllIsAnImage)
{
  cv::RNG random(3);
  for (const cv::Size size : {cv::Size(2, 2), cv::Size(320, 2), cv::Size(3, 240), cv::Size(321, 239)})
    for (const char* method : {"ridge", "color", "gradient"})
    {
      GroundParams ground;
      ground.ground = "points";
      LaneParams params;
      params.method = method;
      params.min_rows = 1;
      LaneDetector detector(ground, params);
      cv::Mat image(size, CV_8UC3);
      for (int frame = 0; frame < 3; ++frame)
      {
        random.fill(image, cv::RNG::UNIFORM, 0, 256);
        const Lane lane = detector.update(0.1 * frame, image, "bgr8");
        for (const double value : {lane.offset, lane.heading, lane.curvature, lane.width})
          EXPECT_TRUE(std::isfinite(value)) << method << size;
      }
    }
}

TEST(LaneDetector, refusesAnImageInWhichThereIsNoFloor)
{
  GroundParams ground;
  ground.ground = "points";
  LaneDetector detector(ground);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(320, 1), cv::Size(1, 240)})
    EXPECT_EQ(refusal([&] { detector.update(0.0, cv::Mat::zeros(size, CV_8UC3), "bgr8"); }).substr(0, 45),
              "the view from above is black, must be of floo")
        << size;
}

TEST(LaneDetector, makesAViewThatItRefusesOnlyOnce)
{
  const std::string black = "the view from above is black, must be of floo";
  GroundParams beyond, points;
  beyond.near = 30.0;
  beyond.far = 31.0;
  beyond.pitch = 1.5;
  points.ground = "points";
  const CameraModel seen_by = camera();
  for (const auto& [ground, size] :
       {std::make_pair(beyond, cv::Size(320, 240)), std::make_pair(points, cv::Size(1, 240))})
  {
    const std::size_t map = std::size_t{240} * 200 * 8;  // bytes: where each pixel of the view is in the image
    const cv::Mat image = cv::Mat::zeros(size, CV_8UC1);
    LaneDetector detector(ground);
    const NotedMatrices matrices;
    for (const bool first : {true, false, false})
    {
      EXPECT_EQ(refusal([&] { detector.update(0.0, image, "mono8", &seen_by); }).substr(0, 45), black);
      EXPECT_EQ(matrices.largest() >= map, first);
    }
    CameraModel other = seen_by;
    other.K(0, 0) += 1.0;
    refusal([&] { detector.update(0.0, image, "mono8", &other); });
    EXPECT_EQ(matrices.largest() >= map, ground.ground == "camera");
  }
}

TEST(LaneDetector, refusesAViewThatIsTooNarrow)
{
  LaneParams params;
  params.line_width = 0.4;
  EXPECT_EQ(refusal([&] { LaneDetector(GroundParams(), params); }),
            "line_width is 0.4, must be at most a quarter of view_width, 0.3");
}
