#pragma once

#include <robot_vision/ShmImage.h>
#include <sensor_msgs/Image.h>

#include <cstddef>
#include <memory>
#include <string>

#include "image_message.hpp"
#include "ros/shared_memory/slot_reader.hpp"

namespace robot_vision
{

class HeldFrames;

/// The images of a topic that publishers tell of. Thread-safe.
class SharedImages
{
public:
  /// So many frames of a topic a process holds, fewer where the publisher allows no more; then it copies them, so that
  /// somebody who keeps many takes no more of the publisher's memory.
  static constexpr std::size_t kMaxHeld = 8;

  explicit SharedImages(const std::string& topic);

  /// The image, whose pixels stay as they are while the message exists. Its data stands on the publisher's memory,
  /// where it cannot be written, or is a copy, as always where a std::vector cannot stand there. Throws
  /// SharedMemoryError.
  sensor_msgs::ImagePtr hold(const ShmImage& message);

  /// Gives back the memory of publishers that have ended, as far as no message holds it.
  void forgetEnded() { reader_.forgetEnded(); }

private:
  std::shared_ptr<HeldFrames> held_;  // of all that read the topic in this process
  SlotReader reader_;
  ImagePool copies_;
};

}  // namespace robot_vision
