#pragma once

#include "topic_lock.hpp"

namespace robot_vision
{

/// Held while topics of this process are advertised in roscpp, or withdrawn. TopicManager::unadvertise() keeps its
/// place in the list of topics while that is not locked: if two threads change the list at a time, it forgets a topic
/// of somebody else, and roscpp ends the process at the next message there. Nodelets of other packages do not hold it;
/// those of this one hold it while they start and end.
using AdvertisingLock = TopicLock<struct Advertising>;

}  // namespace robot_vision
