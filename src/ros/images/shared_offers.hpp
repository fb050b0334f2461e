#pragma once

#include <chrono>
#include <cstdint>
#include <set>
#include <string>

namespace robot_vision
{

/// Finds out whether all publishers of a topic of images offer them over shared memory, by asking the master when the
/// publishers that this process is connected to have changed, and else now and then. For one thread.
class SharedOffers
{
public:
  using Clock = std::chrono::steady_clock;

  enum class Answer
  {
    kUnknown,  // it is not the time to ask, or the master does not answer
    kAll,      // each offers it, also if nobody publishes
    kNotAll
  };

  /// `topic` is absolute and has no /shm.
  explicit SharedOffers(std::string topic);

  /// `connections`: the publishers of shm that this process is connected to.
  Answer ask(std::uint32_t connections, Clock::time_point now);
  /// Has the next call ask in any case.
  void renew() { next_ = {}; }
  /// Has the next call know nothing of earlier answers.
  void forget();

private:
  const std::string topic_;
  Clock::time_point next_;           // time of the next question, if nothing changes before
  std::uint32_t asked_ = 0;          // connections at the last question
  std::uint32_t known_ = 0;          // connections when all were found to offer shm
  std::set<std::string> all_offer_;  // these publishers
};

}  // namespace robot_vision
