#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/rigid_motion.hpp"
#include "core/tags/pose/pose_refinement.hpp"
#include "robot_vision/tags/pose/tag_plane.hpp"
#include "robot_vision/tags/pose/tag_pose.hpp"
#include "robot_vision/tags/pose/tag_pose_tracker.hpp"
#include "support/refusal.hpp"
#include "support/tag_views.hpp"

using namespace robot_vision;

namespace
{

const CameraModel kCamera{640, 480, kK, {-0.25, 0.07, 0.001, -0.002, 0.0}, "plumb_bob"};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The inverse depth of a tag's plane.
cv::Vec3d planeOf(const cv::Affine3d& tag)
{
  const cv::Vec3d normal = tag.rotation() * cv::Vec3d(0, 0, 1);
  return normal * (1.0 / normal.dot(tag.translation()));
}

/// The depth image (m) of a tag's plane near its corners, and of nothing elsewhere.
cv::Mat depthOf(const cv::Affine3d& tag, const CameraModel& camera)
{
  const TagCorners corners = seenTag(tag, camera);
  cv::Rect2d box(corners.corners[0], corners.corners[2]);
  for (const cv::Point2d& corner : corners.corners)
    box |= cv::Rect2d(corner, cv::Size2d(1, 1));
  const cv::Vec3d plane = planeOf(tag);
  cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(kNan));
  for (int y = std::max(cvFloor(box.y), 0); y < std::min<double>(box.y + box.height, depth.rows); ++y)
    for (int x = std::max(cvFloor(box.x), 0); x < std::min<double>(box.x + box.width, depth.cols); ++x)
    {
      const cv::Point2d ray = camera.ray(cv::Point2d(x, y));
      depth.at<float>(y, x) = static_cast<float>(1.0 / plane.dot(cv::Vec3d(ray.x, ray.y, 1.0)));
    }
  return depth;
}

/// Adds to each depth noise as these parameters tell, and to all of them the same bias.
void addNoise(cv::RNG& random, const DepthErrorParams& params, cv::Mat& depth)
{
  const double bias = random.gaussian(params.depth_bias);
  for (float& z : cv::Mat_<float>(depth))
  {
    if (std::isnan(z)) continue;
    const double beyond = std::max(static_cast<double>(z) - 0.4, 0.0);
    z += static_cast<float>(random.gaussian(params.depth_noise + params.depth_noise_growth * beyond * beyond) + bias);
  }
}

TagCorners noisy(TagCorners corners, cv::RNG& random, double noise)
{
  for (cv::Point2d& corner : corners.corners)
    corner += cv::Point2d(random.gaussian(noise), random.gaussian(noise));
  return corners;
}

/// The errors of a single tag's poses over many frames with noise.
struct Errors
{
  double tilt = 0.0;         // rad, root mean square
  double distance = 0.0;     // m, root mean square
  double consistency = 0.0;  // mean squared error by the covariance, divided by the degrees of freedom
  int wrong = 0;             // poses that are tilted by more than a third of the angle between the two
  int planes = 0;            // that the poses explain
};

constexpr int kFrames = 150;

Errors errorsOf(const cv::Affine3d& truth, double corner_noise, bool with_depth)
{
  DepthErrorParams params;
  params.depth_step = 0.0;
  params.depth_correlation = 1;
  cv::RNG random(7), depth_random(8);  // the corners are the same with depths and without
  Errors errors;
  const cv::Mat exact = depthOf(truth, kCamera);
  for (int i = 0; i < kFrames; ++i)
  {
    TagCorners corners = noisy(seenTag(truth, kCamera), random, corner_noise);
    if (with_depth)
    {
      cv::Mat depth = exact.clone();
      addNoise(depth_random, params, depth);
      corners.plane = measureTagPlane(depth, corners.corners, kCamera, params);
    }
    const auto poses = estimatePose(singleTag(0, kSize), {corners}, kCamera, corner_noise, 0.0);
    EXPECT_TRUE(poses);
    const PoseEstimate& best = poses->best;
    const cv::Vec6d error = difference(best.pose, truth);
    const double tilt = std::acos(std::min(
        1.0, planeOf(best.pose).dot(planeOf(truth)) / cv::norm(planeOf(best.pose)) / cv::norm(planeOf(truth))));
    errors.tilt += tilt * tilt / kFrames;
    errors.distance += std::pow(error[2], 2) / kFrames;
    errors.consistency += error.dot(best.covariance.solve(error, cv::DECOMP_SVD)) / 6.0 / kFrames;
    errors.wrong += tilt > 0.35;
    errors.planes += poses->planes;
  }
  errors.tilt = std::sqrt(errors.tilt);
  errors.distance = std::sqrt(errors.distance);
  return errors;
}

}  // namespace

TEST(TagPlane, isThatOfTheTag)
{
  for (const double distance : {0.5, 1.0, 2.5})
    for (const double tilt : {0.0, 0.5, 1.1})
    {
      const cv::Affine3d tag = facing({tilt, 0.3, 0.2}, {0.1 * distance, -0.05 * distance, distance});
      const TagCorners corners = seenTag(tag, kCamera);
      const cv::Mat depth = depthOf(tag, kCamera);
      const auto plane = measureTagPlane(depth, corners.corners, kCamera);
      ASSERT_TRUE(plane);
      EXPECT_LT(cv::norm(plane->inverse_depth - planeOf(tag)), 1e-5);
      EXPECT_GT(plane->pixels, 12);
      EXPECT_LE(plane->pixels, 2200);
      cv::Mat millimetres;
      depth.convertTo(millimetres, CV_16U, 1000.0);  // NaN becomes 0
      millimetres.setTo(0, ~(depth == depth));       // OpenCV's != may not know NaN
      const auto rounded = measureTagPlane(millimetres, corners.corners, kCamera);
      ASSERT_TRUE(rounded);
      const cv::Vec3d change = rounded->inverse_depth - plane->inverse_depth;
      EXPECT_LT(change.dot(rounded->covariance.solve(change, cv::DECOMP_SVD)), 1.0);
    }
}

TEST(TagPlane, isNotThatOfWhatCoversAPart)
{
  const cv::Affine3d tag = facing({0.4, 0.2, 0.0}, {0, 0, 1});
  const TagCorners corners = seenTag(tag, kCamera);
  cv::Mat depth = depthOf(tag, kCamera);
  depth(cv::Rect(300, 180, 20, 120)) -= 0.1F;  // a finger before it, on a sixth of the tag
  depth.at<float>(250, 330) = std::numeric_limits<float>::infinity();
  depth.at<float>(251, 331) = -1.0F;
  depth.at<float>(252, 332) = 0.0F;
  const auto plane = measureTagPlane(depth, corners.corners, kCamera);
  ASSERT_TRUE(plane);
  EXPECT_LT(cv::norm(plane->inverse_depth - planeOf(tag)), 1e-4);
}

TEST(TagPlane, needsEnoughDepthsThatAgree)
{
  const cv::Affine3d tag = facing({0.4, 0.2, 0.0}, {0, 0, 1});
  const TagCorners corners = seenTag(tag, kCamera);
  EXPECT_FALSE(measureTagPlane(cv::Mat(480, 640, CV_32FC1, cv::Scalar(kNan)), corners.corners, kCamera));
  EXPECT_FALSE(measureTagPlane(cv::Mat(480, 640, CV_16UC1, cv::Scalar(0)), corners.corners, kCamera));
  cv::Mat line(480, 640, CV_32FC1, cv::Scalar(kNan));
  depthOf(tag, kCamera).row(240).copyTo(line.row(240));
  EXPECT_FALSE(measureTagPlane(line, corners.corners, kCamera));
  cv::Mat half_covered = depthOf(tag, kCamera);
  half_covered.colRange(0, 320) -= 0.3F;
  EXPECT_FALSE(measureTagPlane(half_covered, corners.corners, kCamera));
}

TEST(TagPlane, refusesWhatIsNoDepthOfTheCamera)
{
  const std::array<cv::Point2d, 4> corners = seenTag(facing({0, 0, 0}, {0, 0, 1}), kCamera).corners;
  const auto refused = [&](const cv::Mat& depth, const DepthErrorParams& params = {})
  { return refusal([&] { measureTagPlane(depth, corners, kCamera, params); }); };
  EXPECT_EQ(refused(cv::Mat(480, 640, CV_8UC1)),
            "type of the depth image is CV_8UC1, must be CV_32FC1 (m) or CV_16UC1 (mm)");
  EXPECT_EQ(refused(cv::Mat(240, 320, CV_32FC1)),
            "size of the depth image is 320x240, must be that of the camera, 640x480");
  DepthErrorParams params;
  params.depth_noise = 0.0;
  EXPECT_EQ(refused(cv::Mat(480, 640, CV_32FC1), params), "depth_noise is 0, must be from 1e-05 to 1");
}

TEST(TagPlane, isNoneOfCornersThatAreInNoImage)
{
  const cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(1.0));
  const std::array<cv::Point2d, 4> corners = {{{100, 300}, {300, 300}, {300, 100}, {100, 100}}};
  EXPECT_TRUE(measureTagPlane(depth, corners, kCamera));
  for (const double far : {1e10, -1e300, std::numeric_limits<double>::quiet_NaN()})
  {
    std::array<cv::Point2d, 4> odd = corners;
    odd[1] = {std::abs(far), far};
    EXPECT_FALSE(measureTagPlane(depth, odd, kCamera)) << far;
  }
}

TEST(TagPlane, movesWithThePoseAsItsDerivativesSay)
{
  const SeenPlane plane{{0.1, 0.2, 0.97}, {0.05, -0.02, 0.1}, {}, {}};
  const cv::Affine3d pose = facing({0.5, -0.3, 0.2}, {0.2, 0.1, 1.5});
  const PlaneJacobian jacobian = planeJacobian(plane, pose);
  const auto inverseDepth = [&](const cv::Affine3d& at)
  {
    const cv::Vec3d normal = at.rotation() * plane.normal;
    return normal * (1.0 / normal.dot(at * plane.point));
  };
  const double step = 1e-5;
  for (int i = 0; i < 6; ++i)
  {
    cv::Vec6d by;
    by[i] = step;
    const cv::Vec3d change = (inverseDepth(moved(pose, by)) - inverseDepth(moved(pose, by * -1.0))) * (0.5 / step);
    for (int row = 0; row < 3; ++row)
      EXPECT_NEAR(jacobian(row, i), change[row], 1e-6) << row << ", " << i;
  }
}

TEST(TagPoseWithDepth, isMuchLessTiltedWhereTheTagFacesTheCamera)
{
  const cv::Affine3d truth = facing({0.09, 0.0, 0.3}, {0.1, 0.05, 1.5});
  const Errors corners = errorsOf(truth, 0.3, false);
  const Errors fused = errorsOf(truth, 0.3, true);
  EXPECT_LT(fused.tilt, 0.5 * corners.tilt);
  EXPECT_LT(fused.distance, 1.05 * corners.distance);
  EXPECT_GT(fused.consistency, 0.75);
  EXPECT_LT(fused.consistency, 1.3);
}

TEST(TagPoseWithDepth, takesPlanesOfTagsWhoseCornersLeaveTheTiltOpen)
{
  const cv::Affine3d truth = facing({0.17, 0.0, 0.3}, {0.1, 0.05, 2.0});
  const Errors corners = errorsOf(truth, 0.3, false);
  const Errors fused = errorsOf(truth, 0.3, true);
  EXPECT_EQ(corners.planes, 0);
  EXPECT_GE(fused.planes, kFrames - 2);
  EXPECT_LT(fused.tilt, 0.5 * corners.tilt);
}

TEST(TagPoseWithDepth, isNeverWorseAtAnyTilt)
{
  for (const double tilt : {0.3, 0.6, 0.9, 1.2})
  {
    const cv::Affine3d truth = facing({0.0, tilt, 0.1}, {-0.1, 0.1, 1.2});
    const Errors corners = errorsOf(truth, 0.2, false);
    const Errors fused = errorsOf(truth, 0.2, true);
    EXPECT_LT(fused.tilt, 1.02 * corners.tilt) << tilt;
    EXPECT_LT(fused.distance, 1.02 * corners.distance) << tilt;
    EXPECT_GT(fused.consistency, 0.7) << tilt;
    EXPECT_LT(fused.consistency, 1.35) << tilt;
  }
}

TEST(TagPoseWithDepth, isTheRightOneOfTwoForSmallTags)
{
  const cv::Affine3d truth = facing({0.6, 0.0, 0.0}, {0, 0, 6});  // 20 px, at 30 cm of the sensor's noise and more
  const Errors corners = errorsOf(truth, 0.3, false);
  const Errors fused = errorsOf(truth, 0.3, true);
  EXPECT_GT(corners.wrong, kFrames / 20);
  EXPECT_LT(fused.tilt, 0.5 * corners.tilt);
}

TEST(TagPoseWithDepth, leavesOutThePlaneOfSomethingElse)
{
  const cv::Affine3d truth = facing({0.5, 0.2, 0.0}, {0, 0, 1});
  TagCorners corners = seenTag(truth, kCamera);
  const PoseEstimate alone = estimatePose(singleTag(0, kSize), {corners}, kCamera, 0.2, 0.0)->best;
  corners.plane = measureTagPlane(depthOf(truth, kCamera) + 0.3F, corners.corners, kCamera);
  ASSERT_TRUE(corners.plane);
  const auto poses = estimatePose(singleTag(0, kSize), {corners}, kCamera, 0.2, 0.0);
  EXPECT_EQ(poses->planes, 0);
  EXPECT_EQ(poses->best.pose.matrix, alone.pose.matrix);
  EXPECT_EQ(poses->best.covariance, alone.covariance);
}

TEST(TagPoseWithDepth, refusesWhatIsNoPlane)
{
  TagCorners corners = seenTag(facing({0.5, 0.2, 0.0}, {0, 0, 1}), kCamera);
  corners.plane = DepthPlane{{0, 0, std::nan("")}, cv::Matx33d::eye(), 20};
  const std::string rule = "plane of depths is none, must be finite, with a symmetric and positive definite covariance";
  const auto estimate = [&] { estimatePose(singleTag(0, kSize), {corners}, kCamera, 0.2, 0.0); };
  EXPECT_EQ(refusal(estimate), rule);
  corners.plane = DepthPlane{{0, 0, 1}, cv::Matx33d::zeros(), 20};
  EXPECT_EQ(refusal(estimate), rule);
}

TEST(TagPoseWithDepth, isThatOfABundle)
{
  const Bundle bundle{"box",
                      {{0, kSize, cv::Affine3d(cv::Vec3d(0, 0.5, 0), cv::Vec3d(-0.15, 0, 0)), 0.001, 0.01},
                       {1, kSize, cv::Affine3d(cv::Vec3d(0, -0.6, 0), cv::Vec3d(0.25, 0, -0.05)), 0.001, 0.01}}};
  const cv::Affine3d truth = facing({0.1, 0.0, 0.0}, {0, 0, 2});
  std::vector<TagCorners> tags;
  for (const BundleTag& tag : bundle.tags)
  {
    tags.push_back(seen(tag, truth, kCamera));
    tags.back().plane = measureTagPlane(depthOf(truth * tag.pose, kCamera), tags.back().corners, kCamera);
    ASSERT_TRUE(tags.back().plane);
  }
  const auto poses = estimatePose(bundle, tags, kCamera, 0.3, 0.0);
  EXPECT_EQ(poses->planes, 2);
  EXPECT_LT(angleBetween(poses->best.pose, truth), 1e-3);
  EXPECT_LT(distanceBetween(poses->best.pose, truth), 1e-3);
}

TEST(TagPoseTracker, takesPlanesToo)
{
  const cv::Affine3d truth = facing({0.03, 0.0, 0.0}, {0, 0, 2});
  TagPoseTracker tracker(singleTag(0, kSize));
  TagPoseTracker without(singleTag(0, kSize));
  cv::RNG random(5);
  DepthErrorParams params;
  double sum = 0.0;
  double sum_without = 0.0;
  for (int i = 0; i < 40; ++i)
  {
    TagCorners corners = noisy(seenTag(truth, kCamera), random, 0.3);
    sum_without += angleBetween(without.update(i / 30.0, {corners}, kCamera)->best.pose, truth);
    cv::Mat depth = depthOf(truth, kCamera);
    addNoise(random, params, depth);
    corners.plane = measureTagPlane(depth, corners.corners, kCamera, params);
    sum += angleBetween(tracker.update(i / 30.0, {corners}, kCamera)->best.pose, truth);
  }
  EXPECT_LT(sum, 0.6 * sum_without);
}
