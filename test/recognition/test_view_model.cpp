#include "robot_vision/recognition/view_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot_vision/meshes/sample_meshes.hpp"
#include "robot_vision/recognition/object_matcher.hpp"
#include "robot_vision/recognition/view_trainer.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A small model: its bytes are few.
const ViewModel& bracket()
{
  static const ViewModel model = []
  {
    ViewParams params;
    params.subdivisions = 1;
    params.turns = 8;
    params.contour_features = params.surface_features = 32;
    params.inner_features = 8;
    return trainViews(sampleMesh("bracket").mesh, params, {{{0.0, 0.0, 1.0}, 2}});
  }();
  return model;
}

std::string faultOf(const std::vector<std::uint8_t>& bytes)
{
  return refusal([&] { viewModelFromBytes(bytes.data(), bytes.size()); });
}

/// The refusal of a model that is changed.
template <class Change>
std::string faultWith(const Change& change)
{
  ViewModel model = bracket();
  change(model);
  const std::string reason = refusal([&] { validate(model); });
  EXPECT_EQ(refusal([&] { toBytes(model); }), reason);
  return reason;
}

}  // namespace

TEST(ViewModel, comesBackFromItsBytes)
{
  const std::vector<std::uint8_t> bytes = toBytes(bracket());
  const ViewModel same = viewModelFromBytes(bytes.data(), bytes.size());
  EXPECT_TRUE(equalFields(same.params, bracket().params));
  ASSERT_EQ(same.symmetries.size(), 1U);
  EXPECT_EQ(same.symmetries[0].axis, cv::Vec3d(0, 0, 1));
  EXPECT_EQ(same.symmetries[0].fold, 2);
  EXPECT_EQ(same.extent.center, bracket().extent.center);
  EXPECT_EQ(same.extent.diameter, bracket().extent.diameter);
  EXPECT_EQ(same.levels, bracket().levels);
  ASSERT_EQ(same.views.size(), bracket().views.size());
  const View &view = same.views.back(), &before = bracket().views.back();
  EXPECT_EQ(view.rotation, before.rotation);
  EXPECT_EQ(view.center, before.center);
  EXPECT_EQ(view.box, before.box);
  EXPECT_EQ(view.spin, before.spin);
  EXPECT_EQ(view.parent, before.parent);
  ASSERT_EQ(view.features.size(), before.features.size());
  for (std::size_t i = 0; i < view.features.size(); ++i)
  {
    EXPECT_EQ(cv::Vec3s(view.features[i].x, view.features[i].y, view.features[i].z),
              cv::Vec3s(before.features[i].x, before.features[i].y, before.features[i].z));
    EXPECT_EQ(view.features[i].kind, before.features[i].kind);
    EXPECT_EQ(view.features[i].a, before.features[i].a);
    EXPECT_EQ(view.features[i].b, before.features[i].b);
  }
  EXPECT_EQ(toBytes(same), bytes);
  EXPECT_EQ(same.templates(), bracket().templates());
}

TEST(ViewModel, comesBackBeforeItsTrainingHasEnded)
{
  ViewModel model = bracket();
  model.views.resize(5);
  const std::vector<std::uint8_t> bytes = toBytes(model);
  const ViewModel same = viewModelFromBytes(bytes.data(), bytes.size());
  EXPECT_EQ(same.views.size(), 5U);
  EXPECT_FALSE(same.isComplete());
  EXPECT_TRUE(bracket().isComplete());
}

TEST(ViewModel, isRefusedIfItIsCutOrLonger)
{
  std::vector<std::uint8_t> bytes = toBytes(bracket());
  for (std::size_t size = 0; size < bytes.size(); size += size < 600 ? 1 : 29)
    ASSERT_NE(refusal([&] { viewModelFromBytes(bytes.data(), size); }), "") << size;
  EXPECT_EQ(refusal([&] { viewModelFromBytes(bytes.data(), 20); }),
            "the size of a trained model is 20 bytes, must be larger: it ends too early");
  bytes.push_back(0);
  EXPECT_NE(faultOf(bytes).find("there is more after its end"), std::string::npos);
}

TEST(ViewModel, isRefusedOrUsableWithBitsThatHaveFlipped)
{
  const std::vector<std::uint8_t> bytes = toBytes(bracket());
  const CameraModel camera{80, 60, {70, 0, 39.5, 0, 70, 29.5, 0, 0, 1}, {}, "plumb_bob"};
  cv::Mat depth(60, 80, CV_32FC1, cv::Scalar(1.0));
  depth(cv::Rect(25, 20, 20, 25)) = 0.6;
  int refused = 0, used = 0;
  for (std::size_t i = 0; i < bytes.size(); i += i < 400 ? 1 : 29)
  {
    std::vector<std::uint8_t> damaged = bytes;
    damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (i % 5 == 0 ? 0xFF : 1 << i % 8));
    ViewModel model;
    const std::string fault = refusal([&] { model = viewModelFromBytes(damaged.data(), damaged.size()); });
    for (const char letter : fault)
      ASSERT_GE(letter, ' ') << i;
    if (!fault.empty())
    {
      ++refused;
      continue;
    }
    if (++used % 20 != 0 || !model.isComplete()) continue;
    ObjectMatcher matcher;
    matcher.add(model);
    matcher.match(cv::Mat(), depth, "32FC1", camera);
  }
  EXPECT_GT(refused, 200);
  EXPECT_GT(used, 200);
}

TEST(ViewModel, saysWhatBytesAreInstead)
{
  std::vector<std::uint8_t> bytes = toBytes(bracket());
  bytes[0] = 'X';
  EXPECT_EQ(faultOf(bytes).substr(0, 37), "the beginning of a trained model is '");
  bytes = toBytes(bracket());
  bytes[8] = 9;
  EXPECT_EQ(faultOf(bytes),
            "the version of a trained model is 9, must be at most 1: a newer version of this package has made it");
  bytes = toBytes(bracket());
  bytes[13] = 'V';
  EXPECT_EQ(faultOf(bytes), "the method of a trained model is 'Views', must be 'views'");
  EXPECT_EQ(faultOf({}), "the size of a trained model is 0 bytes, must be larger: it ends too early");
}

TEST(ViewModel, isRefusedIfNothingCanBeLikeThat)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(faultWith([](ViewModel& /*model*/) {}), "");
  EXPECT_EQ(faultWith([](ViewModel& model) { model.params.turns = 3; }), "turns is 3, must be from 4 to 128");
  EXPECT_EQ(faultWith([](ViewModel& model) { model.extent.radius = 0.0; }),
            "the radius of a model is 0, must be above 0");
  EXPECT_EQ(faultWith([](ViewModel& model) { model.extent.diameter = 3.0 * model.extent.radius; }).substr(0, 24),
            "the diameter of a model ");
  EXPECT_NE(faultWith([&](ViewModel& model) { model.extent.center[1] = nan; }), "");
  EXPECT_NE(faultWith([](ViewModel& model) { model.levels.pop_back(); }), "");
  EXPECT_NE(faultWith([](ViewModel& model) { model.levels.front() = 0; }), "");
  EXPECT_NE(faultWith([](ViewModel& model) { model.views.resize(model.views.size() + 1); }), "");
  EXPECT_NE(faultWith([](ViewModel& model) { model.symmetries[0].fold = 1; }), "");
  const auto ofView = [](const std::string& expected) { return "view 20 of a model is damaged, must be " + expected; };
  EXPECT_EQ(faultWith([&](ViewModel& model) { model.views[20].rotation[0] = nan; }),
            ofView("a rotation of at most a full turn"));
  EXPECT_EQ(faultWith([](ViewModel& model) { model.views[20].parent = 20; }), ofView("a parent before it"));
  EXPECT_EQ(faultWith([](ViewModel& model) { model.views[20].spin = -0.1; }), ofView("turns of at most a full one"));
  EXPECT_EQ(faultWith([](ViewModel& model) { model.views[20].features[0].x = 17001; }),
            ofView("features of the object"));
  EXPECT_EQ(faultWith([](ViewModel& model) { model.views[20].features[0].kind = static_cast<FeatureKind>(3); }),
            ofView("features of the object"));
  EXPECT_EQ(faultWith([](ViewModel& model) { model.views[20].center[2] = 100.0; }),
            ofView("the object's middle within its diameter"));
}
