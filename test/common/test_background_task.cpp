#include "core/common/background_task.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "support/no_threads.hpp"

using namespace robot_vision;

namespace
{

/// Holds work back until it is opened. It opens by itself when it goes, so that no test that has failed waits for ever.
class Gate
{
public:
  ~Gate() { open(); }

  void open()
  {
    if (!std::exchange(is_open_, true)) opened_.set_value();
  }

  /// Work that waits for the gate and then returns `value`.
  std::function<int()> work(int value) const
  {
    return [opened = future_, value]
    {
      opened.wait();
      return value;
    };
  }

private:
  bool is_open_ = false;
  std::promise<void> opened_;
  std::shared_future<void> future_ = opened_.get_future().share();
};

int fail()
{
  throw std::runtime_error("out of paper");
}

}  // namespace

TEST(BackgroundTask, isNotBusyBeforeItsFirstWork)
{
  BackgroundTask<int> task;
  task.wait();
  task.drop();
  EXPECT_FALSE(task.busy());
  EXPECT_FALSE(task.take());
}

TEST(BackgroundTask, givesAResultOnceAndNotBeforeItsEnd)
{
  BackgroundTask<int> task;
  Gate gate;
  ASSERT_TRUE(task.start(gate.work(5)));
  EXPECT_TRUE(task.busy());
  EXPECT_FALSE(task.take());
  gate.open();
  task.wait();
  EXPECT_TRUE(task.busy());  // until the result is taken
  EXPECT_EQ(task.take(), 5);
  EXPECT_FALSE(task.busy());
  EXPECT_FALSE(task.take());
}

TEST(BackgroundTask, givesTheResultsInTheOrderOfTheirWork)
{
  BackgroundTask<std::pair<int, std::thread::id>> task;
  for (int i = 0; i < 20; ++i)
  {
    ASSERT_TRUE(task.start([i] { return std::make_pair(i, std::this_thread::get_id()); }));
    task.wait();
    const auto result = task.take();
    ASSERT_TRUE(result);
    EXPECT_EQ(result->first, i);
    EXPECT_NE(result->second, std::this_thread::get_id());
  }
}

TEST(BackgroundTask, throwsWhatTheWorkHasThrownAndGoesOn)
{
  BackgroundTask<int> task;
  ASSERT_TRUE(task.start(fail));
  task.wait();
  EXPECT_THROW(task.take(), std::runtime_error);
  EXPECT_FALSE(task.busy());
  ASSERT_TRUE(task.start([] { return 6; }));
  task.wait();
  EXPECT_EQ(task.take(), 6);
}

TEST(BackgroundTask, neitherGivesNorThrowsWhatWasDropped)
{
  BackgroundTask<int> task;
  for (const bool fails : {false, true})
  {
    Gate gate;
    ASSERT_TRUE(task.start([work = gate.work(7), fails] { return fails ? work() + fail() : work(); }));
    task.drop();
    EXPECT_TRUE(task.busy());  // there is no second thread
    gate.open();
    task.wait();
    EXPECT_FALSE(task.take());
    EXPECT_FALSE(task.busy());
  }
  ASSERT_TRUE(task.start([] { return 8; }));
  task.wait();
  EXPECT_EQ(task.take(), 8);
}

TEST(BackgroundTask, destroysTheWorkWhenItsResultIsTaken)
{
  BackgroundTask<int> task;
  auto image = std::make_unique<int>(9);
  const auto kept = std::make_shared<int>(0);
  ASSERT_TRUE(task.start([image = std::move(image), kept] { return *image + *kept; }));
  task.wait();
  EXPECT_EQ(task.take(), 9);
  EXPECT_EQ(kept.use_count(), 1);
}

TEST(BackgroundTask, doesNotStartWithoutAThread)
{
  BackgroundTask<int> task;
  {
    const NoThreads none;
    EXPECT_FALSE(task.start([] { return 10; }));
  }
  EXPECT_FALSE(task.busy());
  ASSERT_TRUE(task.start([] { return 11; }));
  task.wait();
  EXPECT_EQ(task.take(), 11);
}

TEST(BackgroundTask, waitsForItsWorkWhenItIsDestroyed)
{
  std::promise<void> began, end;
  bool has_ended = false;  // a race, if the destructor does not wait
  auto task = std::make_unique<BackgroundTask<int>>();
  ASSERT_TRUE(task->start(
      [&]
      {
        began.set_value();
        end.get_future().wait();
        has_ended = true;
        return 12;
      }));
  began.get_future().wait();
  end.set_value();
  task.reset();
  EXPECT_TRUE(has_ended);
}

TEST(BackgroundTask, doesNotWaitForItsWorkIfItWasAbandoned)
{
  const auto ended = std::make_shared<std::promise<void>>();
  {
    Gate gate;
    auto task = std::make_unique<BackgroundTask<int>>();
    ASSERT_TRUE(task->start(
        [work = gate.work(13), ended]
        {
          const int result = work();
          ended->set_value();
          return result;
        }));
    std::thread([&task] { task->abandon(); }).join();
    task.reset();  // the work still waits for the gate
  }
  ended->get_future().wait();
}
