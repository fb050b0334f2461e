#include "shared_offers.hpp"

#include <robot_vision/ShmImage.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <utility>

#include "topic_publishers.hpp"

namespace robot_vision
{
namespace
{

constexpr std::chrono::seconds kQuestionPeriod(5);  // each question is a line in the master's log
constexpr std::chrono::seconds kRetryPeriod(1);     // if the master does not answer

}  // namespace

SharedOffers::SharedOffers(std::string topic) : topic_(std::move(topic))
{
}

SharedOffers::Answer SharedOffers::ask(std::uint32_t connections, Clock::time_point now)
{
  if (connections == asked_ && now < next_) return Answer::kUnknown;
  asked_ = connections;
  next_ = now + kRetryPeriod;
  const auto images = publishersOf(topic_, ros::message_traits::datatype<sensor_msgs::Image>());
  if (!images) return Answer::kUnknown;
  if (connections != known_ || *images != all_offer_)
  {
    const auto shared = publishersOf(topic_ + "/shm", ros::message_traits::datatype<ShmImage>());
    if (!shared) return Answer::kUnknown;
    if (!std::includes(shared->begin(), shared->end(), images->begin(), images->end())) return Answer::kNotAll;
    known_ = connections;
    all_offer_ = *images;
  }
  next_ = now + kQuestionPeriod;
  return Answer::kAll;
}

void SharedOffers::forget()
{
  next_ = {};
  asked_ = known_ = 0;
  all_offer_.clear();
}

}  // namespace robot_vision
