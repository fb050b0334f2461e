#include "robot_vision/recognition/object_recognizer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/recognition/coarse_check.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "robot_vision/recognition/pose_refiner.hpp"
#include "support/cluttered_scenes.hpp"
#include "support/object_scenes.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const CameraModel kCamera = objectCamera(320, 240);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Two blocks of different shapes, and a rod, on a table.
struct Kitchen
{
  Mesh block = lBlock(), box = boxMesh({0.1F, 0.06F, 0.05F}, {60, 180, 60}),
       rod = cylinderMesh(0.02F, 0.12F, 32, {200, 90, 40});
  cv::Affine3d block_pose{cv::Matx33d(0.8, 0.6, 0, 0.36, -0.48, -0.8, -0.48, 0.64, -0.6).t(), {-0.12, -0.01, 0.72}};
  cv::Affine3d box_pose{cv::Affine3d(cv::Vec3d(0.9, 0.3, 0.2)).rotation(), {0.06, 0.02, 0.75}};
  cv::Affine3d rod_pose{cv::Affine3d(cv::Vec3d(1.2, 0.2, 0.1)).rotation(), {0.17, 0.0, 0.8}};
  cv::Mat bgr, depth;
  RecognitionFrame frame{kCamera};

  Kitchen()
  {
    ObjectScene scene(kCamera);
    scene.addTable({0.0, 0.08, 0.8}, {0.0, -0.8, -0.6});
    scene.add(block, block_pose);
    scene.add(box, box_pose);
    scene.add(rod, rod_pose);
    scene.draw(DepthSensor::kKinect, 0, bgr, depth);
    frame.set(bgr, depth);
  }
};

const Kitchen& kitchen()
{
  static const Kitchen one;
  return one;
}

/// Candidates near a pose, some of them hopeless.
std::vector<PoseCandidate> candidatesNear(int model, const cv::Affine3d& pose, const cv::Vec3d& center, int count,
                                          cv::RNG& random)
{
  std::vector<PoseCandidate> candidates;
  for (int i = 0; i < count; ++i)
  {
    PoseCandidate candidate;
    candidate.model = model;
    candidate.pose = disturbed(pose, center, 0.005 * (1 + i), 0.06 * (1 + i), random);
    candidate.score = 0.9 - 0.05 * i;
    candidates.push_back(candidate);
  }
  return candidates;
}

struct Models
{
  std::shared_ptr<const ObjectShape> block = std::make_shared<ObjectShape>(kitchen().block),
                                     box = std::make_shared<ObjectShape>(kitchen().box),
                                     rod = std::make_shared<ObjectShape>(kitchen().rod);
};

const Models& models()
{
  static const Models all;
  return all;
}

}  // namespace

TEST(ObjectRecognizer, findsEachObjectOnceWhereItIs)
{
  ObjectRecognizer recognizer;
  EXPECT_EQ(recognizer.add(models().block), 0);
  EXPECT_EQ(recognizer.add(models().box), 1);
  EXPECT_EQ(recognizer.add(models().rod), 2);
  cv::RNG random(3);
  std::vector<PoseCandidate> candidates;
  const cv::Affine3d poses[] = {kitchen().block_pose, kitchen().box_pose, kitchen().rod_pose};
  const std::shared_ptr<const ObjectShape> shapes[] = {models().block, models().box, models().rod};
  for (int model = 0; model < 3; ++model)
    for (int place = 0; place < 3; ++place)  // each model is looked for where the others are, too
    {
      const cv::Vec3d center = shapes[model]->extent().center;
      const cv::Affine3d pose(poses[place].rotation(),
                              poses[place] * shapes[place]->extent().center - poses[place].rotation() * center);
      const auto more = candidatesNear(model, pose, center, 4, random);
      candidates.insert(candidates.end(), more.begin(), more.end());
    }
  const Recognition found = recognizer.recognize(kitchen().frame, candidates);
  ASSERT_EQ(found.objects.size(), 3u);
  std::vector<int> seen(3, 0);
  for (const RecognizedObject& object : found.objects)
  {
    ++seen[static_cast<std::size_t>(object.model)];
    const cv::Vec3d center = shapes[object.model]->extent().center;
    EXPECT_LT(distanceBetween(object.pose, poses[object.model], center), 1.5) << object.model;
    EXPECT_GT(object.probability, 0.9) << object.model;
    EXPECT_LT(object.occlusion, 0.1) << object.model;
    EXPECT_EQ(object.free_axes.size(), object.model == 2 ? 1u : 0u);
    if (object.model < 2)
    {
      EXPECT_LT(angleBetween(object.pose, poses[object.model]), 1.5);
    }
    const cv::Point2d middle = kCamera.project(cv::Point3d(poses[object.model] * center));
    EXPECT_TRUE(object.box.contains(cv::Point(middle))) << object.model;
  }
  EXPECT_EQ(seen, (std::vector<int>{1, 1, 1}));
  ASSERT_EQ(found.reports.size(), 3u);
  for (const ModelReport& report : found.reports)
  {
    EXPECT_EQ(report.candidates, 12);
    EXPECT_EQ(report.found, 1);
    EXPECT_EQ(reasonText(report), "found");
  }
}

/// Ten equal blocks on a table, with two poses each that are nearly right.
struct Blocks
{
  std::vector<cv::Affine3d> poses;
  std::vector<PoseCandidate> candidates;
  RecognitionFrame frame{objectCamera(640, 480)};

  Blocks()
  {
    ObjectScene scene(frame.camera());
    scene.addTable({0.0, 0.08, 1.0}, {0.0, -0.5, -0.8});
    cv::RNG random(5);
    for (int i = 0; i < 10; ++i)
    {
      const cv::Vec3d place(0.16 * (i % 5 - 2), 0.16 * (i / 5) - 0.1, 0.9);
      poses.emplace_back(kitchen().block_pose.rotation(), place);
      scene.add(kitchen().block, poses.back());
      const auto near = candidatesNear(0, poses.back(), models().block->extent().center, 2, random);
      candidates.insert(candidates.end(), near.begin(), near.end());
    }
    cv::Mat bgr, depth;
    scene.draw(DepthSensor::kKinect, 0, bgr, depth);
    frame.set(bgr, depth);
  }
};

TEST(ObjectRecognizer, findsAllPiecesOfAnObject)
{
  const Blocks blocks;
  ObjectRecognizer recognizer;
  recognizer.add(models().block);
  const Recognition found = recognizer.recognize(blocks.frame, blocks.candidates);
  EXPECT_EQ(found.reports[0].found, 10);
  for (const cv::Affine3d& pose : blocks.poses)
  {
    const auto is_there = [&](const RecognizedObject& object)
    { return distanceBetween(object.pose, pose, models().block->extent().center) < 2.0; };
    EXPECT_EQ(std::count_if(found.objects.begin(), found.objects.end(), is_there), 1) << pose.translation();
  }
}

TEST(ObjectRecognizer, triesNoMoreThanItMayWhereNothingIs)
{
  const Blocks blocks;
  const auto tried = [&](int max_refined)
  {
    RecognizerParams params;
    params.max_refined = max_refined;
    params.threshold = 1.0;  // which nothing reaches
    ObjectRecognizer recognizer(params);
    recognizer.add(models().block);
    return recognizer.recognize(blocks.frame, blocks.candidates).reports[0].refined;
  };
  EXPECT_EQ(tried(5), 5);
  EXPECT_GE(tried(100), 10);
}

TEST(ObjectRecognizer, whatHidesAnObjectDoesNotPullItsPoseAway)
{
  // A few depths of what is before an object seem to be its own, some centimetres nearer.
  std::vector<Mesh> others;
  for (const std::string& name : sampleMeshNames())
    if (name != "drill") others.push_back(sampleMesh(name).mesh);
  const Mesh drill = sampleMesh("drill").mesh;
  ClutterParams params;
  params.occlusion = 0.4;
  const ClutteredFrame seen = ClutteredScenes(drill, others, 11).frame(3, params);
  RecognitionFrame frame(seen.camera);
  frame.set(seen.bgr, seen.depth);
  ObjectRecognizer recognizer;
  const auto shape = std::make_shared<const ObjectShape>(drill);
  recognizer.add(shape);
  PoseCandidate candidate;
  candidate.pose = seen.pose.translate(cv::Vec3d(0.002, -0.002, 0.001));
  candidate.score = 0.9;
  EXPECT_FALSE(CoarseCheck(DepthErrorParams(), RefinerParams().search).check(frame, *shape, candidate.pose).is_moved);
  const Recognition found = recognizer.recognize(frame, {candidate});
  ASSERT_EQ(found.objects.size(), 1u) << reasonText(found.reports[0]);
  EXPECT_LT(distanceBetween(found.objects[0].pose, seen.pose, shape->extent().center), 5.0);
  EXPECT_NEAR(found.objects[0].occlusion, 0.4, 0.15);  // of what has a depth, which is not all of it
}

TEST(ObjectRecognizer, aPoseIsFoundWhateverItsScore)
{
  ObjectRecognizer recognizer;
  recognizer.add(models().block);
  for (const double score : {0.0, 0.1, 1.0})
  {
    PoseCandidate candidate;
    candidate.pose = kitchen().block_pose.translate(cv::Vec3d(0.003, 0.0, 0.002));
    candidate.score = score;
    EXPECT_EQ(recognizer.recognize(kitchen().frame, {candidate}).objects.size(), 1u) << score;
  }
  PoseCandidate candidate;
  candidate.pose = kitchen().block_pose;
  for (const double score : {kNan, -0.1, 1.1})
  {
    candidate.score = score;
    EXPECT_EQ(
        refusal([&] { recognizer.recognize(kitchen().frame, {candidate}); }).rfind("the score of a candidate is", 0),
        0u);
  }
}

TEST(ObjectRecognizer, aHandleIsTheOneThatIsSeenAndNotHidden)
{
  // A cup whose handle is to the right, and a board before its left side: turned round, the handle would be behind it.
  // Its label is on the other side than the mesh's, so that all evidence but the handle is for the pose in which that
  // is hidden.
  const auto withLabel = [](float y)
  {
    Mesh mesh = cylinderMesh(0.04F, 0.09F, 48, {200, 200, 200});
    append(mesh, boxMesh({0.012F, 0.012F, 0.05F}, {200, 200, 200}, {0.045F, 0.0F, 0.0F}));
    append(mesh, boxMesh({0.036F, 0.004F, 0.04F}, {40, 60, 200}, {0.0F, y, 0.0F}));
    return mesh;
  };
  const Mesh cup = withLabel(0.04F);
  const auto shape = std::make_shared<ObjectShape>(cup);
  const cv::Matx33d upright(1, 0, 0, 0, 0, -1, 0, 1, 0), round(-1, 0, 0, 0, -1, 0, 0, 0, 1);
  const cv::Affine3d truth(upright, cv::Vec3d(0.0, 0.0, 0.7));
  ObjectScene scene(kCamera);
  scene.add(withLabel(-0.04F), truth);
  scene.addTable({0.0, 0.0, 1.0}, {0.0, -0.3, -1.0});
  scene.add(boxMesh({0.06F, 0.2F, 0.01F}, {60, 90, 160}), {cv::Matx33d::eye(), cv::Vec3d(-0.068, 0.0, 0.6)});
  cv::Mat bgr, depth;
  scene.draw(DepthSensor::kKinect, 0, bgr, depth);
  RecognitionFrame frame(kCamera);
  frame.set(bgr, depth);
  PoseCandidate hidden, seen;
  hidden.pose = cv::Affine3d(upright * round, truth.translation());
  hidden.score = 0.9;
  seen.pose = truth;
  seen.score = 0.5;
  ObjectRecognizer recognizer;
  recognizer.add(shape);
  const Recognition alone = recognizer.recognize(frame, {hidden});
  ASSERT_EQ(alone.objects.size(), 1u);  // nothing else speaks against it
  const Recognition found = recognizer.recognize(frame, {hidden, seen});
  ASSERT_EQ(found.objects.size(), 1u);
  EXPECT_LT(angleBetween(found.objects[0].pose, truth), 5.0);
}
