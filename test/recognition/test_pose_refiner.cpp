#include "robot_vision/recognition/pose_refiner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/object_scenes.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr double kDegree = CV_PI / 180.0;
const CameraModel kCamera = objectCamera(240, 200);

/// The noise that DepthNoise makes, which has nothing in common to all depths of a thing.
DepthErrorParams errorsOf(DepthSensor sensor)
{
  DepthErrorParams errors;
  errors.depth_bias = 0.0;
  errors.depth_correlation = 1;
  if (sensor != DepthSensor::kStereo) return errors;
  errors.depth_noise = 0.0006;  // 2 z^2 / f
  errors.depth_noise_growth = 0.0038;
  errors.depth_step = 0.0;
  errors.depth_correlation = 25;
  return errors;
}

double median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A pose in which the middle of an object is nearly in the middle of the image.
cv::Affine3d posed(const MeshExtent& extent, double distance, cv::RNG& random)
{
  const cv::Matx33d rotation = anyRotation(random);
  const cv::Vec3d place(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), distance);
  return {rotation, place - rotation * extent.center};
}

/// What is seen of an object, before a wall.
struct Shot
{
  cv::Affine3d truth;
  RecognitionFrame frame;
  cv::Mat bgr, depth;

  Shot(const Mesh& mesh, const cv::Affine3d& pose, DepthSensor sensor, int number, bool colors = true,
       bool depths = true, const CameraModel& camera = kCamera)
    : truth(pose), frame(camera)
  {
    ObjectScene scene(camera);
    scene.add(mesh, pose);
    scene.addTable({0.0, 0.0, pose.translation()[2] + 0.25}, {0.1, -0.2, -1.0});
    scene.draw(sensor, number, bgr, depth);
    frame.set(colors ? bgr : cv::Mat(), depths ? depth : cv::Mat());
  }
};

cv::Vec6d errorOf(const RefinedPose& found, const cv::Affine3d& truth)
{
  const cv::Vec3d shift = found.pose.translation() - truth.translation();
  const cv::Vec3d turn = cv::Affine3d(found.pose.rotation() * truth.rotation().t()).rvec();
  return {shift[0], shift[1], shift[2], turn[0], turn[1], turn[2]};
}

/// The normalized squared error of an estimate: 6 on average if its covariance is right.
double normalizedError(const RefinedPose& found, const cv::Affine3d& truth)
{
  const cv::Vec6d error = errorOf(found, truth);
  return error.dot(found.covariance.inv(cv::DECOMP_SVD) * error);
}

struct Errors
{
  double shift, turn;  // mm, degrees: medians
  double normalized;   // mean
};

/// Of poses that are off by so much along each axis at first.
Errors errorsOver(DepthSensor sensor, bool colors, bool depths)
{
  constexpr int kCount = 24;
  constexpr double kShift = 0.005, kTurn = 5.0 * kDegree;
  const Mesh mesh = lBlock();
  const ObjectShape shape(mesh);
  PoseRefiner refiner(RefinerParams(), errorsOf(sensor));
  cv::RNG random(7);
  std::vector<double> shifts, turns;
  double normalized = 0.0;
  for (int i = 0; i < kCount; ++i)
  {
    const Shot shot(mesh, posed(shape.extent(), 0.8, random), sensor, i, colors, depths);
    const cv::Affine3d first = disturbed(shot.truth, shape.extent().center, kShift, kTurn, random);
    const RefinedPose found = refiner.refine(shot.frame, shape, first);
    shifts.push_back(distanceBetween(found.pose, shot.truth, shape.extent().center));
    turns.push_back(angleBetween(found.pose, shot.truth));
    normalized += std::min(normalizedError(found, shot.truth), 60.0) / kCount;
    EXPECT_GE(found.score, found.first_score);
    EXPECT_TRUE(found.free_axes.empty()) << i;
  }
  return {median(shifts), median(turns), normalized};
}

}  // namespace

TEST(PoseRefiner, isWithinOneAndAHalfMillimetresAndDegreesAndKnowsHowMuch)
{
  for (const DepthSensor sensor : {DepthSensor::kKinect, DepthSensor::kStereo})
    for (const bool colors : {true, false})
    {
      const Errors errors = errorsOver(sensor, colors, true);
      EXPECT_LT(errors.shift, 0.8) << static_cast<int>(sensor) << colors;
      EXPECT_LT(errors.turn, 1.0) << static_cast<int>(sensor) << colors;
      EXPECT_GT(errors.normalized, 2.0) << static_cast<int>(sensor) << colors;  // 6 is what it should be
      EXPECT_LT(errors.normalized, 15.0) << static_cast<int>(sensor) << colors;
    }
}

TEST(PoseRefiner, findsAPoseByContoursAlone)
{
  const Errors errors = errorsOver(DepthSensor::kKinect, true, false);
  EXPECT_LT(errors.shift, 4.0);
  EXPECT_LT(errors.turn, 1.5);
  EXPECT_GT(errors.normalized, 0.5);
  EXPECT_LT(errors.normalized, 25.0);
}

TEST(PoseRefiner, contoursTellWhatOneFlatSideDoesNot)
{
  // Seen from the front a box shows one side, which could be anywhere in its plane.
  const Mesh mesh = boxMesh({0.14F, 0.1F, 0.05F}, {60, 60, 190});
  const ObjectShape shape(mesh);
  const cv::Affine3d truth(cv::Matx33d::eye(), cv::Vec3d(0.01, -0.005, 0.8));
  const Shot both(mesh, truth, DepthSensor::kKinect, 1);
  const cv::Affine3d first(cv::Vec3d(0.0, 0.0, 0.08), truth.translation() + cv::Vec3d(0.008, -0.006, 0.0));
  PoseRefiner refiner(RefinerParams(), errorsOf(DepthSensor::kKinect));
  const RefinedPose found = refiner.refine(both.frame, shape, first);
  EXPECT_LT(distanceBetween(found.pose, truth, {}), 0.8);
  EXPECT_LT(angleBetween(found.pose, truth), 0.8);
  // With depths alone they are the jumps of depth at the outline.
  const Shot depths(mesh, truth, DepthSensor::kKinect, 1, false);
  EXPECT_LT(distanceBetween(refiner.refine(depths.frame, shape, first).pose, truth, {}), 1.5);
}

TEST(PoseRefiner, whatIsRoundIsFreeAboutItsAxis)
{
  // Each of its facets looks as if it told the angle.
  const Mesh mesh = cylinderMesh(0.03F, 0.12F, 32, {60, 60, 190});
  cv::RNG random(5);
  const std::vector<Symmetry> known = {{{0.0, 0.0, 1.0}, 0}};
  for (const std::vector<Symmetry>& symmetries : {std::vector<Symmetry>(), known})
    for (const bool depths : {true, false})
    {
      const ObjectShape shape(mesh, symmetries);
      const Shot shot(mesh, cv::Affine3d(cv::Vec3d(1.0, 0.3, 0.2), {0.0, 0.0, 0.8}), DepthSensor::kKinect, 2, true,
                      depths);
      const cv::Affine3d first = disturbed(shot.truth, {}, 0.003, 0.04, random);
      const RefinedPose found = PoseRefiner().refine(shot.frame, shape, first);
      ASSERT_EQ(found.free_axes.size(), 1u) << depths;
      EXPECT_GT(std::abs(found.free_axes[0].direction[2]), 0.999);
      EXPECT_LT(std::hypot(found.free_axes[0].point[0], found.free_axes[0].point[1]), 0.002);
      const cv::Vec3d axis = shot.truth.rotation() * cv::Vec3d(0, 0, 1);
      const cv::Vec3d across = cv::normalize(axis.cross(cv::Vec3d(1, 0, 0)));
      const cv::Matx33d turns = found.covariance.get_minor<3, 3>(3, 3);
      EXPECT_NEAR(std::sqrt(axis.dot(turns * axis)), CV_PI / std::sqrt(3.0), 0.1);  // any angle
      EXPECT_LT(std::sqrt(across.dot(turns * across)), 5.0 * kDegree);
      EXPECT_LT(std::sqrt(found.covariance(0, 0) + found.covariance(1, 1)), 0.01);
      EXPECT_GT((found.pose.rotation() * cv::Vec3d(0, 0, 1)).dot(axis), std::cos((depths ? 1.0 : 4.0) * kDegree));
    }
}

TEST(PoseRefiner, aHiddenPartDoesNoHarm)
{
  const Mesh mesh = lBlock();
  const ObjectShape shape(mesh);
  cv::RNG random(9);
  std::vector<double> shifts;
  for (int i = 0; i < 12; ++i)
  {
    const cv::Affine3d truth = posed(shape.extent(), 0.8, random);
    ObjectScene scene(kCamera);
    scene.add(mesh, truth);
    scene.add(boxMesh({0.1F, 0.2F, 0.02F}, {90, 160, 90}), {cv::Matx33d::eye(), {0.062, 0.0, 0.65}});
    scene.addTable({0.0, 0.0, 1.05}, {0.1, -0.2, -1.0});
    cv::Mat bgr, depth;
    scene.draw(DepthSensor::kKinect, i, bgr, depth);
    RecognitionFrame frame(kCamera);
    frame.set(bgr, depth);
    const cv::Affine3d first = disturbed(truth, shape.extent().center, 0.004, 4.0 * kDegree, random);
    shifts.push_back(distanceBetween(PoseRefiner().refine(frame, shape, first).pose, truth, shape.extent().center));
  }
  EXPECT_LT(median(shifts), 1.5);
}

TEST(PoseRefiner, aPoseIsNeverWorseThanTheFirstOne)
{
  const Mesh mesh = lBlock();
  const ObjectShape shape(mesh);
  cv::RNG random(2);
  const Shot shot(mesh, posed(shape.extent(), 0.8, random), DepthSensor::kStereo, 0);
  PoseRefiner refiner;
  int kept = 0;
  for (int i = 0; i < 30; ++i)
  {
    const cv::Affine3d first = disturbed(shot.truth, shape.extent().center, 0.05, 1.0, random);
    const RefinedPose found = refiner.refine(shot.frame, shape, first);
    EXPECT_GE(found.score, found.first_score);
    kept += angleBetween(found.pose, first) == 0.0 ? 1 : 0;
    EXPECT_TRUE(std::isfinite(cv::norm(found.covariance)));
  }
  EXPECT_LT(kept, 30);
  const RefinedPose exact = refiner.refine(shot.frame, shape, shot.truth);
  EXPECT_LT(distanceBetween(exact.pose, shot.truth, shape.extent().center), 1.0);
}

TEST(PoseRefiner, biasOfTheSensorIsAlongTheRay)
{
  const Mesh mesh = lBlock();
  const ObjectShape shape(mesh);
  cv::RNG random(4);
  const Shot shot(mesh, posed(shape.extent(), 0.8, random), DepthSensor::kKinect, 0);
  DepthErrorParams errors;
  const auto covarianceWith = [&](double bias)
  {
    errors.depth_bias = bias;
    return PoseRefiner(RefinerParams(), errors).refine(shot.frame, shape, shot.truth).covariance;
  };
  const cv::Matx66d more = covarianceWith(0.02) - covarianceWith(0.0);
  EXPECT_NEAR(more(2, 2), 0.0004, 1e-6);
  EXPECT_LT(more(0, 0), 0.00001);
  EXPECT_LT(std::abs(more(3, 3)), 1e-9);
}

TEST(PoseRefiner, nothingToCompareWithLeavesThePose)
{
  const Mesh mesh = lBlock();
  const ObjectShape shape(mesh);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const cv::Affine3d before(cv::Matx33d::eye(), cv::Vec3d(0.0, 0.0, 0.8));
  PoseRefiner refiner;
  RecognitionFrame frame(kCamera);
  for (const float value : {nan, inf, -1.0F, 0.0F})
  {
    frame.set(cv::Mat(), cv::Mat(200, 240, CV_32FC1, cv::Scalar(value)));
    const RefinedPose found = refiner.refine(frame, shape, before);
    EXPECT_EQ(angleBetween(found.pose, before), 0.0) << value;
    EXPECT_GT(found.covariance(0, 0), 0.01) << value;
  }
  for (const cv::Vec3d& place : {cv::Vec3d(5.0, 0.0, 0.8), cv::Vec3d(0.0, 0.0, -0.8), cv::Vec3d(0.0, 0.0, 0.0),
                                 cv::Vec3d(0.0, 0.0, 900.0)})  // outside, behind, around the camera, too far
  {
    const RefinedPose found = refiner.refine(frame, shape, {cv::Matx33d::eye(), place});
    EXPECT_EQ(found.pose.translation(), place);
    EXPECT_EQ(found.score, 0.0) << place[0];
    EXPECT_TRUE(std::isfinite(cv::norm(found.covariance)));
  }
}

TEST(PoseRefiner, imagesOfAnySizeAndOfMillimetresWillDo)
{
  const Mesh mesh = lBlock();
  const ObjectShape shape(mesh);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(161, 117)})
  {
    const CameraModel camera = objectCamera(size.width, size.height, 300.0);
    ObjectScene scene(camera);
    const cv::Affine3d truth(cv::Matx33d::eye(), cv::Vec3d(-0.05, -0.04, 0.6));
    scene.add(mesh, truth);
    cv::Mat bgr, depth, millimetres;
    scene.draw(DepthSensor::kExact, 0, bgr, depth);
    depth.convertTo(millimetres, CV_16UC1, 1000.0);
    RecognitionFrame frame(camera);
    cv::Mat padded(size.height, size.width + 3, CV_16UC1);
    millimetres.copyTo(padded.colRange(0, size.width));
    frame.set(bgr, padded.colRange(0, size.width), "16UC1");
    const RefinedPose found = PoseRefiner().refine(frame, shape, {cv::Matx33d::eye(), cv::Vec3d(-0.05, -0.04, 0.605)});
    if (size.width > 100)
    {
      EXPECT_NEAR(found.pose.translation()[2], 0.6, 0.001);
    }
  }
}

TEST(PoseRefiner, whatCannotBeIsRefused)
{
  EXPECT_EQ(refusalWith(&RefinerParams::levels, 0), "levels is 0, must be from 1 to 10");
  const ObjectShape shape(lBlock());
  RecognitionFrame frame(kCamera);
  EXPECT_EQ(refusal([&] { PoseRefiner().refine(frame, shape, cv::Affine3d::Identity()); }),
            "the frame is empty, must be set");
  EXPECT_EQ(refusal([&] { frame.set(cv::Mat(), cv::Mat()); }),
            "the frame is empty, must be an image of colors, of depths, or both");
  EXPECT_EQ(refusal([&] { frame.set(cv::Mat(4, 4, CV_8UC3), cv::Mat()); }),
            "the size of the color image is 4x4, must be 240x200 as of its camera");
  cv::Affine3d wrong = cv::Affine3d::Identity();
  wrong.matrix(0, 3) = std::numeric_limits<double>::quiet_NaN();
  frame.set(cv::Mat::zeros(200, 240, CV_8UC3), cv::Mat());
  EXPECT_EQ(refusal([&] { PoseRefiner().refine(frame, shape, wrong); }),
            "the first pose is nan, must be from -1000 to 1000");
  wrong = cv::Affine3d(2.0 * cv::Matx33d::eye(), cv::Vec3d());
  EXPECT_EQ(refusal([&] { PoseRefiner().refine(frame, shape, wrong); }),
            "the first pose is no rotation and translation, must be that of a rigid body");
  CameraModel bent = kCamera;
  bent.D = {0.1, 0.0, 0.0, 0.0};
  EXPECT_EQ(refusal([&] { RecognitionFrame(bent).size(); }),
            "the distortion of the camera is that of a lens, must be none: its images must be rectified");
  EXPECT_EQ(refusal(
                [&] {
                  ObjectShape(lBlock(), {{{0.0, 0.0, 0.0}, 0}});
                }),
            "the axis of a symmetry is 0, 0, 0, must be a direction: finite, and not zero");
}
