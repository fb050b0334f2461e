#include "ros/images/nodelet_queue.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

#include "support/receiver.hpp"

using namespace robot_vision;

namespace
{

class Counted : public ros::CallbackInterface
{
public:
  CallResult call() override
  {
    ++calls;
    return Success;
  }

  std::atomic<int> calls{0};
};

}  // namespace

TEST(NodeletQueue, WhatHasComeBeforeItIsOpenedIsCalledAndThenEachAtOnce)
{
  nodelet::detail::CallbackQueueManager manager(2);
  for (const bool threaded : {false, true})
  {
    const auto queue = boost::make_shared<NodeletQueue>(manager);
    const auto callback = boost::make_shared<Counted>();
    for (int i = 0; i < 300; ++i)
      queue->addCallback(callback, 1);
    EXPECT_EQ(callback->calls, 0);
    queue->open(threaded);
    EXPECT_TRUE(waitFor([&] { return callback->calls == 300; })) << callback->calls;
    queue->addCallback(callback, 1);
    EXPECT_TRUE(waitFor([&] { return callback->calls == 301; })) << callback->calls;
    manager.removeQueue(queue);
  }
}
