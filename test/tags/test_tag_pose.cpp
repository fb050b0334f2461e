#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "robot_vision/tags/pose/tag_pose.hpp"
#include "robot_vision/tags/pose/tag_pose_tracker.hpp"
#include "support/refusal.hpp"
#include "support/tag_views.hpp"

using namespace robot_vision;

namespace
{

std::vector<CameraModel> cameras()
{
  return {{640, 480, kK, {-0.25, 0.07, 0.001, -0.002, 0.0}, "plumb_bob"},
          {640, 480, kK, {0.45, -0.3, 0.001, -0.002, -0.02, 0.8, -0.1, -0.07}, "rational_polynomial"},
          {640, 480, kK, {0.05, -0.02, 0.006, -0.001}, "equidistant"}};
}

std::vector<cv::Affine3d> somePoses()
{
  std::vector<cv::Affine3d> poses;
  for (const double distance : {0.35, 1.0, 12.0})
    for (const double tilt : {0.3, 0.8, 1.3})
      for (const double direction : {0.0, 1.0, 2.5, 4.0})
      {
        const cv::Affine3d spin(cv::Vec3d(0, 0, 2.0 * direction));
        const cv::Vec3d turn(tilt * std::cos(direction), tilt * std::sin(direction), 0.0);
        poses.push_back(facing(turn, {0.05 * distance, -0.08 * distance, distance}) * spin);
      }
  return poses;
}

Bundle someBundle()
{
  return {"box",
          {{3, 0.1, cv::Affine3d(cv::Vec3d(0, 0.5, 0), cv::Vec3d(-0.15, 0, 0))},
           {5, 0.08, cv::Affine3d(cv::Vec3d(0.2, 0, 1.0), cv::Vec3d(0.1, 0.05, 0.02))},
           {8, 0.1, cv::Affine3d(cv::Vec3d(0, -0.6, 0), cv::Vec3d(0.25, 0, -0.05))}}};
}

}  // namespace

TEST(TagPose, axesAreThoseOfApriltagRos)
{
  // The tag is upright in front of the camera. Its corners begin at the bottom left and go on at the bottom right.
  const CameraModel camera{640, 480, kK, {}, ""};
  const TagCorners corners{7, {cv::Point2d(260, 300), {380, 300}, {380, 180}, {260, 180}}};
  const auto poses = estimatePose(singleTag(7, kSize), {corners}, camera, 0.1, 0.0);
  ASSERT_TRUE(poses);
  EXPECT_LT(angleBetween(poses->best.pose, facing({0, 0, 0}, {0, 0, 1})), 1e-6);
  EXPECT_LT(distanceBetween(poses->best.pose, facing({0, 0, 0}, {0, 0, 1})), 1e-6);
}

TEST(TagPose, exactCornersGiveTheExactPose)
{
  for (const CameraModel& camera : cameras())
    for (const cv::Affine3d& truth : somePoses())
    {
      const auto poses = estimatePose(singleTag(0, kSize), {seenTag(truth, camera)}, camera, 0.1, 0.0);
      ASSERT_TRUE(poses);
      EXPECT_LT(angleBetween(poses->best.pose, truth), 1e-5);
      EXPECT_LT(distanceBetween(poses->best.pose, truth) / truth.translation()[2], 1e-6);
      EXPECT_LT(poses->best.error, 1e-5);
      EXPECT_LT(poses->ratio, 0.1);
    }
}

TEST(TagPose, bothPosesAreThoseOfOpenCvAfterRefinement)
{
  const CameraModel camera{640, 480, kK, {}, "plumb_bob"};
  int ambiguous = 0;
  for (const cv::Affine3d& truth : somePoses())
  {
    const TagCorners corners = seenTag(truth, camera);
    const auto poses = estimatePose(singleTag(0, kSize), {corners}, camera, 0.1, 0.0);
    // OpenCV's order of a square's corners begins with the top left one.
    const double half = kSize / 2.0;
    const std::vector<cv::Point3d> square = {{-half, half, 0}, {half, half, 0}, {half, -half, 0}, {-half, -half, 0}};
    const std::vector<cv::Point2d> pixels = {corners.corners[3], corners.corners[2], corners.corners[1],
                                             corners.corners[0]};
    std::vector<cv::Mat> turns, shifts;
    cv::solvePnPGeneric(square, pixels, kK, cv::noArray(), turns, shifts, false, cv::SOLVEPNP_IPPE_SQUARE);
    ASSERT_EQ(turns.size(), 2u);
    if (!poses->other) continue;
    ++ambiguous;
    cv::solvePnPRefineLM(square, pixels, kK, cv::noArray(), turns[1], shifts[1]);
    const cv::Affine3d other(cv::Vec3d(turns[1].ptr<double>()), cv::Vec3d(shifts[1].ptr<double>()));
    EXPECT_LT(angleBetween(poses->other->pose, other), 1e-3);
    EXPECT_GE(poses->other->error, poses->best.error);
    EXPECT_DOUBLE_EQ(poses->ratio, poses->best.error / poses->other->error);
  }
  EXPECT_GT(ambiguous, 12);
}

TEST(TagPose, covarianceFollowsFromThatOfTheCorners)
{
  // When each coordinate of a corner is moved to both sides, the poses must change as the covariance says.
  const CameraModel camera = cameras()[2];
  const double noise = 0.3, step = 0.03;  // px; OpenCV takes angles below 1e-5 as 0
  const cv::Affine3d truth = facing({0.4, -0.6, 0.3}, {0.1, -0.05, 0.7});
  const TagCorners corners = seenTag(truth, camera);
  cv::Matx66d expected = cv::Matx66d::zeros();
  for (int i = 0; i < 8; ++i)
  {
    cv::Affine3d moved[2];
    for (const int side : {0, 1})
    {
      TagCorners shifted = corners;
      cv::Point2d& corner = shifted.corners[static_cast<std::size_t>(i / 2)];
      (i % 2 ? corner.y : corner.x) += side ? step : -step;
      moved[side] = estimatePose(singleTag(0, kSize), {shifted}, camera, noise, 0.0)->best.pose;
    }
    const cv::Vec3d shift = moved[1].translation() - moved[0].translation();
    const cv::Vec3d turn = cv::Affine3d(moved[1].rotation() * moved[0].rotation().t()).rvec();
    const cv::Vec6d change = cv::Vec6d(shift[0], shift[1], shift[2], turn[0], turn[1], turn[2]) * (0.5 / step);
    expected += noise * noise * (change * change.t());
  }
  const cv::Matx66d covariance = estimatePose(singleTag(0, kSize), {corners}, camera, noise, 0.0)->best.covariance;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      EXPECT_NEAR(covariance(row, column), expected(row, column),
                  0.001 * std::sqrt(expected(row, row) * expected(column, column)));
}

TEST(TagPose, aTagFarAwayHasTwoEquallyProbablePoses)
{
  const CameraModel camera{640, 480, kK, {}, "plumb_bob"};
  const cv::Affine3d truth = facing({0.6, 0.0, 0.0}, {0, 0, 12});  // 10 px
  const auto poses = estimatePose(singleTag(0, kSize), {seenTag(truth, camera)}, camera, 0.5, 0.0);
  ASSERT_TRUE(poses && poses->other);
  EXPECT_NEAR(poses->probability, 0.5, 0.05);
  EXPECT_NEAR(angleBetween(poses->best.pose, poses->other->pose), 1.2, 0.1);
  // The covariance of the rotation about x includes the other pose.
  EXPECT_GT(poses->best.covariance(3, 3), 0.4 * 1.2 * 1.2);
}

TEST(TagPose, aBundlesPoseComesFromAllOfItsTags)
{
  const Bundle bundle = someBundle();
  for (const CameraModel& camera : cameras())
    for (const cv::Affine3d& truth : {facing({0.2, 0.1, 0.4}, {0.05, 0.02, 1.0}), facing({-0.5, 0.1, 2}, {0, 0, 5})})
    {
      std::vector<TagCorners> tags = {{99, {}}};  // not in the bundle, so ignored
      for (const BundleTag& tag : bundle.tags)
        tags.push_back(seen(tag, truth, camera));
      const auto all = estimatePose(bundle, tags, camera, 0.2, 0.0);
      ASSERT_TRUE(all);
      EXPECT_LT(angleBetween(all->best.pose, truth), 1e-5);
      EXPECT_LT(distanceBetween(all->best.pose, truth), 1e-5);
      EXPECT_GT(all->probability, 0.999);
      const auto one = estimatePose(bundle, {tags[2]}, camera, 0.2, 0.0);
      EXPECT_LT(angleBetween(one->best.pose, truth), 1e-4);
      EXPECT_LT(10.0 * all->best.covariance(4, 4), one->best.covariance(4, 4));
    }
  EXPECT_FALSE(estimatePose(bundle, {}, cameras()[0], 0.2, 0.0));
  EXPECT_FALSE(estimatePose(bundle, {{4, {}}}, cameras()[0], 0.2, 0.0));
}

TEST(TagPose, uncertainLayoutAddsToTheCovariance)
{
  const CameraModel camera = cameras()[0];
  const cv::Affine3d truth = facing({0.4, 0.2, 0.1}, {0.02, -0.01, 1.0});
  Bundle bundle = singleTag(0, kSize);
  const auto covariance = [&]
  { return estimatePose(bundle, {seen(bundle.tags[0], truth, camera)}, camera, 0.1, 0.0)->best.covariance; };
  const cv::Matx66d exact = covariance();
  bundle.tags[0].shift_noise = 0.003;
  bundle.tags[0].turn_noise = 0.02;
  const cv::Matx66d more = covariance() - exact;
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(more(i, i), i < 3 ? 9e-6 : 4e-4, i < 3 ? 9e-8 : 4e-6) << i;
}

TEST(TagPose, aSecondTagDoesNotHalveTheLensError)
{
  const CameraModel camera = cameras()[0];
  const Bundle pair = {"pair",
                       {{1, 0.05, cv::Affine3d(cv::Vec3d(), cv::Vec3d(-0.04, 0, 0))},
                        {2, 0.05, cv::Affine3d(cv::Vec3d(), cv::Vec3d(0.04, 0, 0))}}};
  const cv::Affine3d truth = facing({0.3, 0.4, 0}, {0, 0, 1});
  const std::vector<TagCorners> both = {seen(pair.tags[0], truth, camera), seen(pair.tags[1], truth, camera)};
  const auto sideways = [&](const std::vector<TagCorners>& tags)
  { return estimatePose(pair, tags, camera, 0.01, 0.2)->best.covariance(1, 1); };
  EXPECT_NEAR(sideways(both) / sideways({both[0]}), 1.0, 0.05);
}

TEST(TagPose, covariancesOfCornersMayBeTinyOrHuge)
{
  const CameraModel camera = cameras()[0];
  TagCorners corners = seenTag(facing({0.3, 0.4, 0}, {0, 0, 1}), camera, 0);
  Bundle bundle = singleTag(0, kSize);
  bundle.tags[0].shift_noise = 0.003;
  for (const double variance : {3e-15, 1.0, 1e17})
  {
    corners.covariance = variance * CornerCovariance::eye();
    const auto found = estimatePose(bundle, {corners}, camera, 0.1, 0.0);
    ASSERT_TRUE(found) << variance;
    const cv::Matx66d& covariance = found->best.covariance;
    EXPECT_TRUE(std::isfinite(cv::norm(covariance))) << variance;
    EXPECT_GT(covariance(0, 0), 8e-6) << variance;
  }
}

namespace
{

/// The reason for which corners of a single image, and of one that is tracked, are refused; empty if they are not.
std::string refusalOf(const TagCorners& corners, const CameraModel& camera)
{
  const Bundle bundle = singleTag(corners.id, kSize);
  const std::string reason = refusal([&] { estimatePose(bundle, {corners}, camera, 0.2, 0.0); });
  EXPECT_EQ(refusal([&] { TagPoseTracker(bundle).update(0.0, {corners}, camera); }), reason);
  return reason;
}

}  // namespace

TEST(TagPose, invalidBundlesAreRefused)
{
  const auto refused = [](const Bundle& bundle) { return refusal([&] { validate(bundle); }); };
  EXPECT_EQ(refused(someBundle()), "");
  EXPECT_EQ(refused({"box", {}}), "number of tags of bundle 'box' is 0, must be at least 1");
  EXPECT_EQ(refused(singleTag(-1, 0.1)), "id of a tag of bundle 'tag_-1' is -1, must be at least 0");
  EXPECT_EQ(refused(singleTag(4, 0.0)), "size of tag 4 of bundle 'tag_4' is 0, must be above 0 (m)");
  EXPECT_EQ(refused(singleTag(4, std::nan(""))), "size of tag 4 of bundle 'tag_4' is nan, must be above 0 (m)");
  Bundle bundle = someBundle();
  bundle.tags[2].id = 3;
  EXPECT_EQ(refused(bundle), "id of a tag of bundle 'box' is 3 twice, must be there once");
  bundle = someBundle();
  bundle.tags[1].pose.matrix(0, 0) = 2.0;
  EXPECT_EQ(refused(bundle), "pose of tag 5 of bundle 'box' is none, must be a rotation and a finite translation");
  bundle = someBundle();
  bundle.tags[1].shift_noise = -0.1;
  EXPECT_EQ(refused(bundle), "shift_noise of tag 5 of bundle 'box' is -0.1, must be from 0 to 1");
  bundle.tags[1] = {5, 0.1, cv::Affine3d::Identity(), 0.0, 0.6};
  EXPECT_EQ(refused(bundle), "turn_noise of tag 5 of bundle 'box' is 0.6, must be from 0 to 0.5");
}

TEST(TagPose, invalidCornersAreRefused)
{
  const CameraModel camera = cameras()[2];
  const TagCorners good = seenTag(facing({0.3, 0, 0}, {0, 0, 1}), camera, 2);
  const auto refused = [&](const TagCorners& corners) { return refusalOf(corners, camera); };
  EXPECT_EQ(refused(good), "");
  TagCorners bad{2, {cv::Point2d(10, 30), {30, 30}, {30, 10}, {10, std::nan("")}}};
  const std::string rule = ", must be finite and convex, counter-clockwise as seen, of more than 1 px^2";
  EXPECT_EQ(refused(bad), "corners of tag 2 is (10, 30), (30, 30), (30, 10), (10, nan)" + rule);
  bad.corners[3] = {10, 10};
  EXPECT_EQ(refused(bad), "");
  std::swap(bad.corners[1], bad.corners[3]);  // clockwise
  EXPECT_EQ(refused(bad), "corners of tag 2 is (10, 30), (10, 10), (30, 10), (30, 30)" + rule);
  bad.corners = {cv::Point2d(10, 30), {30, 30}, {10, 10}, {30, 10}};  // crossed
  EXPECT_NE(refused(bad), "");
  bad.corners = {cv::Point2d(10, 10), {20, 10}, {30, 10}, {15, 9}};  // three in a line
  EXPECT_NE(refused(bad), "");
  bad.corners.fill({10, 10});
  EXPECT_NE(refused(bad), "");
  bad = good;
  for (cv::Point2d& corner : bad.corners)
    corner += {2000, 0};
  EXPECT_NE(refused(bad).find("must be where the camera's distortion has rays"), std::string::npos) << refused(bad);

  const auto twice = [&] { estimatePose(singleTag(2, kSize), {good, good}, camera, 0.2, 0.0); };
  EXPECT_EQ(refusal(twice), "tag 2 is seen twice, must be seen once");
  const auto noise = [&] { estimatePose(singleTag(2, kSize), {good}, camera, 1e-8, 0.0); };
  EXPECT_EQ(refusal(noise), "noise is 1e-08, must be from 0.001 to 10");
  const auto lens = [&] { estimatePose(singleTag(2, kSize), {good}, camera, 0.2, std::nan("")); };
  EXPECT_EQ(refusal(lens), "lens_noise is nan, must be from 0 to 10");
}

TEST(TagPose, invalidCovariancesAreRefused)
{
  const CameraModel camera = cameras()[2];
  TagCorners corners = seenTag(facing({0.3, 0, 0}, {0, 0, 1}), camera, 2);
  const auto refused = [&](int row, int column, double value)
  {
    corners.covariance = 0.01 * CornerCovariance::eye();
    (*corners.covariance)(row, column) = value;
    return refusalOf(corners, camera);
  };
  EXPECT_EQ(refused(3, 3, 0.02), "");
  const std::string rule =
      "covariance of the corners of tag 2 is none, must be symmetric, positive definite and finite";
  EXPECT_EQ(refused(3, 3, 0.0), rule);
  EXPECT_EQ(refused(3, 3, -0.01), rule);
  EXPECT_EQ(refused(3, 4, 0.001), rule);
  EXPECT_EQ(refused(7, 7, std::nan("")), rule);
  EXPECT_EQ(refused(7, 7, std::numeric_limits<double>::infinity()), rule);
  corners.covariance = CornerCovariance::ones();
  EXPECT_EQ(refusalOf(corners, camera), rule);
}

TEST(TagPoseTracker, startsAnewAfterGapsAndWhenTimeGoesBack)
{
  const CameraModel camera = cameras()[0];
  const cv::Affine3d here = facing({0.5, 0, 0}, {0, 0, 1}), there = facing({0.5, 0, 0}, {2e-4, 0, 1});  // 0.1 px
  cv::RNG random(1);
  for (const double next : {9.0, 11.1})
  {
    TagPoseTracker tracker(singleTag(0, kSize));
    for (int i = 0; i < 40; ++i)
    {
      TagCorners corners = seenTag(here, camera);
      for (cv::Point2d& corner : corners.corners)
        corner += cv::Point2d(random.gaussian(0.2), random.gaussian(0.2));
      EXPECT_TRUE(tracker.update(9.5 + i / 80.0, {corners}, camera));
    }
    EXPECT_NEAR(tracker.cornerNoise(), 0.2, 0.06);
    EXPECT_LT(tracker.update(10.0, {seenTag(there, camera)}, camera)->best.pose.translation()[0], 1e-4);
    EXPECT_FALSE(tracker.update(10.1, {}, camera));
    EXPECT_LT(distanceBetween(tracker.update(next, {seenTag(there, camera)}, camera)->best.pose, there), 1e-7);
  }
}

TEST(TagPoseTracker, parametersOutOfRangeAreRefused)
{
  TagPoseParams params;
  params.max_gap = 0.0;
  EXPECT_EQ(refusal([&] { TagPoseTracker(singleTag(0, kSize), params); }), "max_gap is 0, must be above 0 to 60");
  EXPECT_EQ(refusal([] { TagPoseTracker(singleTag(0, -1.0)); }),
            "size of tag 0 of bundle 'tag_0' is -1, must be above 0 (m)");
  TagPoseTracker tracker(singleTag(0, kSize));
  EXPECT_EQ(refusal([&] { tracker.update(std::nan(""), {}, cameras()[0]); }), "time is nan, must be finite (s)");
}
