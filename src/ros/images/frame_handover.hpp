#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace robot_vision
{

/// Delivers the frames of a topic that come over one of two ways, at times over both: only those of one way at a time,
/// each of them once, one after the other. Thread-safe.
class FrameHandover
{
public:
  enum class Way
  {
    kRaw,
    kShared
  };

  /// Whether a frame is to be delivered; then finish() must follow, and until then other frames wait. One that comes in
  /// the thread that delivers is left out.
  bool begin(Way way, const std_msgs::Header& header);
  /// The number that a frame of the current way is to have: publishers count the frames of each way by themselves, and
  /// a gap in the numbers stands for frames that were lost.
  std::uint32_t sequence(const std_msgs::Header& header) const;
  void finish();

  /// Whether a frame of that way would be delivered, if it was not before.
  bool accepts(Way way) const;

  /// From now on the first frame of that way has its way take over; nullopt: neither does.
  void allow(std::optional<Way> way);
  /// That way takes over now.
  void take(Way way);
  Way way() const;

  /// From now on no frame is delivered. Waits for the one that is, unless this thread delivers it: then it returns
  /// false.
  bool close();

private:
  struct Delivered
  {
    Way way;
    std::uint32_t sequence;
    ros::Time stamp;
    std::string frame_id;
  };

  bool wasDelivered(Way way, const std_msgs::Header& header);
  void remember(Way way, const std_msgs::Header& header);
  std::uint32_t numberOf(Way way, const std_msgs::Header& header) const;
  std::deque<Delivered>::iterator find(Way way, const std_msgs::Header& header);

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  bool closed_ = false;
  std::optional<std::thread::id> deliverer_;
  Way way_ = Way::kRaw;
  std::optional<Way> allowed_;
  std::optional<std::uint32_t> last_;  // number of the last delivered frame
  std::uint32_t shift_ = 0;            // from the numbers of shared frames to those of raw ones, modulo 2^32
  std::deque<Delivered> delivered_;    // the last ones, none twice
};

}  // namespace robot_vision
