#include "robot_vision/recognition/point_pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/recognition/pose_clusters.hpp"
#include "robot_vision/recognition/pose_refiner.hpp"
#include "support/object_scenes.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const CameraModel kCamera = objectCamera(320, 240);

const PointPairModel& blockModel()
{
  static const PointPairModel model = trainPointPairs(lBlock());
  return model;
}

PointPairModel fromBytes(const std::vector<std::uint8_t>& bytes)
{
  return pointPairModelFromBytes(bytes.data(), bytes.size());
}

}  // namespace

TEST(PointPairs, theModelIsPointsAllOverTheSurface)
{
  const PointPairModel model = trainPointPairs(boxMesh({0.2F, 0.1F, 0.06F}, {}));
  const double distance = model.params.sampling * model.extent.diameter;
  EXPECT_NEAR(model.extent.diameter, std::sqrt(0.04 + 0.01 + 0.0036), 1e-6);
  const cv::Vec3f half(0.1F, 0.05F, 0.03F);
  std::vector<int> of_sides(6, 0);
  for (std::size_t i = 0; i < model.points.size(); ++i)
  {
    int side = -1;
    for (int axis = 0; axis < 3; ++axis)
    {
      EXPECT_LE(std::abs(model.points[i][axis]), half[axis] + 1e-6F);
      if (std::abs(model.normals[i][axis]) < 0.99F) continue;
      side = 2 * axis + (model.normals[i][axis] > 0.0F ? 1 : 0);
      EXPECT_NEAR(model.points[i][axis], std::copysign(half[axis], model.normals[i][axis]), 1e-6F);  // outwards
    }
    ASSERT_GE(side, 0);
    ++of_sides[static_cast<std::size_t>(side)];
    for (std::size_t j = 0; j < i; ++j)
      if (model.normals[i].dot(model.normals[j]) > 0.9F)
      {
        EXPECT_GE(cv::norm(model.points[i] - model.points[j]), 0.999 * distance);
      }
  }
  const double areas[] = {0.006, 0.006, 0.012, 0.012, 0.02, 0.02};
  for (std::size_t i = 0; i < 6; ++i)  // the densest packing has 1.15 points a square, an even grid 1
  {
    EXPECT_GT(of_sides[i], 0.6 * areas[i] / (distance * distance)) << i;
    EXPECT_LT(of_sides[i], 2.0 * areas[i] / (distance * distance)) << i;
  }
  const PointPairModel again = trainPointPairs(boxMesh({0.2F, 0.1F, 0.06F}, {}));
  EXPECT_EQ(toBytes(model), toBytes(again));
}

TEST(PointPairs, findTheBlockWhereverItIs)
{
  PointPairMatcher matcher;
  ASSERT_EQ(matcher.add(blockModel()), 0);
  const MeshExtent& extent = blockModel().extent;
  cv::RNG random(5);
  int found = 0, best = 0;
  for (int i = 0; i < 10; ++i)
  {
    const cv::Matx33d rotation = anyRotation(random);
    const cv::Affine3d truth(rotation, cv::Vec3d(random.uniform(-0.1, 0.1), -0.02, 0.75) - rotation * extent.center);
    ObjectScene scene(kCamera);
    scene.addTable({0.0, 0.05, 0.8}, {0.0, -0.8, -0.6});
    scene.add(lBlock(), truth);
    scene.add(cylinderMesh(0.03F, 0.1F, 24, {}), {cv::Matx33d::eye(), cv::Vec3d(-0.2, 0.05, 0.8)});
    cv::Mat bgr, depth;
    scene.draw(i % 2 == 0 ? DepthSensor::kKinect : DepthSensor::kStereo, i, bgr, depth);
    RecognitionFrame frame(kCamera);
    frame.set(cv::Mat(), depth);
    const std::vector<PoseCandidate> candidates = matcher.match(frame);
    const auto isRight = [&](const PoseCandidate& candidate)
    {
      EXPECT_GE(candidate.score, 0.0);
      EXPECT_LE(candidate.score, 1.0);
      return distanceBetween(candidate.pose, truth, extent.center) < 20.0 && angleBetween(candidate.pose, truth) < 20.0;
    };
    ASSERT_FALSE(candidates.empty());
    best += isRight(candidates.front()) ? 1 : 0;
    found += std::any_of(candidates.begin(), candidates.end(), isRight) ? 1 : 0;
  }
  EXPECT_GE(found, 8);
  EXPECT_GE(best, 5);
}

TEST(PointPairs, modelsAreToldApartByTheirIndex)
{
  PointPairMatcher matcher;
  matcher.add(trainPointPairs(cylinderMesh(0.03F, 0.1F, 24, {})));
  EXPECT_EQ(matcher.add(blockModel()), 1);
  const cv::Affine3d truth(cv::Vec3d(2.0, 0.5, 0.3), {0.0, 0.0, 0.7});
  ObjectScene scene(kCamera);
  scene.addTable({0.0, 0.05, 0.8}, {0.0, -0.8, -0.6});
  scene.add(lBlock(), truth);
  cv::Mat bgr, depth;
  scene.draw(DepthSensor::kKinect, 0, bgr, depth);
  RecognitionFrame frame(kCamera);
  frame.set(cv::Mat(), depth);
  const std::vector<PoseCandidate> candidates = matcher.match(frame);
  const auto first =
      std::find_if(candidates.begin(), candidates.end(), [](const PoseCandidate& c) { return c.model == 1; });
  ASSERT_NE(first, candidates.end());
  EXPECT_LT(distanceBetween(first->pose, truth, blockModel().extent.center), 20.0);
  EXPECT_TRUE(std::is_sorted(candidates.begin(), candidates.end(),
                             [](const PoseCandidate& a, const PoseCandidate& b) { return a.model < b.model; }));
}

TEST(PointPairs, findNothingWhereNothingIs)
{
  PointPairMatcher matcher;
  RecognitionFrame frame(kCamera);
  frame.set(cv::Mat(), cv::Mat(240, 320, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN())));
  EXPECT_TRUE(matcher.match(frame).empty());  // without models
  matcher.add(blockModel());
  EXPECT_TRUE(matcher.match(frame).empty());
  frame.set(cv::Mat(), cv::Mat(240, 320, CV_32FC1, cv::Scalar(1.0F)));  // a wall
  EXPECT_TRUE(matcher.match(frame).empty());
  frame.set(cv::Mat::zeros(240, 320, CV_8UC3), cv::Mat());
  EXPECT_TRUE(matcher.match(frame).empty());
  const CameraModel tiny = objectCamera(3, 2);
  RecognitionFrame pixels(tiny);
  pixels.set(cv::Mat(), cv::Mat::ones(2, 3, CV_32FC1));
  EXPECT_TRUE(matcher.match(pixels).empty());
}

TEST(PointPairs, bytesGiveTheSameModelBack)
{
  const PointPairModel back = fromBytes(toBytes(blockModel()));
  EXPECT_EQ(back.points, blockModel().points);
  EXPECT_EQ(back.normals, blockModel().normals);
  EXPECT_EQ(back.extent.diameter, blockModel().extent.diameter);
  EXPECT_EQ(back.params.sampling, blockModel().params.sampling);
}

TEST(PointPairs, damagedBytesAreRefusedOrAModel)
{
  const std::vector<std::uint8_t> bytes = toBytes(blockModel());
  for (std::size_t size = 0; size < bytes.size(); size += 97)
    EXPECT_NE(refusal([&] { pointPairModelFromBytes(bytes.data(), size); }), "") << size;
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_NE(refusal([&] { fromBytes(longer); }), "");
  for (std::size_t i = 0; i < bytes.size(); i += i < 200 ? 1 : 97)
    for (const std::uint8_t flip : {0x01, 0x40, 0xFF})
    {
      std::vector<std::uint8_t> damaged = bytes;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ flip);
      const std::string reason = refusal([&] { validate(fromBytes(damaged)); });
      if (i < 16)
      {
        EXPECT_NE(reason, "") << i;
      }
    }
  std::vector<std::uint8_t> newer = bytes;
  newer[8] = 9;
  EXPECT_EQ(refusal([&] { fromBytes(newer); }),
            "the version of a trained model is 9, must be at most 1: a newer version of this package has made it");
}

TEST(PointPairs, whatCannotBeIsRefused)
{
  PointPairParams params;
  params.sampling = 0.02;
  EXPECT_EQ(refusalWith(&PointPairParams::angle_steps, 1), "angle_steps is 1, must be from 8 to 120");
  EXPECT_EQ(refusalWith(&PointPairMatchParams::max_points, 0), "max_points is 0, must be from 10 to 1e+06");
  EXPECT_EQ(refusal([] { trainPointPairs(Mesh()); }).substr(0, 3), "num");
  Mesh many = cylinderMesh(0.05F, 0.02F, 64, {});
  for (float z = 0.01F; z < 0.6F; z += 0.02F)  // a pile of discs
  {
    Mesh disc = cylinderMesh(0.3F, 0.001F, 64, {});
    for (cv::Vec3f& vertex : disc.vertices)
      vertex[2] += z;
    append(many, disc);
  }
  const std::string reason = refusal([&] { trainPointPairs(many, params); });
  EXPECT_NE(reason.find("must be from 10 to 5000, as another sampling than 0.02 gives"), std::string::npos) << reason;
  PointPairModel wrong = blockModel();
  wrong.normals[0] *= 2.0F;
  EXPECT_EQ(refusal([&] { toBytes(wrong); }), "the length of a normal of the model is 2, must be from 0.999 to 1.001");
  RecognitionFrame frame(kCamera);
  EXPECT_EQ(refusal([&] { PointPairMatcher().match(frame); }), "the frame is empty, must be set");
}

TEST(PoseClusters, arePosesThatAreNear)
{
  const auto pose = [](double turn, double x) { return cv::Affine3d(cv::Vec3d(0, 0, turn), {x, 0.0, 1.0}); };
  const std::vector<VotedPose> means = clusterPoses(
      {{pose(0.0, 0.0), 3.0, 0.1}, {pose(0.1, 0.01), 5.0, 0.2}, {pose(2.0, 0.0), 6.0, 0.3}, {pose(0.0, 0.5), 1.0, 0.9}},
      {}, 0.05, 0.3);
  ASSERT_EQ(means.size(), 3u);
  EXPECT_EQ(means[0].votes, 8.0);
  EXPECT_EQ(means[0].share, 0.2);
  EXPECT_NEAR(means[0].pose.translation()[0], 0.01 * 5.0 / 8.0, 1e-12);
  EXPECT_NEAR(means[0].pose.rvec()[2], 0.1 * 5.0 / 8.0, 1e-3);
  EXPECT_EQ(means[1].votes, 6.0);
  EXPECT_EQ(means[2].votes, 1.0);
  EXPECT_TRUE(clusterPoses({}, {}, 0.1, 0.1).empty());
}
