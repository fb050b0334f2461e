#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "robot_vision/recognition/texture_model.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

TextureModel modelOf(const std::string& detector)
{
  TextureModel model;
  model.params.detector = detector;
  model.extent = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.8, 0.4};
  model.views = 7;
  for (int i = 0; i < 5; ++i)
    model.points.push_back({{0.1F * static_cast<float>(i), 0.2F, -0.3F}, {0.0F, 0.6F, 0.8F}, 0.01F, i + 1});
  model.descriptors.create(5, detector == "sift" ? 128 : 32, detector == "sift" ? CV_32FC1 : CV_8UC1);
  cv::RNG(3).fill(model.descriptors, cv::RNG::UNIFORM, 0, 256);
  return model;
}

/// What is wrong with bytes; empty: nothing.
std::string faultOf(const std::vector<std::uint8_t>& bytes)
{
  try
  {
    textureModelFromBytes(bytes.data(), bytes.size());
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(TextureModel, comesBackFromItsBytes)
{
  for (const std::string detector : {"orb", "sift"})
  {
    const TextureModel model = modelOf(detector);
    const std::vector<std::uint8_t> bytes = toBytes(model);
    const TextureModel same = textureModelFromBytes(bytes.data(), bytes.size());
    EXPECT_TRUE(equalFields(same.params, model.params));
    EXPECT_EQ(same.extent.size, model.extent.size);
    EXPECT_EQ(same.extent.radius, model.extent.radius);
    EXPECT_EQ(same.views, 7);
    ASSERT_EQ(same.points.size(), 5U);
    EXPECT_EQ(same.points[4].position, model.points[4].position);
    EXPECT_EQ(same.points[4].direction, model.points[4].direction);
    EXPECT_EQ(same.points[4].views, 5);
    EXPECT_EQ(cv::norm(same.descriptors, model.descriptors, cv::NORM_INF), 0.0);
    EXPECT_EQ(toBytes(same), bytes);
  }
}

TEST(TextureModel, isRefusedIfItIsCutOrLonger)
{
  std::vector<std::uint8_t> bytes = toBytes(modelOf("orb"));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(faultOf({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), "") << size;
  bytes.push_back(0);
  EXPECT_NE(faultOf(bytes).find("more after its end"), std::string::npos);
}

TEST(TextureModel, isReadOrRefusedWithBitsThatHaveFlipped)
{
  for (const std::string detector : {"orb", "sift"})
  {
    const std::vector<std::uint8_t> bytes = toBytes(modelOf(detector));
    for (std::size_t i = 0; i < bytes.size(); ++i)
    {
      std::vector<std::uint8_t> damaged = bytes;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ 1 << i % 8);
      const std::string fault = faultOf(damaged);
      for (const char letter : fault)
        ASSERT_GE(letter, ' ') << i;
    }
  }
}

TEST(TextureModel, isRefusedIfNothingCanBeLikeThat)
{
  const auto faultWith = [](void (*change)(TextureModel&))
  {
    TextureModel model = modelOf("orb");
    change(model);
    return refusal([&] { validate(model); });
  };
  EXPECT_EQ(faultWith([](TextureModel& /*model*/) {}), "");
  EXPECT_EQ(faultWith([](TextureModel& model) { model.extent.radius = 0.0; }),
            "the diameter or radius of a model is 0, must be from 0.0001 to 1000");
  EXPECT_EQ(faultWith([](TextureModel& model) { model.points.pop_back(); }),
            "the number of descriptors is 5, must be 4 as of keypoints");
  EXPECT_EQ(faultWith([](TextureModel& model) { model.points[2].direction *= 0.5F; }),
            "the length of a keypoint's direction is 0.5, must be 1");
  EXPECT_EQ(faultWith([](TextureModel& model) { model.points[2].position[1] = NAN; }),
            "the position of a keypoint is not finite or far away, must be within 1000 m");
  EXPECT_EQ(faultWith([](TextureModel& model) { model.params.detector = "sift"; }),
            "the type or length of the descriptors is another one, must be that of sift");
  EXPECT_EQ(faultWith([](TextureModel& model) { model.descriptors.create(5, 512, CV_8UC1); }),
            "the type or length of the descriptors is another one, must be that of orb");
}
