#include "robot_vision/recognition/view_trainer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "robot_vision/recognition/view_tree.hpp"
#include "support/refusal.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

ViewParams coarse()
{
  ViewParams params;
  params.subdivisions = 1;
  return params;
}

cv::Vec3d anyDirection(cv::RNG& random)
{
  return cv::normalize(cv::Vec3d(random.gaussian(1), random.gaussian(1), random.gaussian(1)));
}

/// The largest angle (rad) from any of some directions to the nearest one of the tree that looks the same.
double farthest(const ViewTree& tree, const SymmetryGroup& symmetries)
{
  cv::RNG random(4);
  double most = 0.0;
  for (int i = 0; i < 300; ++i)
  {
    const cv::Vec3d direction = anyDirection(random);
    double least = CV_PI;
    for (const ViewDirection& one : tree.directions)
      least = std::min(least, symmetries.directionAngle(one.direction, direction));
    most = std::max(most, least);
  }
  return most;
}

}  // namespace

TEST(ViewTree, hasDirectionsAllAround)
{
  const std::vector<int> counts = {12, 42, 162, 642};
  for (int subdivisions = 0; subdivisions <= kMaxSubdivisions; ++subdivisions)
  {
    const ViewTree tree = viewTree(subdivisions);
    EXPECT_EQ(tree.levels, std::vector<int>(counts.begin(), counts.begin() + subdivisions + 1));
    ASSERT_EQ(static_cast<int>(tree.directions.size()), tree.levels.back());
    EXPECT_LE(farthest(tree, SymmetryGroup()), largestGap(subdivisions));
    for (std::size_t i = 0; i < tree.directions.size(); ++i)
    {
      const ViewDirection& one = tree.directions[i];
      EXPECT_NEAR(cv::norm(one.direction), 1.0, 1e-12);
      EXPECT_DOUBLE_EQ(one.spin, 2.0 * CV_PI);
      EXPECT_LT(one.parent, static_cast<int>(i));
      EXPECT_EQ(one.parent == -1, i < 12) << i;
      if (one.parent < 0) continue;
      const cv::Vec3d parent = tree.directions[static_cast<std::size_t>(one.parent)].direction;
      EXPECT_LT(std::acos(one.direction.dot(parent)), largestGap(0));
    }
  }
  EXPECT_EQ(refusal([] { viewTree(4); }), "subdivisions is 4, must be from 0 to 3");
}

TEST(ViewTree, leavesOutWhatLooksTheSame)
{
  const std::size_t all = viewTree(2).directions.size();
  const SymmetryGroup half({{{0, 0, 1}, 2}}), round({{{0, 0, 1}, 0}}), ball({{{0, 0, 1}, 0}, {{1, 0, 0}, 0}});
  const ViewTree of_half = viewTree(2, half), of_round = viewTree(2, round), of_ball = viewTree(2, ball);
  EXPECT_LT(of_half.directions.size(), 0.65 * static_cast<double>(all));
  EXPECT_LE(of_round.directions.size(), 20U);
  EXPECT_EQ(of_ball.directions.size(), 1U);
  EXPECT_LE(farthest(of_half, half), 1.01 * largestGap(2));
  EXPECT_LE(farthest(of_round, round), 1.01 * largestGap(2));
}

TEST(SymmetryGroup, takesAxesForOneThatAreNearlyThat)
{
  const auto turnsOf = [](const std::vector<Symmetry>& symmetries)
  {
    const SymmetryGroup group(symmetries);
    EXPECT_FALSE(group.isBall());
    return group.turns().size();
  };
  EXPECT_EQ(turnsOf({{{0, 0, 1}, 0}, {{1, 0, 0.001}, 2}}), 2U);    // across the round axis, with three digits
  EXPECT_EQ(turnsOf({{{0, 0, 1}, 0}, {{0.0015, 0, 1}, 2}}), 1U);   // along it: nothing new
  EXPECT_EQ(turnsOf({{{0, 0, 1}, 2}, {{0.00157, 0, 1}, 2}}), 2U);  // one axis
  EXPECT_EQ(turnsOf({{{0, 0, 1}, 4}, {{1, 0, 0.0015}, 2}}), 8U);
  EXPECT_EQ(turnsOf({{{0, 0, 1}, 120}}), 120U);
  for (const Symmetry& other : {Symmetry{{1, 0, 0.5}, 2}, Symmetry{{1, 0, 0}, 3}})
    EXPECT_EQ(refusal(
                  [&] {
                    SymmetryGroup({{{0, 0, 1}, 0}, other});
                  }),
              "the axis of a symmetry is neither along nor across one with any angle, must be along it or, with a fold "
              "of 2, across it: they do not belong to one object");
}

TEST(ViewTree, hasTheCameraWhereTheDirectionSays)
{
  cv::RNG random(8);
  for (int i = 0; i < 20; ++i)
  {
    const cv::Vec3d direction = i == 0 ? cv::Vec3d(0, 0, 1) : i == 1 ? cv::Vec3d(0, 0, -1) : anyDirection(random);
    const cv::Matx33d rotation = lookedAtFrom(direction);
    EXPECT_LT(cv::norm(rotation * direction - cv::Vec3d(0, 0, -1)), 1e-12);
    EXPECT_NEAR(cv::determinant(rotation), 1.0, 1e-12);
    const cv::Vec3d up = rotation * (i < 2 ? cv::Vec3d(0, 1, 0) : cv::Vec3d(0, 0, 1));
    EXPECT_NEAR(up[0], 0.0, 1e-9);
    EXPECT_LT(up[1], 0.0);
  }
}

TEST(ViewTrainer, hasFeaturesOnTheSurfaceOfTheMesh)
{
  const Mesh mesh = sampleMesh("bracket").mesh;
  const ViewModel model = trainViews(mesh, coarse());
  const MeshRenderer renderer(mesh);
  const cv::Matx33d K(800, 0, 320, 0, 800, 320, 0, 0, 1);
  ASSERT_TRUE(model.isComplete());
  std::array<int, 3> counts{};
  int on_surface = 0, surfaces = 0;
  for (const View& view : model.views)
  {
    const cv::Matx33d rotation = cv::Affine3d(view.rotation, cv::Vec3d()).rotation();
    const double distance = std::max(model.params.distance, 2.5 * model.extent.radius);
    const cv::Vec3d anchor(0, 0, distance);
    MeshView image;
    renderer.render(K, {rotation, anchor + view.center - rotation * model.extent.center}, {0, 0, 641, 641}, image);
    EXPECT_NEAR(image.depth.at<float>(320, 320), distance, 0.05 * model.extent.radius);  // the anchor
    for (const ViewFeature& feature : view.features)
    {
      ++counts[static_cast<std::size_t>(feature.kind)];
      if (feature.kind != FeatureKind::kSurface) continue;
      const cv::Vec3d place = model.step() * cv::Vec3d(feature.x, feature.y, feature.z) + anchor;
      const int x = cvRound(800 * place[0] / place[2] + 320), y = cvRound(800 * place[1] / place[2] + 320);
      ++surfaces;
      on_surface += std::abs(image.depth.at<float>(y, x) - place[2]) < 0.05 * model.extent.radius ? 1 : 0;
      const double scale = distance / place[2], margin = 0.02 * model.extent.radius;
      EXPECT_LE(scale * place[0], view.box.br().x + margin);
      EXPECT_GE(scale * place[1], view.box.y - margin);
    }
  }
  EXPECT_GT(on_surface, 0.97 * surfaces);
  EXPECT_GT(counts[0], 30 * 42);
  EXPECT_LE(counts[0], 64 * 42);
  EXPECT_GT(counts[2], 30 * 42);
  EXPECT_LE(counts[2], 64 * 42);
}

TEST(ViewTrainer, makesTheSameBytesEachTime)
{
  const ThreadCount two(2);
  const Mesh mesh = sampleMesh("duck").mesh;
  const std::vector<std::uint8_t> bytes = toBytes(trainViews(mesh, coarse()));
  EXPECT_EQ(toBytes(trainViews(mesh, coarse())), bytes);
  EXPECT_EQ(toBytes(trainViews(mesh, coarse(), {}, 2)), bytes);
  EXPECT_EQ(toBytes(trainViews(mesh, coarse(), {}, 3)), bytes);
  ViewParams other = coarse();
  other.inner_features = 8;
  EXPECT_NE(toBytes(trainViews(mesh, other)), bytes);
}

TEST(ViewTrainer, goesOnWhereItWasInterrupted)
{
  const Mesh mesh = sampleMesh("duck").mesh;
  const ViewTrainer trainer(mesh, coarse());
  ViewModel model = trainer.untrained();
  EXPECT_TRUE(model.views.empty());
  std::vector<int> told;
  int starts = 0;
  while (!model.isComplete())
  {
    ASSERT_LT(++starts, 42);
    trainer.train(model, 1 + starts % 2,
                  [&](int done, int all)
                  {
                    told.push_back(done);
                    EXPECT_EQ(all, 42);
                    return false;
                  });
    const std::vector<std::uint8_t> kept = toBytes(model);
    model = viewModelFromBytes(kept.data(), kept.size());
    EXPECT_EQ(told.back(), static_cast<int>(model.views.size()));
  }
  EXPECT_GT(starts, 2);
  EXPECT_EQ(toBytes(model), toBytes(trainViews(mesh, coarse())));
  trainer.train(model);  // nothing is left to do
  EXPECT_EQ(model.views.size(), 42U);
}

TEST(ViewTrainer, cutsViewsThatLookTheSame)
{
  const Mesh mesh = sampleMesh("can").mesh;
  const std::size_t all = trainViews(mesh, coarse()).templates();
  const ViewModel round = trainViews(mesh, coarse(), {{{0, 0, 1}, 0}});
  EXPECT_LE(round.views.size(), 10U);
  EXPECT_LT(round.templates(), all / 4);
  EXPECT_LT(turnsOf(View(), round.params), 2);
}

TEST(ViewTrainer, refusesWhatItCannotLearn)
{
  EXPECT_EQ(refusalWith(&ViewParams::subdivisions, 4), "subdivisions is 4, must be from 0 to 3");
  EXPECT_EQ(refusalWith(&ViewParams::contour_features, 16), "contour_features is 16, must be from 32 to 256");
  const Mesh mesh = sampleMesh("nut").mesh;
  EXPECT_NE(refusal([] { trainViews(Mesh()); }), "");
  Mesh point;
  point.vertices = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  point.triangles = {{0, 1, 2}};
  EXPECT_NE(refusal([&] { trainViews(point); }), "");
  EXPECT_NE(refusal([&] { trainViews(mesh, ViewParams(), {{{0, 0, 0}, 2}}); }), "");
  ViewParams far;
  far.distance = 21.0;
  EXPECT_EQ(refusal([&] { trainViews(mesh, far); }), "distance is 21, must be from 0.05 to 20");
  const ViewTrainer trainer(mesh, coarse());
  ViewModel model = trainer.untrained();
  EXPECT_EQ(refusal([&] { trainer.train(model, 0); }), "threads is 0, must be from 1 to 64");
  ViewModel other = ViewTrainer(sampleMesh("mug").mesh, coarse()).untrained();
  EXPECT_EQ(refusal([&] { trainer.train(other); }),
            "the model to train is of another mesh, or other parameters or symmetries, must be of these");
  ViewModel never;
  EXPECT_NE(refusal([&] { trainer.train(never); }), "");
}
