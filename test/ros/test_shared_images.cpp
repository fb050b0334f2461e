#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ros/images/shared_image.hpp"
#include "ros/images/shared_topic.hpp"
#include "ros/shared_memory/slot_writer.hpp"

using namespace robot_vision;

namespace
{

constexpr std::size_t kBytes = 10000;

/// Publishes a frame of pixels of this value, and gives its slot back.
ShmImage published(SlotWriter& writer, std::uint8_t value)
{
  const std::shared_ptr<WritableSlot> slot = writer.take(kBytes);
  if (!slot) throw std::runtime_error("no slot: " + writer.counts().reason);
  std::fill_n(slot->data(), kBytes, value);
  const SlotAddress address = slot->publish();
  ShmImage message;
  message.boot_id = address.boot_id;
  message.socket = address.socket;
  message.publisher = address.publisher;
  message.slot = address.slot;
  message.memory = address.memory;
  message.generation = address.generation;
  message.bytes = address.bytes;
  return message;
}

class SharedImagesOfSlots : public testing::TestWithParam<std::size_t>
{
};

}  // namespace

TEST_P(SharedImagesOfSlots, whoKeepsManyGetsAllFrames)
{
  SlotWriter::Limits limits;
  limits.max_slots = GetParam();
  SlotWriter writer(limits);
  SharedImages images("/kept_" + std::to_string(GetParam()));
  std::vector<sensor_msgs::ImagePtr> kept;
  for (std::uint8_t value = 0; value < 40; ++value)
    kept.push_back(images.hold(published(writer, value)));
  for (std::uint8_t value = 0; value < 40; ++value)
    EXPECT_EQ(kept[value]->data, std::vector<std::uint8_t>(kBytes, value));
}

INSTANTIATE_TEST_SUITE_P(SharedImages, SharedImagesOfSlots, testing::Values(2, 5, 16, 32));

TEST(SharedTopic, eachTellsThatItHasNoMemoryLeft)
{
  ros::Time::init();  // which rosconsole puts before each message
  const std::vector<std::uint8_t> pixels(kBytes);
  testing::internal::CaptureStderr();
  for (const std::string name : {"/one", "/other"})
  {
    SharedTopic topic(name);
    const auto is_read = std::make_shared<SharedTopic::IsRead>([] { return true; });
    topic.addPublisher(is_read);
    std::vector<SharedTopic::Published> held;
    do
      held.emplace_back();
    while (topic.publish({}, pixels.data(), kBytes, held.back()));
    EXPECT_FALSE(topic.publish({}, pixels.data(), kBytes, held.back()));
    EXPECT_EQ(topic.dropped(), 2U);
  }
  const std::string log = testing::internal::GetCapturedStderr();
  for (const std::string name : {"/one", "/other"})
  {
    const std::string warning = name + ": a frame is not published over shm: ";
    EXPECT_NE(log.find(warning), std::string::npos) << log;
    EXPECT_EQ(log.find(warning), log.rfind(warning)) << log;
  }
}
