#pragma once

#include <stdexcept>
#include <string>

namespace robot_vision
{

/// Why a frame in shared memory cannot be had.
enum class SharedMemoryFault
{
  kOverwritten,    // the publisher needed the slot before it was held: the next frame may be held
  kTooManyHeld,    // this process holds as many of the publisher's frames as one reader may
  kGone,           // the publisher has ended, or does not answer: another one may come
  kOtherHost,      // the publisher runs on another host
  kOtherUser,      // the publisher is another user's
  kUnreachable,    // the publisher's socket is not to be found here: gone, or in another network namespace
  kNoDescriptors,  // this process has no descriptor or no memory left
  kRefused,        // what came from the publisher is not what it must be
};

/// Tells in one line why a frame in shared memory cannot be had.
class SharedMemoryError : public std::runtime_error
{
public:
  SharedMemoryError(SharedMemoryFault fault, const std::string& reason) : std::runtime_error(reason), fault_(fault) {}

  SharedMemoryFault fault() const { return fault_; }
  /// Whether frames of the same publisher that come later may be had, so that only this one is lost.
  bool concernsOneFrame() const
  {
    return fault_ == SharedMemoryFault::kOverwritten || fault_ == SharedMemoryFault::kTooManyHeld;
  }

private:
  SharedMemoryFault fault_;
};

}  // namespace robot_vision
