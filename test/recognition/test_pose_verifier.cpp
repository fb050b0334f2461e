#include "robot_vision/recognition/pose_verifier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot_vision/recognition/object_recognizer.hpp"
#include "support/object_scenes.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const CameraModel kCamera = objectCamera(240, 200);
const double kThreshold = RecognizerParams().threshold;
const cv::Vec3b kRed(40, 60, 200);

/// Which images a frame has.
struct Images
{
  bool colors, depths;
};
constexpr Images kAllImages[] = {{true, true}, {false, true}, {true, false}};

/// The block before a table, with something before it or not.
struct Shot
{
  cv::Affine3d truth;
  RecognitionFrame frame{kCamera};
  cv::Mat bgr, depth;

  Shot(int number, DepthSensor sensor, const Images& images, double covered = 0.0, const cv::Vec3b& color = kRed)
  {
    cv::RNG random(static_cast<std::uint64_t>(number) + 40);
    const MeshExtent extent = meshExtent(lBlock());
    truth = {anyRotation(random), cv::Vec3d()};
    truth = truth.translate(cv::Vec3d(0.0, 0.0, 0.8) - truth.rotation() * extent.center);
    ObjectScene scene(kCamera);
    scene.add(lBlock(color), truth);
    scene.addTable({0.0, 0.0, 0.98}, {0.1, -0.4, -1.0});
    if (covered > 0.0)  // from the left
      scene.add(boxMesh({0.2F, 0.3F, 0.02F}, {90, 160, 90}, {-0.1F, 0.0F, 0.0F}),
                {cv::Matx33d::eye(), cv::Vec3d(0.65 / 0.8 * (covered - 0.5) * 2.0 * 0.06, 0.0, 0.65)});
    scene.draw(sensor, number, bgr, depth);
    frame.set(images.colors ? bgr : cv::Mat(), images.depths ? depth : cv::Mat());
  }
};

const ObjectShape& block()
{
  static const ObjectShape shape(lBlock());
  return shape;
}

/// The pose with the middle of a shape where that of the block is, turned about it.
cv::Affine3d inPlace(const Shot& shot, const ObjectShape& shape, const cv::Vec3d& turn = {})
{
  const cv::Matx33d rotation = shot.truth.rotation() * cv::Affine3d(turn).rotation();
  return {rotation, shot.truth * block().extent().center - rotation * shape.extent().center};
}

}  // namespace

TEST(PoseVerifier, acceptsTheRightPoseAndRefusesWrongOnes)
{
  const ObjectShape mirror(mirrored(lBlock())), box(boxMesh({0.1F, 0.06F, 0.05F}, kRed)),
      rod(cylinderMesh(0.03F, 0.12F, 24, kRed));
  PoseVerifier verifier;
  for (const Images& images : kAllImages)
    for (int i = 0; i < 8; ++i)
    {
      const Shot shot(i, i % 2 == 0 ? DepthSensor::kKinect : DepthSensor::kStereo, images);
      const std::string name = std::to_string(i) + " " + std::to_string(images.colors) + std::to_string(images.depths);
      EXPECT_GT(verifier.verify(shot.frame, block(), shot.truth).probability, kThreshold) << name;
      const auto refused = [&](const ObjectShape& shape, const cv::Affine3d& pose, const char* what)
      { EXPECT_LT(verifier.verify(shot.frame, shape, pose).probability, kThreshold) << name << " " << what; };
      const double shift = images.depths ? 0.015 : 0.02;
      refused(block(), shot.truth.translate({shift, 0.0, 0.0}), "to the right");
      refused(block(), shot.truth.translate({0.0, 0.0, images.depths ? 0.025 : 0.1}), "behind");
      refused(block(), inPlace(shot, block(), {0.0, 0.0, CV_PI}), "turned round");
      refused(block(), inPlace(shot, block(), {0.0, 0.6, 0.0}), "turned");
      refused(mirror, inPlace(shot, mirror), "mirrored");
      refused(box, inPlace(shot, box), "a box");
      refused(rod, inPlace(shot, rod), "a rod");
    }
}

TEST(PoseVerifier, acceptsWhatIsHiddenBy40PercentAndTellsHowMuch)
{
  PoseVerifier verifier;
  for (int i = 0; i < 8; ++i)
  {
    const Shot shot(i, DepthSensor::kKinect, {true, true}, 0.4);
    const PoseVerdict verdict = verifier.verify(shot.frame, block(), shot.truth);
    EXPECT_GT(verdict.probability, kThreshold) << i;
    EXPECT_GT(verdict.occlusion, 0.1) << i;
    EXPECT_LT(verdict.occlusion, 0.7) << i;
    EXPECT_NEAR(
        verdict.occlusion,
        verdict.evidence.hidden / (verdict.evidence.hidden + verdict.evidence.agreeing + verdict.evidence.pierced),
        1e-9);
  }
}

TEST(PoseVerifier, aHidingThingIsNoProofOfTheObject)
{
  // A board covers nearly all of where the object would be, if it were there.
  PoseVerifier verifier;
  for (int i = 0; i < 6; ++i)
  {
    const Shot shot(i, DepthSensor::kKinect, {true, true}, 0.95);
    const PoseVerdict verdict = verifier.verify(shot.frame, block(), shot.truth.translate({0.0, 0.0, 0.05}));
    EXPECT_LT(verdict.probability, kThreshold) << i;
  }
}

TEST(PoseVerifier, whereAnObjectHasNoDepthItsOutlineIsNotMissed)
{
  // A board hides the left part, and right of it a Kinect, whose projector it shades, measures nothing of the object.
  PoseVerifier verifier;
  for (int i = 0; i < 4; ++i)
  {
    const Shot shot(i, DepthSensor::kExact, {true, true}, 0.4);
    const PoseVerdict all = verifier.verify(shot.frame, block(), shot.truth);
    cv::Mat shaded = shot.depth.clone(), hiding = shot.depth < 0.7F, near;
    cv::dilate(hiding, near, cv::Mat::ones(1, 31, CV_8UC1));
    shaded.setTo(std::numeric_limits<float>::quiet_NaN(), near);
    RecognitionFrame frame(kCamera);
    frame.set(shot.bgr, shaded);
    const PoseVerdict verdict = verifier.verify(frame, block(), shot.truth);
    EXPECT_GT(verdict.evidence.unknown, 0.2) << i;
    EXPECT_GT(verdict.evidence.outline, 0.95) << i;
    EXPECT_GT(verdict.probability, kThreshold) << i;
    EXPECT_NEAR(verdict.evidence.outline, all.evidence.outline, 0.05) << i;
  }
}

TEST(PoseVerifier, theNoiseOfTheSensorIsNoMisfit)
{
  DepthErrorParams stereo;
  stereo.depth_noise_growth = 0.0055;
  for (int i = 0; i < 4; ++i)
  {
    const DepthSensor sensor = i % 2 == 0 ? DepthSensor::kKinect : DepthSensor::kStereo;
    const Shot shot(i, sensor, {true, true});
    PoseVerifier verifier(VerifierParams(), sensor == DepthSensor::kStereo ? stereo : DepthErrorParams());
    const PoseEvidence evidence = verifier.verify(shot.frame, block(), shot.truth).evidence;
    EXPECT_NEAR(evidence.misfit, evidence.noise, 0.2) << i;
    const cv::Affine3d behind = shot.truth.translate({0.0, 0.0, 0.006});
    const PoseEvidence other = verifier.verify(shot.frame, block(), behind).evidence;
    EXPECT_GT(other.misfit, other.noise + 0.5) << i;
  }
}

TEST(PoseVerifier, aPartOfALargerPlaneIsNoFlatObject)
{
  // All depths agree, and so do the normals; nothing ends where the object should.
  const ObjectShape tile(boxMesh({0.1F, 0.07F, 0.01F}, {170, 170, 170}));
  ObjectScene scene(kCamera);
  scene.addTable({0.0, 0.0, 0.8}, {0.0, 0.0, -1.0});
  cv::Mat bgr, depth;
  scene.draw(DepthSensor::kKinect, 0, bgr, depth);
  PoseVerifier verifier;
  for (const bool colors : {true, false})
  {
    RecognitionFrame frame(kCamera);
    frame.set(colors ? bgr : cv::Mat(), depth);
    const PoseVerdict verdict = verifier.verify(frame, tile, {cv::Matx33d::eye(), cv::Vec3d(0.0, 0.0, 0.805)});
    EXPECT_GT(verdict.evidence.agreeing, 0.9);
    EXPECT_LT(verdict.evidence.outline, 0.2);
    EXPECT_LT(verdict.probability, 0.5) << colors;
  }
}

TEST(PoseVerifier, whatIsDrawnOnATableIsNoObjectWithinIt)
{
  // A sheet of paper has the depth, the color and most of the outline of a box that is in the table but for its top.
  // A box that stands there may have a bar lying on it.
  enum class Seen
  {
    kBox,
    kBoxBelowABar,
    kPaper
  };
  const cv::Vec3f size(0.12F, 0.08F, 0.05F);
  const cv::Vec3b color(120, 190, 215);
  const ObjectShape box(boxMesh(size, color));
  const cv::Affine3d table(cv::Affine3d(cv::Vec3d(CV_PI - 0.8, 0.0, 0.0)).rotation(), cv::Vec3d(0.0, 0.0, 0.8));
  PoseVerifier verifier;
  for (int i = 0; i < 8; ++i)
    for (const Seen seen : {Seen::kBox, Seen::kBoxBelowABar, Seen::kPaper})
    {
      const cv::Affine3d place = table * cv::Affine3d(cv::Vec3d(0.0, 0.0, 0.4 * i + 0.2), cv::Vec3d());
      const auto up = [&](double height) { return place * cv::Affine3d(cv::Vec3d(), cv::Vec3d(0.0, 0.0, height)); };
      const double half = 0.5 * static_cast<double>(size[2]);
      const bool is_there = seen != Seen::kPaper;
      ObjectScene scene(kCamera);
      scene.addTable(table.translation(), table.rotation() * cv::Vec3d(0.0, 0.0, 1.0));
      if (is_there) scene.add(boxMesh(size, color), up(half));
      if (seen == Seen::kBoxBelowABar) scene.add(boxMesh({0.03F, 0.2F, 0.02F}, {60, 60, 60}), up(2.0 * half + 0.01));
      if (seen == Seen::kPaper) scene.add(boxMesh({size[0], size[1], 0.001F}, color), up(0.0005));
      cv::Mat bgr, depth;
      scene.draw(DepthSensor::kKinect, i, bgr, depth);
      RecognitionFrame frame(kCamera);
      frame.set(bgr, depth);
      const PoseVerdict verdict = verifier.verify(frame, box, up(is_there ? half : -half));
      const std::string name = std::to_string(i) + " " + std::to_string(static_cast<int>(seen));
      EXPECT_EQ(verdict.probability > kThreshold, is_there) << name << " " << verdict.probability;
      EXPECT_EQ(verdict.evidence.sunken > 0.1, !is_there) << name << " " << verdict.evidence.sunken;
    }
}

TEST(PoseVerifier, aMeshWithoutColorsMayBeOfAPaintedObject)
{
  const cv::Vec3b unknown = Mesh().color;
  const ObjectShape plain(lBlock(unknown)), mirror(mirrored(lBlock(unknown))),
      rod(cylinderMesh(0.03F, 0.12F, 24, unknown));
  PoseVerifier verifier;
  for (int i = 0; i < 8; ++i)
  {
    const Shot open(i, DepthSensor::kKinect, {true, true}), hidden(i, DepthSensor::kKinect, {true, true}, 0.4);
    EXPECT_GT(verifier.verify(open.frame, plain, open.truth).probability, kThreshold) << i;
    EXPECT_GT(verifier.verify(hidden.frame, plain, hidden.truth).probability, kThreshold) << i;
    EXPECT_LT(verifier.verify(open.frame, plain, inPlace(open, plain, {0.0, 0.6, 0.0})).probability, kThreshold) << i;
    EXPECT_LT(verifier.verify(open.frame, mirror, inPlace(open, mirror)).probability, kThreshold) << i;
    EXPECT_LT(verifier.verify(open.frame, rod, inPlace(open, rod)).probability, kThreshold) << i;
  }
}

TEST(PoseVerifier, anotherColorIsAnotherObject)
{
  const ObjectShape green(lBlock({60, 190, 60}));
  PoseVerifier verifier;
  for (int i = 0; i < 4; ++i)
  {
    const Shot shot(i, DepthSensor::kKinect, {true, true});
    const PoseVerdict right = verifier.verify(shot.frame, block(), shot.truth);
    const PoseVerdict wrong = verifier.verify(shot.frame, green, shot.truth);
    EXPECT_GT(right.evidence.colors, 0.9);
    EXPECT_LT(wrong.evidence.colors, 0.1);
    EXPECT_LT(wrong.log_odds, right.log_odds - 2.0);
    // Half as bright it is the same color.
    RecognitionFrame frame(kCamera);
    const cv::Mat dark = 0.5 * shot.bgr;
    frame.set(dark, shot.depth);
    EXPECT_GT(verifier.verify(frame, block(), shot.truth).evidence.colors, 0.9);
  }
}

TEST(PoseVerifier, evidenceIsWhatIsSeen)
{
  const Shot shot(1, DepthSensor::kExact, {true, true});
  PoseVerifier verifier;
  const PoseVerdict verdict = verifier.verify(shot.frame, block(), shot.truth);
  const PoseEvidence& evidence = verdict.evidence;
  EXPECT_GT(evidence.agreeing, 0.99);
  EXPECT_EQ(evidence.pierced, 0.0);
  EXPECT_EQ(evidence.hidden, 0.0);
  EXPECT_LT(evidence.misfit, 0.01);
  EXPECT_EQ(evidence.normals, 1.0);
  EXPECT_GT(evidence.outline, 0.98);
  EXPECT_EQ(evidence.colors, 1.0);
  EXPECT_EQ(evidence.pixels, cv::countNonZero(verdict.explained) * verdict.step * verdict.step);
  EXPECT_EQ(verdict.explained.cols, (verdict.box.width + verdict.step - 1) / verdict.step);
  // In front of it all of the surface is pierced, behind it all is hidden.
  const PoseVerdict before = verifier.verify(shot.frame, block(), shot.truth.translate({0.0, 0.0, -0.06}));
  EXPECT_GT(before.evidence.pierced, 0.8);
  const PoseVerdict behind = verifier.verify(shot.frame, block(), shot.truth.translate({0.0, 0.0, 0.06}));
  EXPECT_GT(behind.evidence.hidden, 0.8);
}

TEST(PoseVerifier, nothingIsFoundWhereNothingIs)
{
  PoseVerifier verifier;
  RecognitionFrame frame(kCamera);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const cv::Affine3d pose(cv::Matx33d::eye(), cv::Vec3d(0.0, 0.0, 0.8));
  frame.set(cv::Mat(), cv::Mat(200, 240, CV_32FC1, cv::Scalar(nan)));
  EXPECT_EQ(verifier.verify(frame, block(), pose).probability, 0.0);
  frame.set(cv::Mat::zeros(200, 240, CV_8UC3), cv::Mat());
  EXPECT_LT(verifier.verify(frame, block(), pose).probability, 0.2);
  for (const cv::Vec3d& place : {cv::Vec3d(5.0, 0.0, 0.8), cv::Vec3d(0.0, 0.0, -0.8), cv::Vec3d()})
    EXPECT_EQ(verifier.verify(frame, block(), {cv::Matx33d::eye(), place}).probability, 0.0) << place[0];
}

TEST(PoseVerifier, whatCannotBeIsRefused)
{
  EXPECT_EQ(refusalWith(&VerifierParams::max_pixels, 1), "max_pixels is 1, must be from 100 to 1e+07");
  RecognitionFrame frame(kCamera);
  EXPECT_EQ(refusal([&] { PoseVerifier().verify(frame, block(), cv::Affine3d::Identity()); }),
            "the frame is empty, must be set");
  EXPECT_EQ(refusal(
                [&] {
                  PoseVerifier().verify(frame, block(), {cv::Matx33d::zeros(), cv::Vec3d()});
                }),
            "the pose is no rotation and translation, must be that of a rigid body");
}
