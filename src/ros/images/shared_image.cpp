#include "shared_image.hpp"

#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

#include "image_description.hpp"
#include "robot_vision/common/shared_instance.hpp"
#include "ros/shared_memory/adopted_vector.hpp"

namespace robot_vision
{

/// The slots whose frames messages of this process hold. Several messages may hold the same one.
class HeldFrames
{
public:
  using Slot = std::pair<std::uint64_t, std::uint32_t>;  // publisher and number

  explicit HeldFrames(const std::string& /*topic*/) {}

  /// Counts a message, unless it would be the first of one slot more than there may be: then it returns false. One of
  /// the quota is left for a frame that is held while it is copied.
  bool add(const Slot& slot, std::uint64_t quota)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool is_full = counts_.size() >= SharedImages::kMaxHeld || counts_.size() + 1 >= quota;
    if (is_full && counts_.count(slot) == 0) return false;
    ++counts_[slot];
    return true;
  }

  void remove(const Slot& slot)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = counts_.find(slot);
    if (--found->second == 0) counts_.erase(found);
  }

private:
  std::mutex mutex_;  // guards counts_
  std::map<Slot, int> counts_;
};

namespace
{

using HeldPixels = std::shared_ptr<const HeldSlot>;

/// A message on memory that is held; the members end in the reverse order.
struct HeldImage
{
  HeldImage(std::shared_ptr<HeldFrames> counted, const HeldFrames::Slot& number, HeldPixels held)
    : frames(std::move(counted)),
      slot(number),
      memory(std::move(held)),
      pixels(message.data, memory->data(), memory->bytes())
  {
  }
  ~HeldImage() { frames->remove(slot); }

  std::shared_ptr<HeldFrames> frames;
  HeldFrames::Slot slot;
  HeldPixels memory;
  sensor_msgs::Image message;
  AdoptedVector pixels;
};

}  // namespace

SharedImages::SharedImages(const std::string& topic) : held_(sharedInstance<HeldFrames>(topic))
{
}

sensor_msgs::ImagePtr SharedImages::hold(const ShmImage& message)
{
  HeldPixels memory;
  if (message.bytes > 0)
    memory = reader_.hold({message.boot_id, message.socket, message.publisher, message.slot, message.memory,
                           message.generation, message.bytes});
  const HeldFrames::Slot slot(message.publisher, message.slot);
  if (memory && !AdoptedVector::kCopies && held_->add(slot, memory->quota()))
  {
    const auto image = boost::make_shared<HeldImage>(held_, slot, std::move(memory));
    copyDescription(message, image->message);
    return {image, &image->message};
  }
  const sensor_msgs::ImagePtr copy = copies_.take();
  copyDescription(message, *copy);
  copy->data.clear();
  if (memory) copy->data.assign(memory->data(), memory->data() + memory->bytes());
  return copy;
}

}  // namespace robot_vision
