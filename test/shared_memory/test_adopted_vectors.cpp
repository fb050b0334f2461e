#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "ros/shared_memory/adopted_vector.hpp"
#include "ros/shared_memory/slot_reader.hpp"
#include "ros/shared_memory/slot_writer.hpp"

using namespace robot_vision;

namespace
{

struct Message
{
  int width = 0;
  std::vector<std::uint8_t> data;
};

/// A message that stands in a frame, as a transport would have it: given back from the last member to the first.
struct HeldMessage
{
  HeldMessage(std::shared_ptr<const HeldSlot> slot)
    : held(std::move(slot)), adopted(message.data, held->data(), held->bytes())
  {
  }
  std::shared_ptr<const HeldSlot> held;
  Message message;
  AdoptedVector adopted;
};

std::array<std::uint8_t, 1000> numbers()
{
  std::array<std::uint8_t, 1000> made;
  std::iota(made.begin(), made.end(), std::uint8_t{0});
  return made;
}

}  // namespace

TEST(AdoptedVectors, areReadAndCopiedAsAnyOther)
{
  const auto memory = numbers();
  std::vector<std::uint8_t> copy;
  {
    Message message;
    const AdoptedVector adopted(message.data, memory.data(), memory.size());
    EXPECT_EQ(message.data.data() == memory.data(), !AdoptedVector::kCopies);
    EXPECT_EQ(message.data.size(), memory.size());
    EXPECT_TRUE(std::equal(message.data.begin(), message.data.end(), memory.begin(), memory.end()));
    copy = message.data;
    const Message another = message;
    EXPECT_EQ(another.data, copy);
  }
  EXPECT_NE(copy.data(), memory.data());
  EXPECT_TRUE(std::equal(copy.begin(), copy.end(), memory.begin(), memory.end()));
}

TEST(AdoptedVectors, giveTheMemoryBack)
{
  const auto memory = numbers();
  std::vector<std::uint8_t> data(5000, 1);
  for (int i = 0; i < 3; ++i)
  {
    {
      const AdoptedVector adopted(data, memory.data(), memory.size());
    }
    if (!AdoptedVector::kCopies) EXPECT_TRUE(data.empty());
    data.assign(3000, 2);
    EXPECT_EQ(data.back(), 2);
  }
  EXPECT_EQ(memory, numbers());
}

TEST(AdoptedVectors, mayBeEmpty)
{
  std::vector<std::uint8_t> data;
  const AdoptedVector adopted(data, nullptr, 0);
  EXPECT_TRUE(data.empty());
}

TEST(AdoptedVectors, standInFramesOfOtherProcesses)
{
  SlotWriter writer;
  SlotReader reader(60.0);
  const auto memory = numbers();
  auto slot = writer.take(memory.size());
  {
    // A publisher fills the message, which stands in the slot.
    Message message;
    const AdoptedVector adopted(message.data, slot->data(), slot->bytes());
    std::copy(memory.begin(), memory.end(), message.data.begin());
    if (AdoptedVector::kCopies) std::copy(memory.begin(), memory.end(), slot->data());
  }
  auto received = std::make_shared<HeldMessage>(reader.hold(slot->publish()));
  slot.reset();
  const std::shared_ptr<const Message> message(received, &received->message);
  received.reset();
  for (int i = 0; i < 30; ++i)
    writer.take(memory.size())->publish();
  EXPECT_TRUE(std::equal(message->data.begin(), message->data.end(), memory.begin(), memory.end()));
}
