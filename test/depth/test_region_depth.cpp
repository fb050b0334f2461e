#include "robot_vision/depth/region_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/depth/depth_image.hpp"
#include "support/depth_regions.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;
using namespace depth_regions;

namespace
{

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST(RegionLocator, aFaceBeforeAWallIsWhereTheFaceIs)
{
  for (const CameraModel& camera :
       {depthWorldCamera(320), depthWorldCamera(320, kBentLens), depthWorldCamera(320, kFisheyeLens, "equidistant")})
  {
    const cv::Mat depth = faceBeforeAWall().depth(camera), before = depth.clone();
    const auto found = locate(depth, camera, faceBox(camera));
    ASSERT_TRUE(found);
    expectUsable(*found);
    EXPECT_LT(distanceTo(kFace, found), 0.005);  // a pixel is 6 mm there
    EXPECT_NEAR(found->position.z, kFace[2], 1e-6);
    EXPECT_NEAR(found->size[0], 1.15 * 0.16, 0.012);
    EXPECT_NEAR(found->size[1], 1.15 * 0.22, 0.012);
    EXPECT_EQ(found->size[2], 0.0);
    const double shown = 0.16 * 0.22 * std::pow(0.85 * 320 / kFace[2], 2);
    EXPECT_NEAR(found->pixels, shown, (camera.D.empty() ? 0.1 : 0.3) * shown);
    EXPECT_EQ(cv::norm(depth, before, cv::NORM_INF), 0.0);
  }
}

TEST(RegionLocator, bothEncodingsAndPaddedRowsGiveTheSame)
{
  const CameraModel camera = depthWorldCamera(320);
  const cv::Mat metres = faceBeforeAWall().depth(camera);
  cv::Mat millimetres, padded;
  toMillimetres(metres, "32FC1", millimetres);
  cv::copyMakeBorder(metres, padded, 3, 5, 7, 9, cv::BORDER_CONSTANT, cv::Scalar(0.5));
  const auto found = locate(metres, camera, faceBox(camera));
  EXPECT_LT(distanceTo(found->position, locate(millimetres, camera, faceBox(camera))), 0.001);
  const cv::Mat part = padded(cv::Rect(7, 3, metres.cols, metres.rows));
  EXPECT_EQ(distanceTo(found->position, locate(part, camera, faceBox(camera))), 0.0);
}

TEST(RegionLocator, holesDoNoHarmUntilThereIsTooLittleLeft)
{
  const CameraModel camera = depthWorldCamera(320);
  const cv::Mat whole = faceBeforeAWall().depth(camera);
  for (const double hole : {kNan, 0.0, -1.0, std::numeric_limits<double>::infinity(), 2000.0})
  {
    cv::Mat depth = whole.clone();
    cv::RNG random(7);
    for (int i = 0; i < static_cast<int>(depth.total()); ++i)
      if (random.uniform(0.0, 1.0) < 0.8) depth.at<float>(i) = static_cast<float>(hole);
    EXPECT_LT(distanceTo(kFace, locate(depth, camera, faceBox(camera))), 0.005) << hole;
    depth.setTo(hole);
    EXPECT_FALSE(locate(depth, camera, faceBox(camera))) << hole;
    const cv::Rect few(faceBox(camera).box.tl() + cv::Point(8, 8), cv::Size(4, 3));
    whole(few).copyTo(depth(few));
    LocatorParams params;
    params.min_pixels = few.area() + 1;
    EXPECT_FALSE(locate(depth, camera, faceBox(camera), params)) << hole;
    params.min_pixels = few.area() / 2;  // not all of them are looked at
    EXPECT_TRUE(locate(depth, camera, faceBox(camera), params)) << hole;
  }
}

TEST(RegionLocator, whatHidesASmallPartIsNotTheThing)
{
  const CameraModel camera = depthWorldCamera(320);
  const auto hiddenBy = [&](double height)  // a hand before the lower part of the face, m
  {
    const cv::Vec3d middle = (kFace + cv::Vec3d(0.0, 0.11 - 0.5 * height, 0.0)) * 0.75;
    return faceBeforeAWall({{middle, {0.06, 0.0, 0.0}, {0.0, 0.75 * 0.5 * height, 0.0}}}).depth(camera);
  };
  const ImageRegion region = faceBox(camera, 0.0);
  EXPECT_NEAR(locate(hiddenBy(0.07), camera, region)->position.z, kFace[2], 1e-6);
  EXPECT_NEAR(locate(hiddenBy(0.16), camera, region)->position.z, 0.75 * kFace[2], 1e-6);
  LocatorParams params;
  params.min_share = 0.05;
  EXPECT_NEAR(locate(hiddenBy(0.07), camera, region, params)->position.z, 0.75 * kFace[2], 1e-6);
  params.min_share = 1.0;  // nothing has as much: it is what most see
  EXPECT_NEAR(locate(hiddenBy(0.07), camera, region, params)->position.z, kFace[2], 1e-6);
}

TEST(RegionLocator, aPersonIsFoundInABoxThatShowsMoreOfTheRoom)
{
  const CameraModel camera = depthWorldCamera(320);
  const cv::Vec3d body(-0.2, 0.1, 2.2);
  DepthWorld world;
  world.rectangles = {kWall, {body, {0.2, 0.0, 0.0}, {0.0, 0.5, 0.0}}};
  const auto found = locate(world.depth(camera), camera, boxOf(body, 0.9, 1.3, camera));
  EXPECT_LT(distanceTo(body, found), 0.01);
}

TEST(RegionLocator, onlyWhatIsInTheOutlineCounts)
{
  const CameraModel camera = depthWorldCamera(320);
  DepthWorld world = faceBeforeAWall();
  world.rectangles.pop_back();
  cv::Mat depth = world.depth(camera);
  // A stick from one corner of the box to the other.
  const std::vector<cv::Point> stick = {{100, 60}, {104, 60}, {180, 150}, {176, 150}};
  cv::fillPoly(depth, std::vector<std::vector<cv::Point>>{stick}, cv::Scalar(1.2));
  ImageRegion region;
  region.box = cv::boundingRect(stick);
  EXPECT_GT(locate(depth, camera, region)->position.z, 2.5);
  region.outline.assign(stick.begin(), stick.end());
  const auto found = locate(depth, camera, region);
  EXPECT_NEAR(found->position.z, 1.2, 1e-6);
  EXPECT_NEAR(found->pixels, 4.0 * 91, 60.0);
  region.outline.insert(region.outline.end(), {{0, 0}, {0, 0}});  // lines to and fro enclose nothing more
  region.outline.push_back(region.outline[3]);
  EXPECT_EQ(locate(depth, camera, region)->pixels, found->pixels);
  region.outline.resize(2);  // a line, in which there is nothing
  EXPECT_GT(locate(depth, camera, region)->position.z, 2.5);
}

TEST(RegionLocator, aSphereIsWhereItsMiddleIs)
{
  for (const WorldSphere& ball : {WorldSphere{{0.0, 0.0, 1.5}, 0.1}, WorldSphere{{-0.5, 0.3, 1.1}, 0.15}})
    for (const CameraModel& camera :
         {depthWorldCamera(320), depthWorldCamera(320, kBentLens), depthWorldCamera(320, kFisheyeLens, "equidistant")})
    {
      DepthWorld world;
      world.rectangles = {kWall};
      world.spheres = {ball};
      const cv::Mat depth = world.depth(camera);
      const auto found = locate(depth, camera, circleOf(ball, camera), sphere());
      ASSERT_TRUE(found);
      expectUsable(*found);
      EXPECT_LT(distanceTo(ball.middle, found), 0.1 * ball.radius);
      for (const double side : found->size.val)
        EXPECT_NEAR(side, 2.0 * ball.radius, 0.05 * ball.radius);
      ImageRegion box = circleOf(ball, camera);
      box.radius = 0.0;
      EXPECT_LT(distanceTo(ball.middle, locate(depth, camera, box, sphere())), 0.15 * ball.radius);
      // Half of what is seen of its surface is nearer than this.
      const double surface = ball.middle[2] - std::sqrt(0.5) * ball.radius;
      const auto seen = locate(depth, camera, circleOf(ball, camera));
      EXPECT_NEAR(seen->position.z, surface, 0.2 * ball.radius);
      EXPECT_GT(seen->size[2], 0.3 * ball.radius);
      EXPECT_LT(seen->size[2], ball.radius);
    }
}

TEST(RegionLocator, strangeRegionsGiveUsablePlacesOrNone)
{
  const CameraModel camera = depthWorldCamera(160, kBentLens);
  const cv::Mat depth = furnishedWorld().depth(camera);
  constexpr int kFar = 10000000;
  const std::vector<cv::Rect> boxes = {{-20, -20, 60, 60},
                                       {0, 0, 160, 120},
                                       {159, 119, 50, 50},
                                       {50, 50, 1, 1},
                                       {0, 60, 160, 1},
                                       {80, 0, 1, 120},
                                       {1 - kFar, 1 - kFar, kFar, kFar},
                                       {0, 0, kFar, kFar}};
  const double far = kFar;
  const std::vector<std::vector<cv::Point2d>> outlines = {{},
                                                          {{60, 60}},
                                                          {{60, 60}, {60, 60}, {60, 60}},
                                                          {{0, 0}, {150, 110}, {150, 0}, {0, 110}},  // crosses itself
                                                          {{-far, -far}, {far, -far}, {far, far}, {-far, far}},
                                                          {{50.2, 50.2}, {50.3, 50.2}, {50.3, 51.9}}};
  for (const char* shape : {"surface", "sphere"})
    for (const cv::Rect& box : boxes)
      for (const std::vector<cv::Point2d>& outline : outlines)
      {
        ImageRegion region;
        region.box = box;
        region.center = cv::Point2d(70.0, 50.0);
        region.outline = outline;
        region.radius = 5.0;
        LocatorParams params;
        params.shape = shape;
        params.min_pixels = 1;
        const auto found = locate(depth, camera, region, params);
        if (found) expectUsable(*found);
      }
}

TEST(RegionLocator, whatCannotBeIsRefused)
{
  EXPECT_EQ(refusalWith(&LocatorParams::shape, std::string("cube")), "shape is cube, must be surface or sphere");
  EXPECT_EQ(refusalWith(&LocatorParams::min_share, 1.5), "min_share is 1.5, must be from 0 to 1");
  EXPECT_EQ(refusalWith(&LocatorParams::pixel_error, kNan), "pixel_error is nan, must be from 0.01 to 1000");
  EXPECT_EQ(refusalWith(&DepthErrorParams::depth_bias, -1.0), "depth_bias is -1, must be from 0 to 1");
  const CameraModel camera = depthWorldCamera(64);
  const cv::Mat depth = cv::Mat::ones(48, 64, CV_32FC1);
  const auto refused = [&](const ImageRegion& region) { return refusal([&] { locate(depth, camera, region); }); };
  ImageRegion region;
  for (const cv::Rect& box :
       {cv::Rect(), cv::Rect(64, 0, 5, 5), cv::Rect(0, 48, 5, 5), cv::Rect(-5, 0, 5, 5), cv::Rect(3, 3, 5, -2),
        cv::Rect(1 << 30, 0, 1 << 30, 5), cv::Rect(0, 0, 1 << 30, 1 << 30)})
  {
    region.box = box;
    EXPECT_NE(refused(region).find("the box is "), std::string::npos) << box;
    EXPECT_NE(refused(region).find(", must be in the image of 64x48"), std::string::npos) << box;
  }
  region.box = {10, 10, 20, 20};
  EXPECT_EQ(refused(region), "");
  ImageRegion bad = region;
  bad.center = cv::Point2d(kNan, 3.0);
  EXPECT_EQ(refused(bad), "a point of the region is (nan, 3), must be finite, and in an image");
  bad = region;
  bad.outline = {{10, 10}, {20, 10}, {20, 1e300}};
  EXPECT_EQ(refused(bad), "a point of the region is (20, 1e+300), must be finite, and in an image");
  bad = region;
  bad.radius = -1.0;
  EXPECT_EQ(refused(bad), "the radius is -1, must be from 0 to 1e+07");
  bad.radius = 1e6;
  EXPECT_EQ(refusal([&] { locate(depth, camera, bad, sphere()); }),
            "the radius is 1e+06, must be that of a sphere which is seen in one image");
  EXPECT_EQ(refusal([&] { locate(depth(cv::Rect(0, 0, 60, 48)), camera, region); }),
            "the size of the depth image is 60x48, must be 64x48 as of its camera");
  EXPECT_NE(refusal([&] { RegionLocator(camera).locate(depth, "bgr8", region); }).find("must be 16UC1"),
            std::string::npos);
  EXPECT_NE(refusal([&] { RegionLocator{CameraModel()}; }), "");
}
