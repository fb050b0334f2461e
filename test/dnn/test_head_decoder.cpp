#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/dnn/head_decoder.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr int kClasses = 3;
const cv::Size kImage(50, 40);

struct HeadCase
{
  std::string head, task;
  std::vector<std::vector<std::int64_t>> shapes;  // for inputs of 64x64
};

const HeadCase kCases[] = {
    {"yolov3", "detect", {{30, 8}, {7, 8}}},
    {"yolov5", "detect", {{1, 30, 8}}},
    {"yolov5", "segment", {{1, 30, 12}, {1, 4, 5, 6}}},
    {"yolov8", "detect", {{1, 7, 30}}},
    {"yolov8", "segment", {{1, 11, 30}, {1, 4, 5, 6}}},
    {"yolov8", "pose", {{1, 13, 30}}},
    {"yolov8", "oriented", {{1, 8, 30}}},
    {"yolov10", "detect", {{1, 30, 6}}},
    {"yolox", "detect", {{1, 84, 8}}},
    {"nanodet", "detect", {{1, 85, 35}}},
    {"ssd", "detect", {{1, 1, 30, 7}}},
    {"ssd", "detect", {{1, 30, 4}, {1, 30}, {1, 30}}},
    {"detr", "detect", {{1, 30, 4}, {1, 30, 4}}},
    {"rtdetr", "detect", {{1, 30, 7}}},
    {"rtdetr", "detect", {{1, 30, 3}, {1, 30, 4}}},
};

HeadParams paramsOf(const HeadCase& head)
{
  HeadParams params;
  params.head = head.head;
  params.task = head.task;
  params.classes = kClasses;
  params.keypoints = 2;
  params.input_width = params.input_height = 64;
  params.score_threshold = 0.0;
  return params;
}

/// Outputs, each in memory of its own that ends where it ends.
std::vector<std::vector<float>> memoryOf(const HeadCase& head, const std::function<float()>& number)
{
  std::vector<std::vector<float>> memory;
  for (const auto& shape : head.shapes)
  {
    const auto size = std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
    std::vector<float>& values = memory.emplace_back(static_cast<std::size_t>(size));
    for (float& value : values)
      value = number();
  }
  return memory;
}

std::vector<FoundObject> decoded(const HeadCase& head, const std::vector<std::vector<float>>& memory)
{
  std::vector<NetworkOutput> outputs;
  for (std::size_t i = 0; i < memory.size(); ++i)
    outputs.push_back({head.shapes[i], memory[i].data()});
  return HeadDecoder(paramsOf(head)).decode(outputs, {1.3, 0.7, 5.0, -3.0, 2, 1}, kImage);
}

void expectSane(const std::vector<FoundObject>& objects, const std::string& what)
{
  double last = HUGE_VAL;
  for (const FoundObject& object : objects)
  {
    EXPECT_TRUE(object.class_id >= 0 && object.class_id < kClasses) << what;
    EXPECT_TRUE(object.score >= 0.0 && object.score <= last && std::isfinite(object.score)) << what;
    last = object.score;
    EXPECT_TRUE(object.box.x0 >= 0.0 && object.box.x0 < object.box.x1 && object.box.x1 <= kImage.width) << what;
    EXPECT_TRUE(object.box.y0 >= 0.0 && object.box.y0 < object.box.y1 && object.box.y1 <= kImage.height) << what;
    const cv::Rect pixels = pixelsOf(object.box);
    EXPECT_EQ(pixels & cv::Rect({0, 0}, kImage), pixels) << what;
    EXPECT_TRUE(object.mask.empty() || object.mask.size() == pixels.size()) << what;
    for (const ObjectKeypoint& keypoint : object.keypoints)
      EXPECT_TRUE(std::isfinite(keypoint.x) && std::isfinite(keypoint.y) && std::isfinite(keypoint.score)) << what;
  }
}

}  // namespace

TEST(HeadDecoder, makesOnlySaneObjectsOfAnyNumbers)
{
  cv::RNG random(3);
  const float odd[] = {0.0F, 1.0F, -1.0F, 0.5F, 64.0F, 1e-40F, 1e20F, 3e38F, -3e38F, NAN, INFINITY, -INFINITY};
  const std::function<float()> kinds[] = {
      [&] { return static_cast<float>(random.uniform(0.0, 1.0)); },
      [&] { return static_cast<float>(random.uniform(-20.0, 80.0)); },
      [&] { return static_cast<float>(random.uniform(0, 4)); },  // also numbers of classes
      [&] { return odd[random.uniform(0, 12)]; },
      [&]
      { return random.uniform(0, 4) > 0 ? static_cast<float>(random.uniform(0.0, 1.0)) : odd[random.uniform(0, 12)]; },
      [&]
      {
        const auto bits = static_cast<std::uint32_t>(random.next());
        float number;
        std::memcpy(&number, &bits, sizeof number);
        return number;
      }};
  for (const HeadCase& head : kCases)
  {
    std::size_t found = 0;
    for (const auto& kind : kinds)
      for (int round = 0; round < 20; ++round)
      {
        const auto objects = decoded(head, memoryOf(head, kind));
        expectSane(objects, head.head + " " + head.task);
        found += objects.size();
      }
    EXPECT_GT(found, 0U) << head.head << " " << head.task;
  }
}

TEST(HeadDecoder, refusesShapesOfEachHeadThatAreOneLongerOrShorter)
{
  for (const HeadCase& head : kCases)
    for (std::size_t output = 0; output < head.shapes.size(); ++output)
    {
      // The axis of length 1 that is first, and of each head the one whose length it knows.
      HeadCase wrong = head;
      wrong.shapes[output].insert(wrong.shapes[output].begin(), 2);
      const std::string words = refusal([&] { decoded(wrong, memoryOf(wrong, [] { return 0.5F; })); });
      EXPECT_NE(words.find(head.head), std::string::npos) << words;
      EXPECT_NE(words.find("(2, "), std::string::npos) << words;
      EXPECT_NE(words.find("must be of (1, "), std::string::npos) << words;
    }
}

TEST(HeadDecoder, masksOfVeryManyPixelsGoToTheSurestObjects)
{
  HeadParams params = paramsOf(kCases[4]);
  params.iou_threshold = 1.0;
  std::vector<float> columns(11 * 30, 0.0F), prototypes(4 * 5 * 6, 1.0F);
  for (std::size_t i = 0; i < 30; ++i)
  {
    columns[i] = columns[30 + i] = 32.0F;       // centre
    columns[60 + i] = columns[90 + i] = 64.0F;  // size: all of the image
    columns[120 + i] = 0.9F - 0.01F * static_cast<float>(i);
    columns[7 * 30 + i] = 1.0F;
  }
  const std::vector<NetworkOutput> outputs = {{{1, 11, 30}, columns.data()}, {{1, 4, 5, 6}, prototypes.data()}};
  const cv::Size large(4096, 2048);  // 8 of them have kMaxMaskPixels
  const auto objects = HeadDecoder(params).decode(outputs, {64.0 / 4096, 64.0 / 2048, 0.0, 0.0, 0, 0}, large);
  ASSERT_EQ(objects.size(), 30U);
  for (std::size_t i = 0; i < objects.size(); ++i)
  {
    EXPECT_EQ(objects[i].mask.size(), i < 8 ? large : cv::Size()) << i;
    if (i < 8)
    {
      EXPECT_EQ(cv::countNonZero(objects[i].mask), large.area());
    }
  }
}

TEST(HeadDecoder, pixelsOfABoxAreThoseThatItTouches)
{
  EXPECT_EQ(pixelsOf({0.0, 0.0, 1.0, 1.0}), cv::Rect(0, 0, 1, 1));
  EXPECT_EQ(pixelsOf({0.9, 2.0, 3.1, 4.0}), cv::Rect(0, 2, 4, 2));
  EXPECT_EQ(pixelsOf({5.2, 5.2, 5.3, 5.3}), cv::Rect(5, 5, 1, 1));
}
